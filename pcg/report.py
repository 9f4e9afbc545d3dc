"""What there is to say about levels: solvable or not, how they are built, which of them are the same."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from pcg.level import Level
from pcg.metrics import occluded, statistics
from pcg.solver import goal_crate_of, solve
from pcg.symmetry import content_hash


@dataclass(frozen=True)
class LevelReport:
    """What is known about a level; the fields are those of `manipuzzle levels --json`.

    Attributes:
        name: The level's name.
        solvable: Whether pushes solve it; None if the solver gave up.
        pushes: Least number of pushes, None without a solution; the next two likewise.
        moves: Length of the solution.
        solution: The solution in LURD notation.
        crates: Crates.
        targets: Targets.
        walls: Inner wall cells.
        regions: Four-connected regions of cells without wall.
        occluded: Whether a wall or another crate hides the goal crate from the player.
        duplicate_of: Name of the first earlier level with the same tiles, up to the eight symmetries.
    """

    name: str
    solvable: bool | None
    pushes: int | None
    moves: int | None
    solution: str | None
    crates: int
    targets: int
    walls: int
    regions: int
    occluded: bool
    duplicate_of: str | None


@dataclass(frozen=True)
class LevelsSummary:
    """Counts over levels.

    Attributes:
        levels: All levels.
        solvable: Those proved solvable.
        occluded: Those whose goal crate the player does not see.
        duplicates: Those that repeat an earlier one.
    """

    levels: int
    solvable: int
    occluded: int
    duplicates: int


def report_levels(levels: Iterable[Level], *, max_states: int | None = None) -> Iterator[LevelReport]:
    """Reports on playable levels, one at a time, so that finished ones are kept when the rest is cut short.

    Args:
        levels: With one player, a target and a crate each.
        max_states: Limit of the solver, None for its default.
    """
    first_names: dict[str, str] = {}
    for level in levels:
        counted = statistics(level)
        solution = solve(level, max_states=max_states)
        digest = content_hash(level)
        yield LevelReport(
            name=level.name,
            solvable=solution.solvable,
            pushes=solution.pushes,
            moves=solution.moves,
            solution=solution.lurd,
            crates=counted.crates,
            targets=counted.targets,
            walls=counted.walls,
            regions=counted.regions,
            occluded=occluded(level, goal_crate_of(level, solution)),
            duplicate_of=first_names.get(digest),
        )
        first_names.setdefault(digest, level.name)


def summarise(reports: Iterable[LevelReport]) -> LevelsSummary:
    """Counts over `reports`."""
    reports = list(reports)
    return LevelsSummary(
        levels=len(reports),
        solvable=sum(report.solvable is True for report in reports),
        occluded=sum(report.occluded for report in reports),
        duplicates=sum(report.duplicate_of is not None for report in reports),
    )
