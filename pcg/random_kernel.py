"""Random levels in compiled code: walls that leave the free cells in one region, then everything else, then the solver.

Tiles are flat: cell (row, column) is `row * columns + column`. The boards of the solver have a border of wall; see
`pcg.solver_kernel`.
"""

import numpy as np
from numba import njit

from pcg.arrays import ByteArray, Int16Array, Int32Array, IntArray
from pcg.dependency_kernel import depends
from pcg.frozen import OPEN
from pcg.level import Tile, TileArray
from pcg.push_search import fewest_pushes
from pcg.region_kernel import count_regions, fill, make_scratch, parts_around
from pcg.solver_kernel import LIMIT, SOLVED, make_board

FLOOR, WALL, PLAYER, CRATE, TARGET, CRATE_ON_TARGET, PLAYER_ON_TARGET = (int(tile) for tile in Tile)
_OPEN = OPEN

NO_ROOM, UNSOLVABLE, UNDECIDED, EASY, HARD, DEPENDENCY = range(6)
"""Why a draw was thrown away: the places of `draw_until`'s counts."""
EITHER, NEVER, ALWAYS = range(3)
"""Whether a dependency is wanted."""


@njit(cache=True)
def draw_until(
    rng: np.random.Generator,
    frozen: TileArray,
    walls: int,
    things: ByteArray,
    low: int,
    high: int,
    dependency: int,
    max_states: int,
    attempts: int,
    tiles: TileArray,
    counts: IntArray,
) -> bool:
    """Draws levels into `tiles` until one is solved by a number of pushes from `low` to `high`; see `draw_level`.

    Args:
        rng: Of all random choices.
        frozen: As for `draw_level`, and the next two.
        walls: Walls to add.
        things: Tiles to place.
        low: Pushes at least.
        high: Pushes at most.
        dependency: Whether another crate has to move first: `EITHER`, `NEVER` or `ALWAYS`.
        max_states: Limit of the solver.
        attempts: Levels to draw at most.
        tiles: (rows, columns), written to.
        counts: (6,) draws thrown away by reason, added to.

    Returns:
        Whether `tiles` holds such a level.
    """
    width = frozen.shape[1] + 2
    for _ in range(attempts):
        if not draw_level(rng, frozen, walls, things, tiles):
            counts[NO_ROOM] += 1
            continue
        wall, player, crates, targets = _board(tiles)
        status, _, path = fewest_pushes(make_board(wall, width, targets), player, crates, 0, max_states)
        if status != SOLVED:
            counts[UNDECIDED if status == LIMIT else UNSOLVABLE] += 1
        elif path.shape[0] < low:
            counts[EASY] += 1
        elif path.shape[0] > high:
            counts[HARD] += 1
        elif dependency == EITHER:
            return True
        else:
            if depends(wall, width, player, crates, targets[0], path, max_states) == (dependency == ALWAYS):
                return True
            counts[DEPENDENCY] += 1
    return False


@njit(cache=True)
def _board(tiles: TileArray) -> tuple[TileArray, int, Int16Array, Int32Array]:
    """Walls, player, crates and targets as the solver wants them."""
    rows, columns = tiles.shape
    width = columns + 2
    wall = np.ones((rows + 2) * width, dtype=np.uint8)
    crates, targets = np.empty(tiles.size, dtype=np.int16), np.empty(tiles.size, dtype=np.int32)
    player, n_crates, n_targets = 0, 0, 0
    for row in range(rows):
        for column in range(columns):
            tile, cell = tiles[row, column], (row + 1) * width + column + 1
            wall[cell] = tile == WALL
            if tile in (PLAYER, PLAYER_ON_TARGET):
                player = cell
            if tile in (CRATE, CRATE_ON_TARGET):
                crates[n_crates] = cell
                n_crates += 1
            if tile in (TARGET, PLAYER_ON_TARGET, CRATE_ON_TARGET):
                targets[n_targets] = cell
                n_targets += 1
    return wall, player, crates[:n_crates], targets[:n_targets]


@njit(cache=True)
def draw_level(rng: np.random.Generator, frozen: TileArray, walls: int, things: ByteArray, tiles: TileArray) -> bool:
    """Draws a level into `tiles`.

    Walls are added to open cells in random order, leaving out each that would divide the free cells, until their number
    is reached; then the things are placed on distinct free cells.

    Args:
        rng: Of all random choices.
        frozen: (rows, columns) tiles to keep, `OPEN` elsewhere; its cells without wall are in one region.
        walls: Walls to add.
        things: (n,) tiles to place, in this order.
        tiles: (rows, columns), written to.

    Returns:
        Whether the walls and things fitted in.
    """
    for i in range(frozen.shape[0]):
        for j in range(frozen.shape[1]):
            tiles[i, j] = FLOOR if frozen[i, j] == _OPEN else frozen[i, j]
    if not _add_walls(rng, tiles, frozen, walls):
        return False
    flat, fixed = tiles.ravel(), frozen.ravel()
    free = np.flatnonzero((fixed == _OPEN) & (flat == FLOOR))
    if free.size < things.size:
        return False
    order = rng.permutation(free.size)
    for i in range(things.size):
        flat[free[order[i]]] = things[i]
    return True


@njit(cache=True)
def _add_walls(rng: np.random.Generator, tiles: TileArray, frozen: TileArray, walls: int) -> bool:
    scratch = make_scratch(*tiles.shape)
    for cell in rng.permutation(tiles.size):
        if walls == 0:
            break
        i, j = divmod(cell, tiles.shape[1])
        if frozen[i, j] != _OPEN:
            continue
        tiles[i, j] = WALL
        if parts_around(tiles, i, j) > 1:
            fill(scratch, tiles)
            if count_regions(scratch) > 1:
                tiles[i, j] = FLOOR
                continue
        walls -= 1
    return walls == 0
