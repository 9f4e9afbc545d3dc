"""What the compiled searches of the Sokoban solver share: boards, states, their table, and the bound.

Boards are flat with a border of wall: inner cell (row, column) is number `(row + 1) * width + column + 1` with `width =
columns + 2`, so no step needs a bounds check. A state holds the cells of the crates in ascending order and that of the
goal crate, 0 (a wall) where any crate will do; it is found by a hash table with linear probing.

The bound is the *push distance* of a crate to a target, found by pulling a lone crate backwards from the target: that of
the goal crate (of the nearest crate, if none is named) to the first target, or, where there are as many targets as crates,
the sum over all crates to their nearest targets, if that is more. One push lowers the bound by at most one.

A state is cut off when fewer crates than targets have a push distance to any target, or when the goal crate (without
one: every crate) has none to the first target. Nothing else is pruned, so `UNSOLVABLE` is a proof.

`pcg.push_search` finds the fewest pushes, `pcg.move_search` the fewest moves.
"""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from numba import njit

from pcg.arrays import ByteArray, Int16Array, Int32Array

SOLVED, UNSOLVABLE, LIMIT = 0, 1, 2

NO_WAY = np.iinfo(np.int32).max
"""Push distance of a cell from which no push leads to the target; also marks cells that are never walked on."""

FIRST_CAPACITY = 128
"""States for which there is room at the start of a search."""


class Board(NamedTuple):
    """What never changes in a search.

    Attributes:
        wall: (cells,) flags.
        width: Cells of a row, with border.
        first_target: Cell of the first target.
        n_targets: Targets.
        is_target: (cells,) flags.
        to_first: (cells,) push distances to the first target.
        to_any: (cells,) push distances to the nearest target.
    """

    wall: ByteArray
    width: int
    first_target: int
    n_targets: int
    is_target: ByteArray
    to_first: Int32Array
    to_any: Int32Array


@njit(cache=True)
def make_board(wall: ByteArray, width: int, targets: Int32Array) -> Board:
    """The board of a search.

    Args:
        wall: (cells,) flags, with the border.
        width: Cells of a row.
        targets: Cells of the targets, ascending, at least one.
    """
    is_target = np.zeros(wall.size, dtype=np.uint8)
    for target in targets:
        is_target[target] = 1
    to_first = push_distances(wall, width, targets[:1])
    to_any = to_first if targets.size == 1 else push_distances(wall, width, targets)
    return Board(wall, width, targets[0], targets.size, is_target, to_first, to_any)


@njit(cache=True)
def push_distances(wall: ByteArray, width: int, targets: Int32Array) -> Int32Array:
    """Pushes that bring a lone crate from each cell to the nearest target, `NO_WAY` if none do.

    The player is taken to be wherever a push needs it.
    """
    distance = np.full(wall.size, NO_WAY, dtype=np.int32)
    queue = np.empty(wall.size, dtype=np.int32)
    end = 0
    for target in targets:
        distance[target] = 0
        queue[end] = target
        end += 1
    begin = 0
    while begin < end:
        cell = queue[begin]
        begin += 1
        for step in (-1, -width, 1, width):
            before = cell - step
            if not wall[before] and distance[before] == NO_WAY and not wall[before - step]:
                distance[before] = distance[cell] + 1
                queue[end] = before
                end += 1
    return distance


@njit(cache=True)
def bound_of(board: Board, crates: Int16Array, goal: int) -> int:
    """Pushes that are needed at least, `NO_WAY` if the state is hopeless."""
    to_first = NO_WAY
    alive, total = 0, 0
    for crate in crates:
        to_first = min(to_first, board.to_first[crate])
        if board.to_any[crate] != NO_WAY:
            alive += 1
            total += board.to_any[crate]
    if goal != 0:
        to_first = board.to_first[goal]
    if alive < board.n_targets or to_first == NO_WAY:
        return NO_WAY
    return max(to_first, total) if crates.size == board.n_targets else to_first


@njit(cache=True)
def is_solved(board: Board, crates: Int16Array, goal: int) -> bool:
    """Whether every target holds a crate, the first one the goal crate if there is one."""
    if goal != 0 and goal != board.first_target:  # noqa: PLR1714  # tuples of two types of integers are not compiled
        return False
    covered = 0
    for crate in crates:
        covered += board.is_target[crate]
    return covered == board.n_targets


@njit(cache=True)
def _hash(crates: Int16Array, goal: int, player: int) -> np.int64:
    """FNV-1a over the numbers of a state, with a final mix for the low bits."""
    value = np.uint64(14695981039346656037)
    for crate in crates:
        value = (value ^ np.uint64(crate)) * np.uint64(1099511628211)
    value = (value ^ np.uint64(goal)) * np.uint64(1099511628211)
    value = (value ^ np.uint64(player)) * np.uint64(1099511628211)
    return np.int64((value ^ (value >> np.uint64(29))) >> np.uint64(1))


@njit(cache=True)
def slot_of(
    table: Int32Array,
    states: Int16Array,
    goals: Int16Array,
    players: Int16Array,
    crates: Int16Array,
    goal: int,
    player: int,
) -> np.int64:
    """The slot of the table that holds this state, or the empty one where it belongs."""
    mask = table.size - 1
    slot = _hash(crates, goal, player) & mask
    while table[slot] >= 0:
        index = table[slot]
        same = goals[index] == goal and players[index] == player
        for i in range(crates.size):
            if not same:
                break
            same = states[index, i] == crates[i]
        if same:
            return slot
        slot = (slot + 1) & mask
    return slot


@njit(cache=True)
def rehashed(table: Int32Array, states: Int16Array, goals: Int16Array, players: Int16Array) -> Int32Array:
    """A table of twice the size with the same states."""
    larger = np.full(2 * table.size, -1, dtype=np.int32)
    for index in table:
        if index >= 0:
            larger[slot_of(larger, states, goals, players, states[index], goals[index], players[index])] = index
    return larger


@njit(cache=True)
def grown(array: npt.NDArray[Any], capacity: int) -> npt.NDArray[Any]:
    """The array with room for `capacity` numbers."""
    larger: npt.NDArray[Any] = np.empty(capacity, dtype=array.dtype)
    larger[: array.size] = array
    return larger


@njit(cache=True)
def grown_rows(array: npt.NDArray[Any], capacity: int) -> npt.NDArray[Any]:
    """The array with room for `capacity` rows."""
    larger: npt.NDArray[Any] = np.empty((capacity, array.shape[1]), dtype=array.dtype)
    larger[: array.shape[0]] = array
    return larger


@njit(cache=True)
def write_pushed(crates: Int16Array, index: int, beyond: int, out: Int16Array) -> None:
    """Writes `crates` with number `index` on the cell `beyond`, in ascending order again."""
    out[:] = crates
    while index > 0 and out[index - 1] > beyond:
        out[index] = out[index - 1]
        index -= 1
    while index + 1 < out.size and out[index + 1] < beyond:
        out[index] = out[index + 1]
        index += 1
    out[index] = beyond


@njit(cache=True)
def path_to(parents: Int32Array, pushed: Int16Array, steps: Int16Array, index: int) -> Int32Array:
    """(n, 2) crate cell and step of each push that leads to state `index`."""
    length = 0
    at = index
    while parents[at] >= 0:
        length += 1
        at = parents[at]
    path = np.empty((length, 2), dtype=np.int32)
    while parents[index] >= 0:
        length -= 1
        path[length, 0], path[length, 1] = pushed[index], steps[index]
        index = parents[index]
    return path


@njit(cache=True)
def start_of(path: Int32Array, end: int) -> tuple[int, int]:
    """Where the crate began that the (n, 2) pushes of `path` bring to the cell `end`, and how many of them are its own."""
    start, own_pushes = end, 0
    for k in range(len(path) - 1, -1, -1):
        if path[k, 0] + path[k, 1] == start:
            start = path[k, 0]
            own_pushes += 1
    return start, own_pushes
