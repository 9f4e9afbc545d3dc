"""The comparison of level sources as tables: one row a source, one table a task, means over the seeds."""

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from pathlib import Path

from evaluate.number_text import three_digits
from evaluate.statistics import deviation, mean
from pcg.compare import Measurement
from pcg.files import write_text

COLUMNS = (
    "source",
    "levels per CPU s",
    "CPU s per level",
    "requests met by attempt",
    "levels per 1,000 steps",
    "levels",
    "mean pushes",
    "dependency",
    "Hamming distance",
    "effective cells of the goal crate",
)

MEASUREMENTS_FILE = "measurements.jsonl"
TABLE_FILE = "comparison.md"


def rows(measurements: Sequence[Measurement], task: str) -> Iterator[list[str]]:
    """The cells of `COLUMNS` for every source of a task."""
    of_task = [m for m in measurements if m.task == task]
    for source in dict.fromkeys(m.source for m in of_task):
        runs = [m for m in of_task if m.source == source]
        cpu, levels = sum(m.cpu_s for m in runs), sum(m.levels for m in runs)
        yield [
            source,
            _spread([m.levels_per_cpu_s for m in runs]),
            three_digits(cpu / levels) if levels else "-",
            f"{_met_share(runs, source, task):.2%}",
            three_digits(1000 * levels / max(1, sum(m.steps for m in runs))),
            str(levels),
            *(_mean(runs, value) for value in _QUALITIES),
        ]


SUMMARY_COLUMNS = ("source", "requests met by attempt, mean of the tasks", "tasks with levels", "fastest in tasks")


def summary_rows(measurements: Sequence[Measurement]) -> Iterator[list[str]]:
    """The cells of `SUMMARY_COLUMNS` for every source.

    The share of requests met is the controllability of a generator: it does what it is asked for, at the first attempt.
    """
    tasks = list(dict.fromkeys(m.task for m in measurements))
    speeds = {
        source: [_speed(measurements, source, task) for task in tasks]
        for source in dict.fromkeys(m.source for m in measurements)
    }
    best = [max(column) for column in zip(*speeds.values(), strict=True)]
    for source, values in speeds.items():
        shares = [_met_share(measurements, source, task) for task in tasks]
        fastest = sum(0 < value == top for value, top in zip(values, best, strict=True))
        some = sum(value > 0 for value in values)
        yield [source, f"{mean(shares):.2%}", f"{some} of {len(tasks)}", f"{fastest} of {len(tasks)}"]


def _speed(measurements: Sequence[Measurement], source: str, task: str) -> float:
    runs = [m.levels_per_cpu_s for m in measurements if (m.source, m.task) == (source, task)]
    return mean(runs) or 0.0


def _met_share(measurements: Sequence[Measurement], source: str, task: str) -> float:
    runs = [m for m in measurements if (m.source, m.task) == (source, task)]
    return sum(m.met for m in runs) / max(1, sum(m.attempts for m in runs))


def markdown(measurements: Sequence[Measurement]) -> str:
    """All tables as Markdown."""
    overview = [list(SUMMARY_COLUMNS), ["---", "---:", "---:", "---:"], *summary_rows(measurements)]
    parts = ["# Sources of levels compared", "", _NOTE, "", *(f"| {' | '.join(cells)} |" for cells in overview)]
    for task in dict.fromkeys(m.task for m in measurements):
        lines = [list(COLUMNS), ["---", *["---:"] * (len(COLUMNS) - 1)], *rows(measurements, task)]
        parts += ["", f"## {task}", "", *(f"| {' | '.join(cells)} |" for cells in lines)]
    return "\n".join([*parts, ""])


def write_comparison(folder: Path, measurements: Sequence[Measurement]) -> None:
    """Writes the measurements, one line each, and the tables.

    Raises:
        InputError: a file cannot be written.
    """
    write_text(folder / MEASUREMENTS_FILE, "".join(json.dumps(asdict(m)) + "\n" for m in measurements))
    write_text(folder / TABLE_FILE, markdown(measurements))


_NOTE = (
    "Mean over the seeds ± standard deviation. An attempt is a drawn level of the baseline, an episode of a policy; a step "
    "is an edit of one tile. Levels are distinct under turning and mirroring; CPU time includes the solver. The effective "
    "cells of the goal crate are 2 to the power of the entropy of its cell: as many cells, all equally likely, would be as "
    "diverse. They and the Hamming distance depend on the number of levels: compare rows with alike numbers."
)

_QUALITIES: tuple[Callable[[Measurement], float | None], ...] = (
    lambda m: m.mean_pushes,
    lambda m: m.dependency,
    lambda m: m.hamming,
    lambda m: None if m.goal_entropy is None else 2**m.goal_entropy,
)


def _mean(runs: Sequence[Measurement], value: Callable[[Measurement], float | None]) -> str:
    average = mean([found for m in runs if (found := value(m)) is not None])
    return "-" if average is None else three_digits(average)


def _spread(values: Sequence[float]) -> str:
    average, spread = mean(values) or 0.0, deviation(values) or 0.0
    return f"{three_digits(average)} ± {three_digits(spread)}"
