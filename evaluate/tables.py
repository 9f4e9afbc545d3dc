"""Tables of a study: what happened per scene and method, as numbers and as Markdown."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from evaluate.statistics import deviation, mean, wilson_interval
from evaluate.summary import Summary, best_of, time_text
from evaluate.table import BLANK, Entry, Table, as_markdown


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

    @property
    def summary(self) -> Summary:
        """The same without the single times."""
        return Summary(self.trials, self.solved, self.mean_time, self.time_deviation)


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
    rows = [_scene_row(scene, methods, cells) for scene in scenes]
    rows.append((Entry("solved"), *(_share(totals.get(method, Cell())) for method in methods)))
    return as_markdown(Table("study", title, note, ("scene", *methods), tuple(rows)))


def _scene_row(scene: str, methods: Sequence[str], cells: Mapping[tuple[str, str], Cell]) -> tuple[Entry, ...]:
    ran = {method: cells[scene, method].summary for method in methods if (scene, method) in cells}
    best = best_of(ran)
    entries = (Entry(time_text(ran[m]), bold=m in best) if m in ran else BLANK for m in methods)
    return Entry(scene), *entries


def _share(cell: Cell) -> Entry:
    if not cell.trials:
        return BLANK
    low, high = cell.rate_interval
    return Entry(f"{cell.solved}/{cell.trials} ({100 * low:.0f} to {100 * high:.0f} %)")
