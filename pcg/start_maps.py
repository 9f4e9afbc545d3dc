"""The maps that editing episodes start from."""

import numpy as np

from pcg.arrays import FloatArray
from pcg.episodes import EpisodeSettings
from pcg.frozen import FrozenTiles
from pcg.level import Tile, TileArray
from pcg.random_kernel import draw_level
from pcg.reward import Control
from pcg.statistics_kernel import CRATE, FLOOR, PLAYER, TARGET, WALL


def start_maps(
    rng: np.random.Generator, controls: FloatArray, settings: EpisodeSettings, fixed: FrozenTiles | None = None
) -> TileArray:
    """(n, rows, columns) maps for (n, len(Control)) controls, with the fixed tiles; `drawn` for flip, else `scattered`."""
    fixed = fixed or FrozenTiles.none(settings.rows, settings.columns)
    kind = drawn if settings.representation == "flip" else scattered
    return kind(rng, controls, fixed, settings)


def scattered(
    rng: np.random.Generator, controls: FloatArray, fixed: FrozenTiles, settings: EpisodeSettings
) -> TileArray:
    """Independent tiles: walls at about the wanted density, a few things, else floor."""
    n = len(controls)
    middle = controls[:, [Control.WALLS_LOW, Control.WALLS_HIGH]].mean(axis=1) / settings.cells
    chance = np.clip(middle + rng.uniform(-settings.wall_spread, settings.wall_spread, n), 0.0, 1.0)
    drawn = rng.random((n, settings.rows, settings.columns)) - chance[:, None, None]
    maps = np.full(drawn.shape, FLOOR, dtype=np.uint8)
    for k, tile in enumerate((PLAYER, CRATE, TARGET)):
        maps[(drawn >= k * settings.thing_share) & (drawn < (k + 1) * settings.thing_share)] = tile
    maps[drawn < 0] = WALL
    return np.where(fixed.is_open, maps, fixed.tiles)


def drawn(rng: np.random.Generator, controls: FloatArray, fixed: FrozenTiles, settings: EpisodeSettings) -> TileArray:
    """Attempts of the random baseline: a number of walls within the band, all things, the free cells in one region.

    Where so many walls do not fit, as many as do; where the frozen tiles leave no room for the things, none.
    """
    wanted = {Tile.PLAYER: 1, Tile.CRATE: settings.reward.crates, Tile.TARGET: settings.reward.targets}
    missing = {tile: max(0, number - _count(fixed, tile)) for tile, number in wanted.items()}
    things = np.repeat(np.array(list(missing), dtype=np.uint8), list(missing.values()))
    fewest, most = controls[:, [Control.WALLS_LOW, Control.WALLS_HIGH]].astype(np.int64).T
    walls = rng.integers(fewest, np.maximum(fewest, most), endpoint=True)
    maps = np.empty((len(controls), settings.rows, settings.columns), dtype=np.uint8)
    for tiles, number in zip(maps, np.maximum(walls - _count(fixed, Tile.WALL), 0).tolist(), strict=True):
        draw_level(rng, fixed.tiles, number, things, tiles)
    return maps


def _count(fixed: FrozenTiles, tile: Tile) -> int:
    return int((fixed.tiles == tile).sum())
