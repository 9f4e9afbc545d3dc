"""The compiled searches of the Sokoban solver: fewest pushes, and fewest moves.

Boards are flat with a border of wall: inner cell (row, column) is number `(row + 1) * width + column + 1` with `width =
columns + 2`, so no step needs a bounds check. A state holds the cells of the crates in ascending order and that of the
goal crate, 0 (a wall) where any crate will do.

*Fewest pushes* is A* (Hart, Nilsson, Raphael 1968) over pushes. Two player positions in one region of free cells are one
state: each state keeps its region as a bit set, and states that differ only in their regions are chained, so that a
push back into a known region costs one look-up and no flood. The bound is the *push distance* of a crate to a target,
found by pulling a lone crate backwards from the target: that of the goal crate (of the nearest crate, if none is named)
to the first target, or, where there are as many targets as crates, the sum over all crates to their nearest targets.
One push lowers the bound by at most one, so a state that is expanded was reached in the fewest pushes. The queue is one
stack for each value of f.

*Fewest moves* is Dijkstra's algorithm (1959) over pushes with the walk before each as its cost; there the player's cell
belongs to the state, and of solutions with as many moves one with the fewest pushes is found.

A state is cut off when fewer crates than targets have a push distance to any target, or when the goal crate (without
one: every crate) has none to the first target. Nothing else is pruned, so `UNSOLVABLE` is a proof.
"""

import heapq
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from numba import njit

from pcg.arrays import ByteArray, Int16Array, Int32Array, WordArray

SOLVED, UNSOLVABLE, LIMIT = 0, 1, 2

NO_WAY = np.iinfo(np.int32).max
"""Push distance of a cell from which no push leads to the target; also marks cells that are never walked on."""

_FIRST_CAPACITY = 128


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
def _bound(board: Board, crates: Int16Array, goal: int) -> int:
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
def _is_solved(board: Board, crates: Int16Array, goal: int) -> bool:
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
def _slot(
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
def _rehashed(table: Int32Array, states: Int16Array, goals: Int16Array, players: Int16Array) -> Int32Array:
    """A table of twice the size with the same states."""
    larger = np.full(2 * table.size, -1, dtype=np.int32)
    for index in table:
        if index >= 0:
            larger[_slot(larger, states, goals, players, states[index], goals[index], players[index])] = index
    return larger


@njit(cache=True)
def _grown(array: npt.NDArray[Any], capacity: int) -> npt.NDArray[Any]:
    larger: npt.NDArray[Any] = np.empty(capacity, dtype=array.dtype)
    larger[: array.size] = array
    return larger


@njit(cache=True)
def _grown_rows(array: npt.NDArray[Any], capacity: int) -> npt.NDArray[Any]:
    larger: npt.NDArray[Any] = np.empty((capacity, array.shape[1]), dtype=array.dtype)
    larger[: array.shape[0]] = array
    return larger


@njit(cache=True)
def _pushed(crates: Int16Array, index: int, beyond: int, out: Int16Array) -> None:
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
def _fresh_marks(wall: ByteArray) -> Int32Array:
    mark = np.zeros(wall.size, dtype=np.int32)
    for cell in range(wall.size):
        if wall[cell]:
            mark[cell] = NO_WAY
    return mark


@njit(cache=True)
def _write_region(
    region: WordArray, player: int, crates: Int16Array, width: int, mark: Int32Array, stamp: int, queue: Int32Array
) -> None:
    """Writes the bits of the cells that the player can walk to.

    `mark` holds earlier stamps on free cells and more than any stamp on walls.
    """
    region[:] = 0
    for crate in crates:
        mark[crate] = stamp
    mark[player] = stamp
    queue[0] = player
    begin, end = 0, 1
    while begin < end:
        cell = queue[begin]
        begin += 1
        region[cell >> 6] |= np.uint64(1) << np.uint64(cell & 63)
        for step in (-1, -width, 1, width):
            if mark[cell + step] < stamp:
                mark[cell + step] = stamp
                queue[end] = cell + step
                end += 1


@njit(cache=True)
def _holds(region: WordArray, cell: int) -> np.bool_:
    is_set: np.bool_ = (region[cell >> 6] >> np.uint64(cell & 63)) & np.uint64(1) != np.uint64(0)
    return is_set


@njit(cache=True)
def _path(parents: Int32Array, pushed: Int16Array, steps: Int16Array, index: int) -> Int32Array:
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


@njit(cache=True)
def fewest_pushes(  # noqa: C901, PLR0912, PLR0915  # one compiled loop over arrays that it alone grows
    board: Board, player: int, crates: Int16Array, goal: int, max_states: int
) -> tuple[int, int, Int32Array]:
    """A* over pushes.

    Args:
        board: What never changes.
        player: Cell of the player.
        crates: Cells of the crates, ascending.
        goal: Cell of the crate that has to reach the first target, 0 if any may.
        max_states: States to visit at most.

    Returns:
        Status, the number of states, and the (n, 2) pushes of a solution: crate cell and step.
    """
    n, width, wall = crates.size, board.width, board.wall
    nothing = np.empty((0, 2), dtype=np.int32)
    f = _bound(board, crates, goal)
    if f == NO_WAY:
        return UNSOLVABLE, 1, nothing

    capacity, entry_capacity = _FIRST_CAPACITY, _FIRST_CAPACITY
    states = np.empty((capacity, n), dtype=np.int16)
    goals = np.empty(capacity, dtype=np.int16)
    players = np.zeros(capacity, dtype=np.int16)  # the region stands for the player: all zero
    regions = np.empty((capacity, (wall.size + 63) >> 6), dtype=np.uint64)
    parents = np.empty(capacity, dtype=np.int32)
    pushed = np.empty(capacity, dtype=np.int16)
    steps = np.empty(capacity, dtype=np.int16)
    costs = np.empty(capacity, dtype=np.int32)
    chain = np.empty(capacity, dtype=np.int32)
    table = np.full(4 * capacity, -1, dtype=np.int32)
    # An entry of the queue: a state, the cost that it had then, the entry below in its stack.
    entries = np.empty((entry_capacity, 3), dtype=np.int32)
    stacks = np.full(f + 64, -1, dtype=np.int32)
    mark, queue = _fresh_marks(wall), np.empty(wall.size, dtype=np.int32)
    occupied = np.zeros(wall.size, dtype=np.uint8)
    moved = np.empty(n, dtype=np.int16)

    states[0], goals[0], parents[0], costs[0], chain[0] = crates, goal, -1, 0, -1
    table[_slot(table, states, goals, players, states[0], goal, 0)] = 0
    _write_region(regions[0], player, crates, width, mark, 1, queue)
    entries[0, 0], entries[0, 1], entries[0, 2] = 0, 0, -1
    stacks[f] = 0
    count, n_entries, waiting = 1, 1, 1
    while waiting > 0:
        if stacks[f] < 0:
            f += 1
            continue
        entry = stacks[f]
        index, cost, stacks[f] = entries[entry, 0], entries[entry, 1], entries[entry, 2]
        waiting -= 1
        if cost > costs[index]:
            continue
        if _is_solved(board, states[index], goals[index]):
            return SOLVED, count, _path(parents, pushed, steps, index)
        for k in range(n):
            occupied[states[index, k]] = 1
        for step in (-1, -width, 1, width):
            for k in range(n):
                crate = states[index, k]
                beyond = crate + step
                if wall[beyond] or occupied[beyond] or not _holds(regions[index], crate - step):
                    continue
                _pushed(states[index], k, beyond, moved)
                goal = beyond if crate == goals[index] else goals[index]
                bound = _bound(board, moved, goal)
                if bound == NO_WAY:
                    continue
                slot = _slot(table, states, goals, players, moved, goal, 0)
                head = table[slot]
                known = head
                while known >= 0 and not _holds(regions[known], crate):
                    known = chain[known]
                if known < 0:
                    if count >= max_states:
                        return LIMIT, count, nothing
                    if count == capacity:
                        capacity *= 2
                        states, regions = _grown_rows(states, capacity), _grown_rows(regions, capacity)
                        goals, players = _grown(goals, capacity), np.zeros(capacity, dtype=np.int16)
                        parents, chain, costs = (
                            _grown(parents, capacity),
                            _grown(chain, capacity),
                            _grown(costs, capacity),
                        )
                        pushed, steps = _grown(pushed, capacity), _grown(steps, capacity)
                        table = _rehashed(table, states, goals, players)
                        slot = _slot(table, states, goals, players, moved, goal, 0)
                    known = count
                    states[known], goals[known] = moved, goal
                    if head < 0:
                        table[slot], chain[known] = known, -1
                    else:
                        chain[known], chain[head] = chain[head], known
                    _write_region(regions[known], crate, moved, width, mark, count + 1, queue)
                    count += 1
                elif costs[known] <= cost + 1:
                    continue
                costs[known], parents[known], pushed[known], steps[known] = cost + 1, index, crate, step
                if n_entries == entry_capacity:
                    entry_capacity *= 2
                    entries = _grown_rows(entries, entry_capacity)
                stack = cost + 1 + bound
                if stack >= stacks.size:
                    filled = stacks.size
                    stacks = _grown(stacks, 2 * stack)
                    stacks[filled:] = -1
                entries[n_entries, 0], entries[n_entries, 1], entries[n_entries, 2] = known, cost + 1, stacks[stack]
                stacks[stack] = n_entries
                n_entries += 1
                waiting += 1
        for k in range(n):
            occupied[states[index, k]] = 0
    return UNSOLVABLE, count, nothing


@njit(cache=True)
def _write_walk_lengths(
    player: int, crates: Int16Array, wall: ByteArray, width: int, length: Int32Array, queue: Int32Array
) -> None:
    """Writes the steps of a shortest walk to each cell, -1 where none leads, -2 on crates."""
    length[:] = -1
    for crate in crates:
        length[crate] = -2
    length[player] = 0
    queue[0] = player
    begin, end = 0, 1
    while begin < end:
        cell = queue[begin]
        begin += 1
        for step in (-1, -width, 1, width):
            if length[cell + step] == -1 and not wall[cell + step]:
                length[cell + step] = length[cell] + 1
                queue[end] = cell + step
                end += 1


@njit(cache=True)
def fewest_moves(  # noqa: C901, PLR0915  # as above
    board: Board, player: int, crates: Int16Array, goal: int, max_states: int
) -> tuple[int, int, Int32Array]:
    """Dijkstra's algorithm over pushes with the walks before them as cost; arguments and result as `fewest_pushes`."""
    n, width, wall = crates.size, board.width, board.wall
    nothing = np.empty((0, 2), dtype=np.int32)
    if _bound(board, crates, goal) == NO_WAY:
        return UNSOLVABLE, 1, nothing

    capacity = _FIRST_CAPACITY
    states = np.empty((capacity, n), dtype=np.int16)
    goals = np.empty(capacity, dtype=np.int16)
    players = np.empty(capacity, dtype=np.int16)
    costs = np.empty(capacity, dtype=np.int64)
    parents = np.empty(capacity, dtype=np.int32)
    pushed = np.empty(capacity, dtype=np.int16)
    steps = np.empty(capacity, dtype=np.int16)
    table = np.full(4 * capacity, -1, dtype=np.int32)
    length, queue = np.empty(wall.size, dtype=np.int32), np.empty(wall.size, dtype=np.int32)
    moved = np.empty(n, dtype=np.int16)

    # Moves in the upper half of a cost, pushes in the lower: fewer moves come first, then fewer pushes.
    move_cost = np.int64(1) << 32
    states[0], goals[0], players[0], costs[0], parents[0] = crates, goal, player, 0, -1
    table[_slot(table, states, goals, players, states[0], goal, player)] = 0
    count = 1
    heap = [(np.int64(0), 0)]
    while len(heap) > 0:
        cost, index = heapq.heappop(heap)
        if cost > costs[index]:
            continue
        if _is_solved(board, states[index], goals[index]):
            return SOLVED, count, _path(parents, pushed, steps, index)
        _write_walk_lengths(players[index], states[index], wall, width, length, queue)
        for step in (-1, -width, 1, width):
            for k in range(n):
                crate = states[index, k]
                beyond = crate + step
                walk = length[crate - step]
                if wall[beyond] or length[beyond] == -2 or walk < 0:
                    continue
                _pushed(states[index], k, beyond, moved)
                goal = beyond if crate == goals[index] else goals[index]
                if _bound(board, moved, goal) == NO_WAY:
                    continue
                reached = cost + (walk + 1) * move_cost + 1
                slot = _slot(table, states, goals, players, moved, goal, crate)
                known = table[slot]
                if known >= 0 and costs[known] <= reached:
                    continue
                if known < 0:
                    if count >= max_states:
                        return LIMIT, count, nothing
                    if count == capacity:
                        capacity *= 2
                        states = _grown_rows(states, capacity)
                        goals, players = _grown(goals, capacity), _grown(players, capacity)
                        costs, parents = _grown(costs, capacity), _grown(parents, capacity)
                        pushed, steps = _grown(pushed, capacity), _grown(steps, capacity)
                        table = _rehashed(table, states, goals, players)
                        slot = _slot(table, states, goals, players, moved, goal, crate)
                    known = count
                    states[known], goals[known], players[known] = moved, goal, crate
                    table[slot] = known
                    count += 1
                costs[known], parents[known], pushed[known], steps[known] = reached, index, crate, step
                heapq.heappush(heap, (reached, known))
    return UNSOLVABLE, count, nothing
