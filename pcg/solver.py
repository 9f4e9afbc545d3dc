"""An exact Sokoban solver: its solutions have the least number of pushes, or the least number of moves.

Without a named goal crate all crates are alike. With one, it has to be the crate on the first target in reading order.
Levels may have more crates than targets. The searches are compiled: `pcg.push_search` and `pcg.move_search`.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from pcg.grid import DIRECTIONS, Cell, shortest_walk
from pcg.level import Level

MAX_CELLS = 10_000
"""Levels with more cells are not searched; the number of a cell, with the border, has to fit into 16 bits."""


class Objective(StrEnum):
    """What a solution has least of."""

    PUSHES = "pushes"
    """Each walk between two pushes is a shortest one, but another solution with as many pushes may walk less in all."""
    MOVES = "moves"
    """Steps of the player, walking and pushing; of solutions with as few moves one with the fewest pushes."""


class SolverStatus(StrEnum):
    """How a search ended."""

    SOLVED = "solved"
    UNSOLVABLE = "unsolvable"
    """Proved: every state that could lead to a solution was visited."""
    LIMIT = "limit"
    """Undecided; a larger `max_states` may help."""


@dataclass(frozen=True)
class Solution:
    """The outcome of a search.

    Attributes:
        status: How the search ended; the next four are None unless it is `solved`.
        pushes: Pushes; the least number if that was the objective.
        moves: All moves, walking and pushing: the length of `lurd`.
        lurd: The moves in LURD notation.
        goal_crate: Start cell of the crate that ends on the first target in reading order.
        states: States visited.
    """

    status: SolverStatus
    pushes: int | None = None
    moves: int | None = None
    lurd: str | None = None
    goal_crate: Cell | None = None
    states: int = 0

    @property
    def solved(self) -> bool:
        """Whether a solution was found."""
        return self.status is SolverStatus.SOLVED

    @property
    def solvable(self) -> bool | None:
        """Whether there is a solution, None if that is undecided."""
        return None if self.status is SolverStatus.LIMIT else self.solved


def default_max_states(level: Level) -> int:
    """The states that `solve` visits at most by default: fewer on large boards, so that memory stays below 0.5 GB."""
    return min(250_000, 50_000_000 // level.tiles.size)


def solve(
    level: Level,
    *,
    goal_crate: Cell | None = None,
    max_states: int | None = None,
    objective: Objective = Objective.PUSHES,
) -> Solution:
    """Solves a level with the least number of pushes, or of moves.

    Args:
        level: One player and at least one target; with fewer crates than targets it is unsolvable.
        goal_crate: Cell of the crate that has to end on the first target; by default `level.goal_crate`, and if that
            is None too, any crate may.
        max_states: States to visit at most, `default_max_states` by default.
        objective: What is to be least.

    Raises:
        ValueError: the level has not exactly one player, has no target, or `goal_crate` is no crate.
    """
    # Numba takes a second to load: reading and writing levels should not wait for it.
    from pcg import move_search, push_search  # noqa: PLC0415  # see above
    from pcg import solver_kernel as kernel  # noqa: PLC0415  # see above

    goal_crate = level.goal_crate if goal_crate is None else goal_crate
    if goal_crate is not None and goal_crate not in level.crates:
        raise ValueError(f"goal crate {goal_crate} is not a crate; there are {level.crates}")
    if not level.targets:
        raise ValueError("the level has no target")
    player = level.player
    if level.tiles.size > MAX_CELLS:
        return Solution(SolverStatus.LIMIT)
    width = level.shape[1] + 2
    wall = np.pad(level.is_wall, 1, constant_values=True).astype(np.uint8).ravel()
    targets = np.array([_number(cell, width) for cell in level.targets], dtype=np.int32)
    search = {Objective.PUSHES: push_search.fewest_pushes, Objective.MOVES: move_search.fewest_moves}[objective]
    outcome, states, path = search(
        kernel.make_board(wall, width, targets),
        _number(player, width),
        np.array([_number(cell, width) for cell in level.crates], dtype=np.int16),
        0 if goal_crate is None else _number(goal_crate, width),
        default_max_states(level) if max_states is None else max_states,
    )
    status = _STATUSES[outcome]
    if status is not SolverStatus.SOLVED:
        return Solution(status, states=states)
    pushes = [(_cell(crate, width), _cell(crate + step, width)) for crate, step in path.tolist()]
    lurd = _with_walks(level, pushes)
    crate, _ = kernel.start_of(path, targets[0])
    return Solution(status, len(pushes), len(lurd), lurd, _cell(crate, width), states)


def goal_crate_of(level: Level, solution: Solution) -> Cell:
    """The crate that has to reach the goal: the named one, else the one that `solution` brings to the first target.

    Where neither is known (an unsolvable level) it is the first crate in reading order.

    Raises:
        ValueError: the level has no crate.
    """
    crate = level.goal_crate or solution.goal_crate or next(iter(level.crates), None)
    if crate is None:
        raise ValueError("the level has no crate")
    return crate


_STATUSES = (SolverStatus.SOLVED, SolverStatus.UNSOLVABLE, SolverStatus.LIMIT)
"""By their number in the kernel."""


def _number(cell: Cell, width: int) -> int:
    """The number of an inner cell on the kernel's bordered board."""
    return (cell[0] + 1) * width + cell[1] + 1


def _cell(number: int, width: int) -> Cell:
    return number // width - 1, number % width - 1


def _with_walks(level: Level, path: list[tuple[Cell, Cell]]) -> str:
    """The pushes of `path` (from, to) with the walks between them, in LURD notation."""
    free = ~(level.is_wall | level.is_crate)
    player, lurd = level.player, []
    letters = {step: letter for letter, step in DIRECTIONS.items()}
    for crate, beyond in path:
        step = beyond[0] - crate[0], beyond[1] - crate[1]
        walk = shortest_walk(free, player, (crate[0] - step[0], crate[1] - step[1]))
        if walk is None:
            raise AssertionError("the search found a push that the player cannot reach")
        lurd += [walk, letters[step].upper()]
        free[crate], free[beyond] = True, False
        player = crate
    return "".join(lurd)
