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
    "entropy of goal crate's cell [bit]",
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
            f"{sum(m.met for m in runs) / max(1, sum(m.attempts for m in runs)):.2%}",
            three_digits(1000 * levels / max(1, sum(m.steps for m in runs))),
            str(levels),
            *(_mean(runs, value) for value in _QUALITIES),
        ]


def markdown(measurements: Sequence[Measurement]) -> str:
    """All tables as Markdown."""
    parts = ["# Sources of levels compared", "", _NOTE]
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
    "is an edit of one tile. Levels are distinct under turning and mirroring; CPU time includes the solver. Hamming distance "
    "and entropy depend on the number of levels: compare them between rows with alike numbers."
)

_QUALITIES: tuple[Callable[[Measurement], float | None], ...] = (
    lambda m: m.mean_pushes,
    lambda m: m.dependency,
    lambda m: m.hamming,
    lambda m: m.goal_entropy,
)


def _mean(runs: Sequence[Measurement], value: Callable[[Measurement], float | None]) -> str:
    average = mean([found for m in runs if (found := value(m)) is not None])
    return "-" if average is None else three_digits(average)


def _spread(values: Sequence[float]) -> str:
    average, spread = mean(values) or 0.0, deviation(values) or 0.0
    return f"{three_digits(average)} ± {three_digits(spread)}"
