import numpy as np
import pytest

from pcg.arrays import BoolArray
from pcg.frozen import OPEN, FrozenTiles
from pcg.grid import Cell, cells_of, reachable
from pcg.level import Level, Tile
from pcg.metrics import statistics
from pcg.random_kernel import draw_level

THINGS = np.array([Tile.PLAYER, Tile.CRATE, Tile.CRATE, Tile.TARGET], dtype=np.uint8)


def plain_level(rng: np.random.Generator, frozen: FrozenTiles, walls: int) -> Level | None:
    """The plain twin of the compiled function."""
    is_wall = frozen.tiles == Tile.WALL
    for cell in rng.permutation(is_wall.size).tolist():
        if walls == 0:
            break
        place = divmod(cell, is_wall.shape[1])
        if not frozen.is_open[place]:
            continue
        is_wall[place] = True
        if is_connected(~is_wall):
            walls -= 1
        else:
            is_wall[place] = False
    tiles = np.where(is_wall, Tile.WALL, np.where(frozen.is_open, Tile.FLOOR, frozen.tiles)).astype(np.uint8)
    free: list[Cell] = cells_of(frozen.is_open & ~is_wall)
    if walls > 0 or len(free) < len(THINGS):
        return None
    for place, thing in zip((free[i] for i in rng.permutation(len(free))), THINGS.tolist(), strict=False):
        tiles[place] = thing
    return Level(tiles)


def is_connected(passable: BoolArray) -> bool:
    """Whether all passable cells are one region."""
    return not passable.any() or bool((reachable(passable, cells_of(passable)[:1]) == passable).all())


def frozen_tiles(seed: int) -> FrozenTiles:
    """Open cells, and in every second case a wall with a gap and a few fixed floors."""
    tiles = np.full((7, 9), OPEN, dtype=np.uint8)
    if seed % 2:
        tiles[3, 1:] = Tile.WALL
        tiles[:, 0] = Tile.FLOOR
    return FrozenTiles(tiles)


@pytest.mark.parametrize("walls", [0, 3, 20, 30, 58])
def test_the_same_levels_as_the_plain_twin(walls: int):
    """One generator gives one level, cell by cell, or none to both."""
    for seed in range(40):
        frozen = frozen_tiles(seed)
        tiles = np.empty(frozen.shape, dtype=np.uint8)
        drawn = draw_level(np.random.default_rng(seed), frozen.tiles, walls, THINGS, tiles)
        twin = plain_level(np.random.default_rng(seed), frozen, walls)
        assert drawn == (twin is not None)
        if twin is not None:
            assert Level(tiles) == twin


def test_drawn_levels_have_one_region():
    """The quick test by neighbours never lets a wall divide the free cells."""
    frozen, rng = FrozenTiles.none(10, 10), np.random.default_rng(0)
    tiles = np.empty((10, 10), dtype=np.uint8)
    for walls in range(0, 45, 5):
        assert draw_level(rng, frozen.tiles, walls, THINGS, tiles)
        counted = statistics(Level(tiles))
        assert (counted.walls, counted.regions, counted.players, counted.crates) == (walls, 1, 1, 2)
