"""The plain twin of the compiled solver: breadth-first over pushes, in Python integers as bit masks.

Written before the compiled one and without its ideas: no bound, no chains, regions as masks. Cell (row, column) is bit
`row * stride + column` with a stride of columns + 1; the spare column is never free, so moves cannot wrap around.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np

from pcg.arrays import BoolArray
from pcg.grid import Cell
from pcg.level import Level


class Outcome(NamedTuple):
    """The least number of pushes, None if there is no solution, and the number of states that were met."""

    pushes: int | None
    states: int


def search(level: Level, *, by_region: bool = True) -> Outcome:
    """Searches until the first solution, or through all states that are not hopeless.

    Args:
        level: A playable level.
        by_region: Whether states that differ only in the player's place within a region are one.
    """
    board = _Board.of(level)
    goal = 0 if level.goal_crate is None else board.bit(level.goal_crate)
    return _search(board, board.bit(level.player), board.mask(level.crates), goal, by_region=by_region)


def fewest_pushes(level: Level) -> int | None:
    """The least number of pushes, None if there is no solution."""
    return search(level).pushes


class _Push(NamedTuple):
    """A push of the crate on bit `crate` by `step` bits."""

    crate: int
    step: int


class _State(NamedTuple):
    """A state and the pushes that led to it."""

    crates: int
    goal: int
    region: int
    pushes: int


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


def _search(board: _Board, player: int, crates: int, goal: int, *, by_region: bool) -> Outcome:
    if board.is_solved(crates, goal):
        return Outcome(0, 1)
    if board.is_hopeless(crates, goal):
        return Outcome(None, 1)
    region = board.region(player, crates)
    # This list is the queue too: the loop goes on over the states that it appends.
    states = [_State(crates, goal, region, 0)]
    met = {(crates, goal): [region if by_region else player]}
    for state in states:
        for push in _pushes(board, state):
            moved = _moved(push.crate, push.step)
            crates = state.crates ^ push.crate ^ moved
            goal = moved if push.crate == state.goal else state.goal
            regions = met.setdefault((crates, goal), [])
            if board.is_hopeless(crates, goal) or any(region & push.crate for region in regions):
                continue
            if board.is_solved(crates, goal):
                return Outcome(state.pushes + 1, len(states) + 1)
            region = board.region(push.crate, crates)
            regions.append(region if by_region else push.crate)
            states.append(_State(crates, goal, region, state.pushes + 1))
    return Outcome(None, len(states))


def _pushes(board: _Board, state: _State) -> Iterator[_Push]:
    free = board.floor & ~state.crates
    for step in (-1, -board.stride, 1, board.stride):
        pushable = state.crates & _moved(state.region, step) & _moved(free, -step)
        while pushable:
            crate = pushable & -pushable
            pushable ^= crate
            yield _Push(crate, step)


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
