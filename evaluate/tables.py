"""Tables of a study: what happened per scene and method, as numbers and as Markdown."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from evaluate.number_text import three_digits
from evaluate.statistics import deviation, mean, wilson_interval


@dataclass(frozen=True)
class Result:
    """What a table needs of one trial.

    Attributes:
        scene: Name of the scene.
        method: Name of the method.
        solved: Whether the trial ended with a plan that passed verification.
        time_s: Planning time [s].
    """

    scene: str
    method: str
    solved: bool
    time_s: float


@dataclass
class Cell:
    """The trials of one scene and method, or of one method.

    Attributes:
        trials: How many there were.
        times: Planning times of the solved ones [s].
    """

    trials: int = 0
    times: list[float] = field(default_factory=list)

    def add(self, result: Result) -> None:
        """Counts one trial."""
        self.trials += 1
        if result.solved:
            self.times.append(result.time_s)

    @property
    def solved(self) -> int:
        """How many trials were solved."""
        return len(self.times)

    @property
    def rate(self) -> float:
        """Share of solved trials; 0 without trials."""
        return self.solved / self.trials if self.trials else 0.0

    @property
    def rate_interval(self) -> tuple[float, float]:
        """95 % confidence interval of the share."""
        return wilson_interval(self.solved, self.trials)

    @property
    def mean_time(self) -> float | None:
        """Mean planning time over the solved trials [s]."""
        return mean(self.times)

    @property
    def time_deviation(self) -> float | None:
        """Standard deviation of the planning time over the solved trials [s]."""
        return deviation(self.times)

    def text(self) -> str:
        """`mean ± deviation`, with the percentage solved if it is below 100; `-` if none was solved."""
        average, spread = self.mean_time, self.time_deviation
        if average is None or spread is None:
            return "-"
        # 99.97 % must not be rounded to 100 %.
        share = "" if self.solved == self.trials else f" ({min(100 * self.rate, 99.9):.3g} %)"
        return f"{three_digits(average)} ± {three_digits(spread)}{share}"


def by_scene_and_method(results: Iterable[Result]) -> dict[tuple[str, str], Cell]:
    """The results of each scene and method."""
    cells: dict[tuple[str, str], Cell] = {}
    for result in results:
        cells.setdefault((result.scene, result.method), Cell()).add(result)
    return cells


def by_method(cells: Mapping[tuple[str, str], Cell]) -> dict[str, Cell]:
    """The results of each method over all scenes."""
    totals: dict[str, Cell] = {}
    for (_, method), cell in cells.items():
        total = totals.setdefault(method, Cell())
        total.trials += cell.trials
        total.times.extend(cell.times)
    return totals


def markdown(
    title: str,
    note: str,
    scenes: Sequence[str],
    methods: Sequence[str],
    cells: Mapping[tuple[str, str], Cell],
) -> str:
    """A Markdown document with one row per scene, one column per method and a last row with the share solved."""
    totals = by_method(cells)
    rows = [[scene, *(cells.get((scene, method), Cell()).text() for method in methods)] for scene in scenes]
    rows.append(["**solved**", *(_share(totals.get(method, Cell())) for method in methods)])
    head = ["scene", *methods]
    lines = [_row(head), _row(["---", *("---:" for _ in methods)]), *(_row(row) for row in rows)]
    return "\n".join([f"# {title}", "", note, "", *lines, ""])


def _share(cell: Cell) -> str:
    low, high = cell.rate_interval
    return f"{cell.solved}/{cell.trials} ({100 * low:.0f}-{100 * high:.0f} %)"


def _row(texts: Sequence[str]) -> str:
    return "| " + " | ".join(text.replace("|", "\\|") for text in texts) + " |"
