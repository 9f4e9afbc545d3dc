"""The compiled searches of the Sokoban solver: fewest pushes, and fewest moves.

Boards are flat with a border of wall: inner cell (row, column) is number `(row + 1) * width + column + 1` with `width =
columns + 2`, so no step needs a bounds check. A state holds the cells of the crates in ascending order and that of the
goal crate, 0 (a wall) where any crate will do.

*Fewest pushes* is breadth-first over pushes. Two player positions in one region of free cells are one state: each state
keeps its region as a bit set, and states that differ only in their regions are chained, so that a push back into a
known region costs one look-up and no flood. *Fewest moves* is Dijkstra's algorithm (1959) over pushes with the walk
before each as its cost; there the player's cell belongs to the state, and of solutions with as many moves one with the
fewest pushes is found.

*Live* cells of a target are those from which a lone crate can be pushed to it, found by pulling backwards from the
target. A state is cut off when fewer live crates than targets remain, or when the goal crate has left the live cells
of the first target: nothing else is pruned, so `UNSOLVABLE` is a proof.
"""

import heapq
from typing import Any

import numpy as np
import numpy.typing as npt
from numba import njit

Int16Array = npt.NDArray[np.int16]
Int32Array = npt.NDArray[np.int32]
ByteArray = npt.NDArray[np.uint8]
WordArray = npt.NDArray[np.uint64]

SOLVED, UNSOLVABLE, LIMIT = 0, 1, 2

_FIRST_CAPACITY = 512
_ALWAYS_BLOCKED = np.iinfo(np.int32).max


@njit(cache=True)
def live_cells(wall: ByteArray, width: int, targets: Int32Array) -> ByteArray:
    """Flags of the cells from which a lone crate can be pushed to one of `targets`."""
    live = np.zeros(wall.size, dtype=np.uint8)
    queue = np.empty(wall.size, dtype=np.int32)
    end = 0
    for target in targets:
        live[target] = 1
        queue[end] = target
        end += 1
    begin = 0
    while begin < end:
        cell = queue[begin]
        begin += 1
        for step in (-1, -width, 1, width):
            before = cell - step
            if not wall[before] and not live[before] and not wall[before - step]:
                live[before] = 1
                queue[end] = before
                end += 1
    return live


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
def _is_hopeless(crates: Int16Array, goal: int, live: ByteArray, live_first: ByteArray, n_targets: int) -> bool:
    if goal != 0 and not live_first[goal]:
        return True
    alive = 0
    for crate in crates:
        alive += live[crate]
    return alive < n_targets


@njit(cache=True)
def _is_solved(crates: Int16Array, goal: int, is_target: ByteArray, first_target: int, n_targets: int) -> bool:
    if goal != 0 and goal != first_target:  # noqa: PLR1714 - a tuple of two integer types is not compiled
        return False
    covered = 0
    for crate in crates:
        covered += is_target[crate]
    return covered == n_targets


@njit(cache=True)
def _flood(player: int, crates: Int16Array, width: int, mark: Int32Array, stamp: int, queue: Int32Array) -> int:
    """Marks the cells that the player can walk to with `stamp` and lists them in `queue`; returns their number.

    `mark` holds earlier stamps on free cells and more than any stamp on walls.
    """
    for crate in crates:
        mark[crate] = stamp
    mark[player] = stamp
    queue[0] = player
    begin, end = 0, 1
    while begin < end:
        cell = queue[begin]
        begin += 1
        for step in (-1, -width, 1, width):
            if mark[cell + step] < stamp:
                mark[cell + step] = stamp
                queue[end] = cell + step
                end += 1
    return end


@njit(cache=True)
def _fresh_marks(wall: ByteArray) -> Int32Array:
    mark = np.zeros(wall.size, dtype=np.int32)
    for cell in range(wall.size):
        if wall[cell]:
            mark[cell] = _ALWAYS_BLOCKED
    return mark


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
def fewest_pushes(  # noqa: C901, PLR0912, PLR0915 - one compiled loop over arrays that it alone grows
    wall: ByteArray, width: int, player: int, crates: Int16Array, goal: int, targets: Int32Array, max_states: int
) -> tuple[int, int, Int32Array]:
    """Breadth-first search over pushes.

    Args:
        wall: (cells,) flags of the bordered board.
        width: Cells of one of its rows.
        player: Cell of the player.
        crates: Cells of the crates, ascending.
        goal: Cell of the crate that has to reach the first target, 0 if any may.
        targets: Cells of the targets, ascending, at least one.
        max_states: States to visit at most.

    Returns:
        Status, the number of states, and the (n, 2) pushes of a solution: crate cell and step.
    """
    n, n_targets, first_target = crates.size, targets.size, targets[0]
    words = (wall.size + 63) >> 6
    live, live_first = live_cells(wall, width, targets), live_cells(wall, width, targets[:1])
    is_target = np.zeros(wall.size, dtype=np.uint8)
    for target in targets:
        is_target[target] = 1
    nothing = np.empty((0, 2), dtype=np.int32)
    if _is_solved(crates, goal, is_target, first_target, n_targets):
        return SOLVED, 1, nothing
    if _is_hopeless(crates, goal, live, live_first, n_targets):
        return UNSOLVABLE, 1, nothing

    capacity = _FIRST_CAPACITY
    states = np.empty((capacity, n), dtype=np.int16)
    goals = np.empty(capacity, dtype=np.int16)
    players = np.zeros(capacity, dtype=np.int16)  # the region stands for the player: all zero
    regions = np.zeros((capacity, words), dtype=np.uint64)
    parents = np.empty(capacity, dtype=np.int32)
    pushed = np.empty(capacity, dtype=np.int16)
    steps = np.empty(capacity, dtype=np.int16)
    chain = np.empty(capacity, dtype=np.int32)
    table = np.full(4 * capacity, -1, dtype=np.int32)
    mark, queue = _fresh_marks(wall), np.empty(wall.size, dtype=np.int32)
    occupied = np.zeros(wall.size, dtype=np.uint8)
    moved = np.empty(n, dtype=np.int16)

    states[0], goals[0], parents[0], chain[0] = crates, goal, -1, -1
    table[_slot(table, states, goals, players, states[0], goal, 0)] = 0
    for k in range(_flood(player, crates, width, mark, 1, queue)):
        cell = queue[k]
        regions[0, cell >> 6] |= np.uint64(1) << np.uint64(cell & 63)
    count, index = 1, 0
    while index < count:
        for k in range(n):
            occupied[states[index, k]] = 1
        for step in (-1, -width, 1, width):
            for k in range(n):
                crate = states[index, k]
                stand, beyond = crate - step, crate + step
                if wall[beyond] or occupied[beyond]:
                    continue
                if not (regions[index, stand >> 6] >> np.uint64(stand & 63)) & np.uint64(1):
                    continue
                _pushed(states[index], k, beyond, moved)
                goal = beyond if crate == goals[index] else goals[index]
                if _is_hopeless(moved, goal, live, live_first, n_targets):
                    continue
                slot = _slot(table, states, goals, players, moved, goal, 0)
                head = table[slot]
                met = head
                while met >= 0 and not (regions[met, crate >> 6] >> np.uint64(crate & 63)) & np.uint64(1):
                    met = chain[met]
                if met >= 0:
                    continue
                solved = _is_solved(moved, goal, is_target, first_target, n_targets)
                if not solved and count >= max_states:
                    return LIMIT, count, nothing
                if count == capacity:
                    capacity *= 2
                    states, goals, players = (
                        _grown_rows(states, capacity),
                        _grown(goals, capacity),
                        np.zeros(capacity, dtype=np.int16),
                    )
                    regions = _grown_rows(regions, capacity)
                    regions[count:] = 0
                    parents, chain = _grown(parents, capacity), _grown(chain, capacity)
                    pushed, steps = _grown(pushed, capacity), _grown(steps, capacity)
                    table = _rehashed(table, states, goals, players)
                    slot = _slot(table, states, goals, players, moved, goal, 0)
                states[count], goals[count], parents[count] = moved, goal, index
                pushed[count], steps[count] = crate, step
                if solved:
                    return SOLVED, count + 1, _path(parents, pushed, steps, count)
                if head < 0:
                    table[slot], chain[count] = count, -1
                else:
                    chain[count], chain[head] = chain[head], count
                for q in range(_flood(crate, moved, width, mark, count + 1, queue)):
                    cell = queue[q]
                    regions[count, cell >> 6] |= np.uint64(1) << np.uint64(cell & 63)
                count += 1
        for k in range(n):
            occupied[states[index, k]] = 0
        index += 1
    return UNSOLVABLE, count, nothing


@njit(cache=True)
def _walk_lengths(
    player: int, crates: Int16Array, wall: ByteArray, width: int, length: Int32Array, queue: Int32Array
) -> None:
    """Writes the steps of a shortest walk to each cell, -1 where none leads."""
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
def fewest_moves(  # noqa: C901, PLR0912, PLR0915 - one compiled loop over arrays that it alone grows
    wall: ByteArray, width: int, player: int, crates: Int16Array, goal: int, targets: Int32Array, max_states: int
) -> tuple[int, int, Int32Array]:
    """Dijkstra's algorithm over pushes with the walks between them as cost; arguments and result as `fewest_pushes`."""
    n, n_targets, first_target = crates.size, targets.size, targets[0]
    live, live_first = live_cells(wall, width, targets), live_cells(wall, width, targets[:1])
    is_target = np.zeros(wall.size, dtype=np.uint8)
    for target in targets:
        is_target[target] = 1
    nothing = np.empty((0, 2), dtype=np.int32)
    if _is_solved(crates, goal, is_target, first_target, n_targets):
        return SOLVED, 1, nothing
    if _is_hopeless(crates, goal, live, live_first, n_targets):
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

    # Cost: moves in the upper half, pushes in the lower, so that fewer moves come first and then fewer pushes.
    move_cost = np.int64(1) << 32
    states[0], goals[0], players[0], costs[0], parents[0] = crates, goal, player, 0, -1
    table[_slot(table, states, goals, players, states[0], goal, player)] = 0
    count = 1
    heap = [(np.int64(0), 0)]
    while len(heap) > 0:
        cost, index = heapq.heappop(heap)
        if cost > costs[index]:
            continue
        if _is_solved(states[index], goals[index], is_target, first_target, n_targets):
            return SOLVED, count, _path(parents, pushed, steps, index)
        _walk_lengths(players[index], states[index], wall, width, length, queue)
        for step in (-1, -width, 1, width):
            for k in range(n):
                crate = states[index, k]
                stand, beyond = crate - step, crate + step
                if wall[beyond] or length[beyond] == -2 or length[stand] < 0:
                    continue
                _pushed(states[index], k, beyond, moved)
                goal = beyond if crate == goals[index] else goals[index]
                if _is_hopeless(moved, goal, live, live_first, n_targets):
                    continue
                reached = cost + (length[stand] + 1) * move_cost + 1
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
