"""One step of many episodes in one compiled call: with a single environment, calls cost more than the work."""

import numpy as np
from numba import njit

from pcg.arrays import BoolArray, FloatArray, Int32Array, IntArray
from pcg.level import TileArray
from pcg.representation import KEEP
from pcg.reward import Wanted, distances
from pcg.statistics_kernel import Judge, edit


@njit(cache=True)
def advance(
    maps: TileArray,
    frozen: TileArray,
    cells: IntArray,
    tiles: IntArray,
    statistics: Int32Array,
    controls: FloatArray,
    distance: FloatArray,
    judge: Judge,
    wanted: Wanted,
) -> BoolArray:
    """Writes a tile in every map where it differs from the one that is there and the cell is not frozen.

    Args:
        maps: (n, rows, columns) tiles, written to.
        frozen: (n, rows, columns) flags.
        cells: (n,) cells to write to, `row * columns + column`.
        tiles: (n,) tiles to write, `KEEP` for none.
        statistics: (n, len(Column)), true before, and after.
        controls: (n, len(Control)).
        distance: (n,) to what is wanted, true before, and after.
        judge: Decides about furnished maps.
        wanted: Targets and weights of the distance.

    Returns:
        (n,) whether a tile was changed.
    """
    changed = np.zeros(len(cells), dtype=np.bool_)
    for k in range(len(cells)):
        i, j = cells[k] // maps.shape[2], cells[k] % maps.shape[2]
        changed[k] = tiles[k] != KEEP and tiles[k] != maps[k, i, j] and frozen[k, i, j] == 0
    chosen = np.flatnonzero(changed)
    edit(maps, chosen, cells[chosen], tiles[chosen], statistics, judge)
    distances(statistics, controls, chosen, wanted, distance)
    return changed
