"""Whether the goal crate depends on the others, in compiled code; `pcg.dependency` says what that means.

Boards are flat with a border of wall, see `pcg.solver_kernel`.
"""

import numpy as np
from numba import njit

from pcg.arrays import ByteArray, Int16Array, Int32Array
from pcg.push_search import fewest_pushes
from pcg.solver_kernel import SOLVED, make_board, start_of


@njit(cache=True)
def depends(
    wall: ByteArray, width: int, player: int, crates: Int16Array, target: int, path: Int32Array, max_states: int
) -> bool:
    """Whether the crate that `path` brings to `target` could not get there if the others were walls.

    Args:
        wall: (cells,) flags.
        width: Cells of a row.
        player: Cell of the player.
        crates: Cells of the crates.
        target: Cell of the first target.
        path: (n, 2) pushes of a solution: crate cell and step.
        max_states: Limit of the solver.
    """
    goal, own_pushes = start_of(path, target)
    if own_pushes == len(path):
        # No other crate moves, so they might as well be walls.
        return False
    closed = wall.copy()
    for crate in crates:
        if crate != goal:
            closed[crate] = 1
    if closed[target]:
        return True
    alone = np.empty(1, dtype=np.int16)
    alone[0] = goal
    only = np.empty(1, dtype=np.int32)
    only[0] = target
    status, _, _ = fewest_pushes(make_board(closed, width, only), player, alone, 0, max_states)
    return bool(status != SOLVED)
