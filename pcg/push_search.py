"""The fewest pushes: A* (Hart, Nilsson, Raphael 1968) over pushes, compiled.

Two player positions in one region of free cells are one state: each state keeps its region as a bit set, and states that
differ only in their regions are chained, so that a push back into a known region costs one look-up and no flood. One push
lowers the bound (see `pcg.solver_kernel`) by at most one, so a state that is expanded was reached in the fewest pushes. The
queue is one stack for each value of f.
"""

import numpy as np
from numba import njit

from pcg.arrays import ByteArray, Int16Array, Int32Array, WordArray
from pcg.solver_kernel import (
    FIRST_CAPACITY,
    LIMIT,
    NO_WAY,
    SOLVED,
    UNSOLVABLE,
    Board,
    bound_of,
    grown,
    grown_rows,
    is_solved,
    path_to,
    rehashed,
    slot_of,
    write_pushed,
)


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
    f = bound_of(board, crates, goal)
    if f == NO_WAY:
        return UNSOLVABLE, 1, nothing

    capacity, entry_capacity = FIRST_CAPACITY, FIRST_CAPACITY
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
    table[slot_of(table, states, goals, players, states[0], goal, 0)] = 0
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
        if is_solved(board, states[index], goals[index]):
            return SOLVED, count, path_to(parents, pushed, steps, index)
        for k in range(n):
            occupied[states[index, k]] = 1
        for step in (-1, -width, 1, width):
            for k in range(n):
                crate = states[index, k]
                beyond = crate + step
                if wall[beyond] or occupied[beyond] or not _holds(regions[index], crate - step):
                    continue
                write_pushed(states[index], k, beyond, moved)
                goal = beyond if crate == goals[index] else goals[index]
                bound = bound_of(board, moved, goal)
                if bound == NO_WAY:
                    continue
                slot = slot_of(table, states, goals, players, moved, goal, 0)
                head = table[slot]
                known = head
                while known >= 0 and not _holds(regions[known], crate):
                    known = chain[known]
                if known < 0:
                    if count >= max_states:
                        return LIMIT, count, nothing
                    if count == capacity:
                        capacity *= 2
                        states, regions = grown_rows(states, capacity), grown_rows(regions, capacity)
                        goals, players = grown(goals, capacity), np.zeros(capacity, dtype=np.int16)
                        parents, chain, costs = (
                            grown(parents, capacity),
                            grown(chain, capacity),
                            grown(costs, capacity),
                        )
                        pushed, steps = grown(pushed, capacity), grown(steps, capacity)
                        table = rehashed(table, states, goals, players)
                        slot = slot_of(table, states, goals, players, moved, goal, 0)
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
                    entries = grown_rows(entries, entry_capacity)
                stack = cost + 1 + bound
                if stack >= stacks.size:
                    filled = stacks.size
                    stacks = grown(stacks, 2 * stack)
                    stacks[filled:] = -1
                entries[n_entries, 0], entries[n_entries, 1], entries[n_entries, 2] = known, cost + 1, stacks[stack]
                stacks[stack] = n_entries
                n_entries += 1
                waiting += 1
        for k in range(n):
            occupied[states[index, k]] = 0
    return UNSOLVABLE, count, nothing
