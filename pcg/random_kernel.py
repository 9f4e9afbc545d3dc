"""Random levels in compiled code: walls that leave the free cells in one region, then everything else, then the solver.

Tiles are flat: cell (row, column) is `row * columns + column`. The boards of the solver have a border of wall; see
`pcg.solver_kernel`.
"""

import numpy as np
import numpy.typing as npt
from numba import njit

from pcg.frozen import OPEN
from pcg.level import Tile, TileArray
from pcg.solver_kernel import LIMIT, SOLVED, fewest_pushes, make_board

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
    things: npt.NDArray[np.uint8],
    low: int,
    high: int,
    dependency: int,
    max_states: int,
    attempts: int,
    tiles: TileArray,
    counts: npt.NDArray[np.int64],
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
            depends = _depends(wall, width, player, crates, targets, path, max_states)
            if depends == (dependency == ALWAYS):
                return True
            counts[DEPENDENCY] += 1
    return False


@njit(cache=True)
def _board(tiles: TileArray) -> tuple[TileArray, int, npt.NDArray[np.int16], npt.NDArray[np.int32]]:
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
def _depends(
    wall: TileArray,
    width: int,
    player: int,
    crates: npt.NDArray[np.int16],
    targets: npt.NDArray[np.int32],
    path: npt.NDArray[np.int32],
    max_states: int,
) -> bool:
    """Whether the crate that `path` brings to the first target cannot get there when the others are walls."""
    goal = targets[0]
    for i in range(path.shape[0] - 1, -1, -1):
        if path[i, 0] + path[i, 1] == goal:
            goal = path[i, 0]
    closed = wall.copy()
    for crate in crates:
        if crate != goal:
            closed[crate] = 1
    if closed[targets[0]]:
        return True
    alone = np.empty(1, dtype=np.int16)
    alone[0] = goal
    status, _, _ = fewest_pushes(make_board(closed, width, targets[:1]), player, alone, 0, max_states)
    return bool(status != SOLVED)


@njit(cache=True)
def draw_level(
    rng: np.random.Generator, frozen: TileArray, walls: int, things: npt.NDArray[np.uint8], tiles: TileArray
) -> bool:
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
    rows, columns = frozen.shape
    flat, fixed = tiles.ravel(), frozen.ravel()
    for cell in range(flat.size):
        flat[cell] = FLOOR if fixed[cell] == _OPEN else fixed[cell]
    if not _add_walls(rng, flat, fixed, rows, columns, walls):
        return False
    free = np.empty(flat.size, dtype=np.int64)
    n_free = 0
    for cell in range(flat.size):
        if fixed[cell] == _OPEN and flat[cell] == FLOOR:
            free[n_free] = cell
            n_free += 1
    if n_free < things.size:
        return False
    order = rng.permutation(n_free)
    for i in range(things.size):
        flat[free[order[i]]] = things[i]
    return True


@njit(cache=True)
def _add_walls(
    rng: np.random.Generator, flat: TileArray, fixed: TileArray, rows: int, columns: int, walls: int
) -> bool:
    stack = np.empty(flat.size, dtype=np.int64)
    seen = np.empty(flat.size, dtype=np.bool_)
    for cell in rng.permutation(flat.size):
        if walls == 0:
            break
        if fixed[cell] != _OPEN:
            continue
        flat[cell] = WALL
        if _stays_connected(flat, rows, columns, cell) or is_connected(flat, rows, columns, stack, seen):
            walls -= 1
        else:
            flat[cell] = FLOOR
    return bool(walls == 0)


@njit(cache=True)
def _stays_connected(flat: TileArray, rows: int, columns: int, cell: int) -> bool:
    """Whether the eight cells around a new wall join its free neighbours, so that it cannot divide anything.

    The ring is walked once; each free run of it that holds a direct neighbour is a part. One part, or none, is safe.
    """
    row, column = divmod(cell, columns)
    parts, in_run, run_counted, first_free, first_counted = 0, False, False, False, False
    for i in range(8):
        down = (-1, -1, 0, 1, 1, 1, 0, -1)[i]
        right = (0, 1, 1, 1, 0, -1, -1, -1)[i]
        r, c = row + down, column + right
        free = 0 <= r < rows and 0 <= c < columns and flat[r * columns + c] != WALL
        if free and not in_run:
            run_counted = False
        if free and i % 2 == 0 and not run_counted:
            parts += 1
            run_counted = True
        in_run = free
        if i == 0:
            first_free, first_counted = free, free
    # The last run goes on at the beginning of the ring.
    if in_run and first_free and run_counted and first_counted and parts > 1:
        parts -= 1
    return parts <= 1


@njit(cache=True)
def is_connected(
    flat: TileArray, rows: int, columns: int, stack: npt.NDArray[np.int64], seen: npt.NDArray[np.bool_]
) -> bool:
    """Whether the cells without wall are one region, or none; `stack` and `seen` are (rows * columns,) scratch."""
    n_free, start = 0, -1
    for cell in range(flat.size):
        seen[cell] = flat[cell] == WALL
        if not seen[cell]:
            n_free += 1
            start = cell
    if n_free == 0:
        return True
    stack[0], height, met = start, 1, 1
    seen[start] = True
    while height:
        height -= 1
        row, column = divmod(stack[height], columns)
        for i in range(4):
            r = row + (-1, 1, 0, 0)[i]
            c = column + (0, 0, -1, 1)[i]
            if 0 <= r < rows and 0 <= c < columns and not seen[r * columns + c]:
                seen[r * columns + c] = True
                stack[height] = r * columns + c
                height += 1
                met += 1
    return bool(met == n_free)
