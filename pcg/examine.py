"""Whether a level is what was asked for."""

from dataclasses import replace

from pcg.dependency import has_dependency
from pcg.grid import count_regions
from pcg.level import Level
from pcg.metrics import occluded
from pcg.request import Rejection, Request
from pcg.solver import Solution, SolverStatus, solve


def examined(level: Level, request: Request, max_states: int | None = None) -> tuple[Level, Solution] | Rejection:
    """The level with its goal crate and its solution, or the first reason why it does not meet the request.

    The cheap tests come first. Without a named goal crate it is the one that the solution brings to the first target.

    Args:
        level: Of any kind, unfinished ones too.
        request: What was asked for; duplicates are not looked for.
        max_states: Limit of the solver, None for its default.
    """
    if (reason := _shape_problem(level, request)) is not None:
        return reason
    solution = solve(level, max_states=max_states)
    if solution.pushes is None:
        return Rejection.UNDECIDED if solution.status is SolverStatus.LIMIT else Rejection.UNSOLVABLE
    low, high = request.pushes
    if not low <= solution.pushes <= high:
        return Rejection.EASY if solution.pushes < low else Rejection.HARD
    level = replace(level, goal_crate=level.goal_crate or solution.goal_crate)
    assert level.goal_crate is not None  # noqa: S101  # a solution brings one to the first target
    if request.occluded is not None and occluded(level, level.goal_crate) != request.occluded:
        return Rejection.SIGHT
    if request.dependency is not None and has_dependency(level, max_states) != request.dependency:
        return Rejection.DEPENDENCY
    return level, solution


def _shape_problem(level: Level, request: Request) -> Rejection | None:
    if request.frozen is not None and not request.frozen.kept_by(level):
        return Rejection.FROZEN
    counts = [int(mask.sum()) for mask in (level.is_player, level.is_crate, level.is_target)]
    if counts != [1, request.crates, request.targets] or level.shape != (request.rows, request.columns):
        return Rejection.UNFINISHED
    if count_regions(~level.is_wall) != 1:
        return Rejection.UNFINISHED
    low, high = request.wall_density
    walls = int(level.is_wall.sum())
    # The nearest numbers of walls belong to the band too, as where a density is drawn and rounded.
    return None if round(low * request.cells) <= walls <= round(high * request.cells) else Rejection.WALLS
