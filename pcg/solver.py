"""An exact Sokoban solver: breadth-first over pushes, so its solutions have the least number of pushes.

A state is the set of crates together with the region in which the player can walk; only pushes are steps, and two
player positions in one region are one state. Without a named goal crate all crates are alike. With one, its cell
belongs to the state, and it has to be the crate on the first target in reading order.

*Live* cells of a target are those from which a lone crate can be pushed to it, found by pulling a crate backwards from
the target. A crate on no live cell is lost for all targets. That alone does not make a state hopeless, because levels
may have more crates than targets: a state is cut off only when fewer live crates than targets remain, or when the goal
crate has left the live cells of its target.

Sets of cells are Python integers used as bit masks: cell (row, column) is bit `row * stride + column` with a stride
of columns + 1. The spare column is never free, so moving a mask by 1 or by `stride` cannot wrap around.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple, Self

import numpy as np

from pcg.grid import DIRECTIONS, BoolArray, Cell, shortest_walk
from pcg.level import Level

MAX_CELLS = 10_000
"""Levels with more cells are not searched: one flood of a maze this large takes milliseconds."""


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
        pushes: The least number of pushes.
        moves: All moves, walking and pushing: the length of `lurd`. Each walk between two pushes is a shortest one,
            but another solution with as many pushes may walk less in total.
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


def solve(level: Level, *, goal_crate: Cell | None = None, max_states: int | None = None) -> Solution:
    """Solves a level with the least number of pushes.

    Args:
        level: One player and at least one target; with fewer crates than targets it is unsolvable.
        goal_crate: Cell of the crate that has to end on the first target; by default `level.goal_crate`, and if that
            is None too, any crate may.
        max_states: States to visit at most, `default_max_states` by default.

    Raises:
        ValueError: the level has not exactly one player, has no target, or `goal_crate` is no crate.
    """
    goal_crate = level.goal_crate if goal_crate is None else goal_crate
    if goal_crate is not None and goal_crate not in level.crates:
        raise ValueError(f"goal crate {goal_crate} is not a crate; there are {level.crates}")
    if not level.targets:
        raise ValueError("the level has no target")
    if level.tiles.size > MAX_CELLS:
        return Solution(SolverStatus.LIMIT)
    board = _Board.of(level)
    start = board.bit(level.player)
    goal = 0 if goal_crate is None else board.bit(goal_crate)
    limit = default_max_states(level) if max_states is None else max_states
    status, pushes, states = _search(board, start, board.mask(level.crates), goal, limit)
    if pushes is None:
        return Solution(status, states=states)
    path = [(board.cell(push.crate), board.cell(_moved(push.crate, push.step))) for push in pushes]
    lurd = _with_walks(level, path)
    return Solution(status, len(pushes), len(lurd), lurd, _crate_on_first_target(level, path), states)


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


class _Push(NamedTuple):
    """A push of the crate on bit `crate` by `step` bits."""

    crate: int
    step: int


class _State(NamedTuple):
    """A state, the state it came from (an index) and the push between them."""

    crates: int
    goal: int
    region: int
    parent: int
    push: _Push


@dataclass(frozen=True)
class _Board:
    """What never changes in a search, as bit masks."""

    stride: int
    floor: int
    targets: int
    first_target: int
    live: int
    live_first: int
    n_targets: int

    @classmethod
    def of(cls, level: Level) -> Self:
        stride = level.shape[1] + 1
        floor, targets = (_packed(mask, stride) for mask in (~level.is_wall, level.is_target))
        first = targets & -targets
        live, live_first = (_live(cells, floor, stride) for cells in (targets, first))
        return cls(stride, floor, targets, first, live, live_first, targets.bit_count())

    def bit(self, cell: Cell) -> int:
        return 1 << (cell[0] * self.stride + cell[1])

    def mask(self, cells: list[Cell]) -> int:
        return sum(self.bit(cell) for cell in cells)

    def cell(self, bit: int) -> Cell:
        return divmod(bit.bit_length() - 1, self.stride)

    def is_hopeless(self, crates: int, goal: int) -> bool:
        return (crates & self.live).bit_count() < self.n_targets or (goal != 0 and not goal & self.live_first)

    def is_solved(self, crates: int, goal: int) -> bool:
        return crates & self.targets == self.targets and goal in {0, self.first_target}

    def region(self, player: int, crates: int) -> int:
        """The cells that the player can walk to."""
        free, stride = self.floor & ~crates, self.stride
        region, grown = 0, player
        while grown != region:
            region = grown
            grown = (region | region << 1 | region >> 1 | region << stride | region >> stride) & free
        return region


def _search(
    board: _Board, player: int, crates: int, goal: int, max_states: int
) -> tuple[SolverStatus, list[_Push] | None, int]:
    """Breadth-first search: how it ended, the pushes of the solution if there is one, the number of states."""
    if board.is_solved(crates, goal):
        return SolverStatus.SOLVED, [], 1
    if board.is_hopeless(crates, goal):
        return SolverStatus.UNSOLVABLE, None, 1
    region = board.region(player, crates)
    # This list is the queue too: the loop goes on over the states that it appends.
    states = [_State(crates, goal, region, -1, _Push(0, 0))]
    # The regions met so far by crates: a player found in one of them spares a flood and a state.
    met = {(crates, goal): [region]}
    for index, state in enumerate(states):
        for push in _pushes(board, state):
            moved = _moved(push.crate, push.step)
            crates = state.crates ^ push.crate ^ moved
            goal = moved if push.crate == state.goal else state.goal
            if board.is_hopeless(crates, goal):
                continue
            regions = met.setdefault((crates, goal), [])
            if any(region & push.crate for region in regions):
                continue
            if board.is_solved(crates, goal):
                return SolverStatus.SOLVED, [*_trace(states, index), push], len(states) + 1
            if len(states) >= max_states:
                return SolverStatus.LIMIT, None, len(states)
            region = board.region(push.crate, crates)
            regions.append(region)
            states.append(_State(crates, goal, region, index, push))
    return SolverStatus.UNSOLVABLE, None, len(states)


def _pushes(board: _Board, state: _State) -> Iterator[_Push]:
    free = board.floor & ~state.crates
    for step in (-1, -board.stride, 1, board.stride):
        pushable = state.crates & _moved(state.region, step) & _moved(free, -step)
        while pushable:
            crate = pushable & -pushable
            pushable ^= crate
            yield _Push(crate, step)


def _trace(states: list[_State], index: int) -> list[_Push]:
    pushes = []
    while (state := states[index]).parent >= 0:
        pushes.append(state.push)
        index = state.parent
    return pushes[::-1]


def _live(targets: int, floor: int, stride: int) -> int:
    """The cells from which a lone crate can be pushed to one of `targets`."""
    live = frontier = targets & floor
    while frontier:
        pulled = 0
        for step in (-1, -stride, 1, stride):
            # A crate pushed by `step` onto the frontier came from the cell before, the player from the one before that.
            pulled |= _moved(frontier, -step) & floor & _moved(floor, step)
        frontier = pulled & ~live
        live |= frontier
    return live


def _packed(mask: BoolArray, stride: int) -> int:
    rows, columns = mask.shape
    padded = np.zeros((rows, stride), dtype=np.bool_)
    padded[:, :columns] = mask
    return int.from_bytes(np.packbits(padded, bitorder="little").tobytes(), "little")


def _moved(mask: int, step: int) -> int:
    return mask << step if step > 0 else mask >> -step


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


def _crate_on_first_target(level: Level, path: list[tuple[Cell, Cell]]) -> Cell:
    cell = level.targets[0]
    for crate, beyond in reversed(path):
        if beyond == cell:
            cell = crate
    return cell
