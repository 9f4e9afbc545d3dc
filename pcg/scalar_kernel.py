"""The scalars of an observation, in compiled code.

Counts and distances are scaled so that most of them are within -2 to 2, and all within plus and minus `SCALAR_LIMIT`.
"""

import numpy as np
from numba import njit

from pcg.arrays import Float32Array, FloatArray, Int32Array, IntArray
from pcg.reward import Control, outside
from pcg.statistics_kernel import Column

SCALARS = 24
"""Scalars of an observation."""

SCALAR_LIMIT = 10.0

_PLAYERS, _CRATES, _TARGETS, _WALLS, _REGIONS, _SOLVABLE, _PUSHES = (int(column) for column in list(Column)[:7])
_OCCLUDED, _DEPENDENCY = int(Column.OCCLUDED), int(Column.DEPENDENCY)
_WALLS_LOW, _WALLS_HIGH, _PUSHES_LOW, _PUSHES_HIGH, _WANT_OCCLUDED, _WANT_DEPENDENCY = (int(c) for c in Control)


@njit(cache=True)
def _clipped(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)


@njit(cache=True)
def write_scalars(
    statistics: Int32Array,
    controls: FloatArray,
    distance: FloatArray,
    spent: tuple[IntArray, IntArray],
    budgets: tuple[int, int],
    wanted: tuple[int, int],
    cells: int,
    out: Float32Array,
) -> None:
    """Writes counts, distances, flags, controls and what is left of the budgets.

    Args:
        statistics: (n, len(Column)).
        controls: (n, len(Control)).
        distance: (n,) to what is wanted.
        spent: (n,) changes and (n,) steps done.
        budgets: Changes and steps of an episode.
        wanted: Crates and targets wanted.
        cells: Cells of a map.
        out: (n, SCALARS), written to.
    """
    tenth = cells / 10
    crates, targets = wanted
    for k in range(len(statistics)):
        s, c, o = statistics[k], controls[k], out[k]
        walls, pushes = s[_WALLS], s[_PUSHES]
        o[0] = _clipped(s[_PLAYERS] - 1, -1, 4) / 2
        o[1] = _clipped(s[_CRATES] - crates, -4, 4) / 2
        o[2] = _clipped(s[_TARGETS] - targets, -4, 4) / 2
        o[3] = _clipped(s[_REGIONS] - 1, -1, 4) / 2
        o[4] = walls / tenth / 2
        o[5] = min(outside(walls, c[_WALLS_LOW], np.inf) / tenth, 2)
        o[6] = min(outside(walls, 0, c[_WALLS_HIGH]) / tenth, 2)
        o[7] = s[_SOLVABLE]
        o[8] = min(pushes / 10, SCALAR_LIMIT)
        o[9] = min(outside(pushes, c[_PUSHES_LOW], np.inf) / 10, 4)
        o[10] = min(outside(pushes, 0, c[_PUSHES_HIGH]) / 10, 4)
        o[11] = s[_OCCLUDED]
        o[12] = s[_DEPENDENCY]
        o[13] = c[_WALLS_LOW] / tenth / 2
        o[14] = c[_WALLS_HIGH] / tenth / 2
        o[15] = min(c[_PUSHES_LOW] / 10, SCALAR_LIMIT)
        # An open band would be far outside of the range that a network knows.
        o[16] = min(c[_PUSHES_HIGH], 40) / 10
        o[17] = c[_WANT_OCCLUDED]
        o[18] = c[_WANT_DEPENDENCY]
        o[19] = c[_WANT_OCCLUDED] * (2 * s[_OCCLUDED] - 1) * s[_SOLVABLE]
        o[20] = c[_WANT_DEPENDENCY] * (2 * s[_DEPENDENCY] - 1) * s[_SOLVABLE]
        o[21] = min(distance[k] / 10, 2)
        o[22] = 1 - spent[0][k] / budgets[0]
        o[23] = 1 - spent[1][k] / budgets[1]
