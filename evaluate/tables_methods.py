"""Tables over all scenes: what each method achieves, and how it compares with each other one."""

import math
from collections.abc import Callable
from functools import partial
from itertools import combinations
from typing import Any

import numpy as np
import polars as pl

from evaluate.number_text import three_digits
from evaluate.statistics import (
    RESAMPLES,
    Comparison,
    FloatArray,
    Statistic,
    bootstrap_interval,
    compare,
    mean_time,
    median_time,
    par2,
    wilson_interval,
)
from evaluate.table import BLANK, Entry, Table
from evaluate.trial_frame import names_in, planning_times

LARGE, MANY = 5_000, 20
"""Runs of a method, and methods, from which on fewer bootstrap samples have to do."""

SAMPLES_OF_LARGE = 200

MAX_COMPARED = 12
"""Methods that are compared in pairs; more would make a table that nobody reads."""


def methods_table(frame: pl.DataFrame, rng: np.random.Generator) -> Table:
    """Success, times and plans of every method over all scenes.

    Args:
        frame: As `evaluate.trial_frame.read_trials` gives it.
        rng: Source of the bootstrap samples.
    """
    times, limit = planning_times(frame), time_limit(frame)
    interval = partial(_interval_entry, rng=rng, resamples=_resamples(times))
    totals = {row["method"]: row for row in _totals(frame).iter_rows(named=True)}
    rows = (_method_row(totals[method], times[method], limit, interval) for method in names_in(frame, "method"))
    columns = (
        "method",
        "solved",
        "solved [%]",
        "accepted",
        "mean [s]",
        "median [s]",
        "PAR2 [s]",
        "pick-places",
        "path [m]",
    )
    note = (
        "Solved: runs whose plan passes the independent verification, with the 95 % Wilson interval. Accepted: runs "
        "that the method itself takes for solved, where it has a criterion of its own. Mean time, pick-places and path "
        "over the solved runs; median over all runs; PAR2: mean over all runs, an unsolved one counts twice the time "
        f"limit of {limit:g} s. Intervals of times: 95 %, bootstrap over {_unit(times)}."
    )
    return Table("methods", "Methods over all scenes", note, columns, tuple(rows))


def _totals(frame: pl.DataFrame) -> pl.DataFrame:
    """A row a method: trials, solved and accepted ones, and means over the solved ones."""
    return frame.group_by("method").agg(
        pl.len(),
        pl.col("solved").sum().alias("n_solved"),
        pl.col("accepted").sum().alias("n_accepted"),
        pl.col("accepted").count().alias("n_asked"),
        pl.col("pick_places").filter("solved").mean(),
        pl.col("path_length_m").filter("solved").mean(),
    )


def _method_row(
    total: dict[str, Any], times: FloatArray, limit: float, interval: Callable[[FloatArray, Statistic], Entry]
) -> tuple[Entry, ...]:
    """The entries of a method, from its row of `_totals` and its `times` (runs, scenes) [s]."""
    low, high = wilson_interval(total["n_solved"], total["len"])
    rate = total["n_solved"] / total["len"]
    return (
        Entry(total["method"]),
        Entry(f"{total['n_solved']}/{total['len']}", value=rate),
        Entry(f"{percent(rate)} ({100 * low:.0f} to {100 * high:.0f})", value=rate),
        Entry(f"{total['n_accepted']}", value=total["n_accepted"]) if total["n_asked"] else BLANK,
        interval(times, mean_time),
        interval(times, median_time),
        interval(times, partial(par2, limit=limit)),
        _plain_entry(total["pick_places"]),
        _plain_entry(total["path_length_m"]),
    )


def comparison_table(frame: pl.DataFrame, rng: np.random.Generator) -> Table | None:
    """Every pair of methods on the same scenes and seeds; None if no two methods share any."""
    times, limit = planning_times(frame), time_limit(frame)
    methods, resamples, rows = names_in(frame, "method"), _resamples(times), []
    for first, second in combinations(methods[:MAX_COMPARED], 2):
        found = compare(times[first], times[second], limit, rng, resamples=resamples)
        if found.pairs:
            rows.append(_comparison_row(f"{first} vs. {second}", found))
    if not rows:
        return None
    columns = ("methods", "runs", "wins", "ties", "losses", "scenes won / tied / lost", "difference [s]")
    more = f" Of {len(methods)} methods the first {MAX_COMPARED} are compared." if len(methods) > MAX_COMPARED else ""
    note = (
        "The first method against the second on the same scenes and seeds. A run is won by the method that alone "
        "solves it, or is more than 10 % faster; a scene by mean PAR2. Difference: PAR2 of the first less that of the "
        "second, mean over the scenes; negative favours the first; 95 % bootstrap interval over scenes (over runs if "
        f"there is one scene), bold if it does not contain 0.{more}"
    )
    return Table("comparisons", "Pairs of methods", note, columns, tuple(rows))


def _comparison_row(name: str, found: Comparison) -> tuple[Entry, ...]:
    low, high = found.interval
    difference = f"{_signed(found.difference)} ({_signed(low)} to {_signed(high)})"
    return (
        Entry(name),
        Entry(str(found.pairs), value=found.pairs),
        *(Entry(str(n), value=n) for n in (found.wins, found.ties, found.losses)),
        Entry(" / ".join(map(str, found.scenes)), value=found.scenes[0]),
        Entry(difference, bold=low > 0 or high < 0, value=found.difference),
    )


def time_limit(frame: pl.DataFrame) -> float:
    """The largest time limit of the trials [s]; the longest time where methods tell none."""
    limits = [frame["time_limit"].max(), frame["time_s"].max()]
    return float(next((v for v in limits if isinstance(v, int | float)), 0.0))


def percent(share: float) -> str:
    """A share as a percentage; what is not all is never rounded to 100 %, nor something to 0 %."""
    value = 100 * share
    if 99.95 <= value < 100:
        return "99.9%"
    if 0 < value < 0.05:
        return "0.1%"
    return f"{value:.0f}%" if value in {0.0, 100.0} else f"{value:.1f}%"


def _interval_entry(matrix: FloatArray, statistic: Statistic, rng: np.random.Generator, resamples: int) -> Entry:
    value = statistic(matrix)
    if math.isnan(value):
        return Entry("-")
    low, high = bootstrap_interval(
        matrix,
        statistic,
        rng,
        resampled="scenes" if matrix.shape[1] > 1 else "runs",
        resamples=resamples,
    )
    text = f"{_seconds(value)} ({_seconds(low)} to {_seconds(high)})"
    return Entry(text, value=value if math.isfinite(value) else None)


def _unit(times: dict[str, FloatArray]) -> str:
    return "scenes" if next(iter(times.values())).shape[1] > 1 else "runs"


def _resamples(times: dict[str, FloatArray]) -> int:
    is_large = next(iter(times.values())).size >= LARGE or len(times) >= MANY
    return SAMPLES_OF_LARGE if is_large else RESAMPLES


def _seconds(value: float) -> str:
    return three_digits(value) if math.isfinite(value) else "∞"


def _signed(value: float) -> str:
    return ("+" if value > 0 else "") + three_digits(value) if math.isfinite(value) else "∞"


def _plain_entry(value: float | None) -> Entry:
    return Entry("-") if value is None else Entry(f"{value:.1f}", value=value)
