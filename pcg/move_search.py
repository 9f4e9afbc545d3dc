"""The fewest moves: Dijkstra's algorithm (1959) over pushes with the walk before each as its cost, compiled.

The player's cell belongs to the state, and of solutions with as many moves one with the fewest pushes is found.
"""

import heapq

import numpy as np
from numba import njit

from pcg.arrays import ByteArray, Int16Array, Int32Array
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
def fewest_moves(  # noqa: C901, PLR0915  # one compiled loop over arrays that it alone grows
    board: Board, player: int, crates: Int16Array, goal: int, max_states: int
) -> tuple[int, int, Int32Array]:
    """Dijkstra's algorithm over pushes with the walks before them as cost; arguments and result as `push_search.fewest_pushes`."""
    n, width, wall = crates.size, board.width, board.wall
    nothing = np.empty((0, 2), dtype=np.int32)
    if bound_of(board, crates, goal) == NO_WAY:
        return UNSOLVABLE, 1, nothing

    capacity = FIRST_CAPACITY
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
    table[slot_of(table, states, goals, players, states[0], goal, player)] = 0
    count = 1
    heap = [(np.int64(0), 0)]
    while len(heap) > 0:
        cost, index = heapq.heappop(heap)
        if cost > costs[index]:
            continue
        if is_solved(board, states[index], goals[index]):
            return SOLVED, count, path_to(parents, pushed, steps, index)
        _write_walk_lengths(players[index], states[index], wall, width, length, queue)
        for step in (-1, -width, 1, width):
            for k in range(n):
                crate = states[index, k]
                beyond = crate + step
                walk = length[crate - step]
                if wall[beyond] or length[beyond] == -2 or walk < 0:
                    continue
                write_pushed(states[index], k, beyond, moved)
                goal = beyond if crate == goals[index] else goals[index]
                if bound_of(board, moved, goal) == NO_WAY:
                    continue
                reached = cost + (walk + 1) * move_cost + 1
                slot = slot_of(table, states, goals, players, moved, goal, crate)
                known = table[slot]
                if known >= 0 and costs[known] <= reached:
                    continue
                if known < 0:
                    if count >= max_states:
                        return LIMIT, count, nothing
                    if count == capacity:
                        capacity *= 2
                        states = grown_rows(states, capacity)
                        goals, players = grown(goals, capacity), grown(players, capacity)
                        costs, parents = grown(costs, capacity), grown(parents, capacity)
                        pushed, steps = grown(pushed, capacity), grown(steps, capacity)
                        table = rehashed(table, states, goals, players)
                        slot = slot_of(table, states, goals, players, moved, goal, crate)
                    known = count
                    states[known], goals[known], players[known] = moved, goal, crate
                    table[slot] = known
                    count += 1
                costs[known], parents[known], pushed[known], steps[known] = reached, index, crate, step
                heapq.heappush(heap, (reached, known))
    return UNSOLVABLE, count, nothing
