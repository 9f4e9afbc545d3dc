"""What became of some trials, of one method on one scene for example, and how tables show it."""

from collections.abc import Mapping
from dataclasses import dataclass

import polars as pl

from evaluate.number_text import three_digits


@dataclass(frozen=True)
class Summary:
    """Some trials; means are over the solved ones, None without any.

    Attributes:
        trials: How many there were.
        solved: How many ended with a verified plan.
        mean: Planning time [s].
        deviation: Its sample standard deviation [s]; None if fewer than two are solved.
        net_mean: Mean planning time without computing subgoals [s]; None for methods that do not tell.
        pick_places: Mean number of pick-places.
        path_length: Mean way of the agent [m].
    """

    trials: int
    solved: int
    mean: float | None
    deviation: float | None
    net_mean: float | None = None
    pick_places: float | None = None
    path_length: float | None = None

    @property
    def rate(self) -> float:
        """Share of trials solved; 0 without trials."""
        return self.solved / self.trials if self.trials else 0.0

    @property
    def percent(self) -> float:
        """Share of trials solved, 0..100."""
        return 100 * self.rate


NOTHING = Summary(0, 0, None, None)
"""No trials at all."""


def summaries(frame: pl.DataFrame, *by: str) -> dict[tuple[str, ...], Summary]:
    """What happened, by the values of some columns of the trials (`evaluate.trial_frame.read_trials`)."""
    solved = pl.col("solved")
    grouped = frame.group_by(by, maintain_order=True).agg(
        pl.len(),
        solved.sum().alias("n_solved"),
        pl.col("time_s").filter(solved).mean(),
        pl.col("time_s").filter(solved).std().alias("deviation"),
        (pl.col("time_s") - pl.col("subgoal_time_s")).filter(solved).mean().alias("net"),
        pl.col("pick_places").filter(solved).mean(),
        pl.col("path_length_m").filter(solved).mean(),
    )
    return {
        tuple(names): Summary(trials, n, mean, deviation, net, pick_places, length)
        for *names, trials, n, mean, deviation, net, pick_places, length in grouped.iter_rows()
    }


def time_text(cell: Summary, *, net: bool = False) -> str:
    """`mean (deviation)`, or `mean` of one trial; in brackets the net time if wanted; the percentage if below 100."""
    if cell.mean is None:
        return "-"
    brackets = f" [{three_digits(cell.net_mean)}]" if net and cell.net_mean is not None else ""
    # 99.97 % must not be rounded to 100 %.
    share = "" if cell.solved == cell.trials else f" {min(cell.percent, 99.9):.3g}%"
    spread = "" if cell.deviation is None else f" ({three_digits(cell.deviation)})"
    return f"{three_digits(cell.mean)}{spread}{brackets}{share}"


def best_of(summaries: Mapping[str, Summary]) -> set[str]:
    """The methods that a table shows as the best: the largest share solved, and of these the least mean time.

    None if there are not two to compare, or none solved anything; several if their times look the same.
    """
    solved = {method: summary for method, summary in summaries.items() if summary.mean is not None}
    if len(summaries) < 2 or not solved:
        return set()
    most = max(summary.percent for summary in solved.values())
    means = {method: summary.mean or 0.0 for method, summary in solved.items() if summary.percent == most}
    least = three_digits(min(means.values()))
    return {method for method, value in means.items() if three_digits(value) == least}
