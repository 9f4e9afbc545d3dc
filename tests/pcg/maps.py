"""Random maps and levels for the tests of the generator."""

from itertools import islice

import numpy as np

from pcg.level import Level, Tile, TileArray
from pcg.random_source import RandomSource
from pcg.request import Request


def scattered(rng: np.random.Generator, n: int, shape: tuple[int, int], things: float = 0.05) -> TileArray:
    """(n, rows, columns) maps with independent tiles, any number of players, crates and targets."""
    chances = [0.75 - 3 * things, 0.25, things, things, things]
    return rng.choice(5, size=(n, *shape), p=chances).astype(np.uint8)


def furnished(rng: np.random.Generator, n: int, crates: int = 2) -> TileArray:
    """(n, 10, 10) maps with one player, some crates and one target, at various wall densities."""
    maps = np.zeros((n, 10, 10), dtype=np.uint8)
    for tiles in maps:
        tiles[rng.random((10, 10)) < rng.uniform(0.02, 0.25)] = Tile.WALL
        cells = rng.permutation(np.argwhere(tiles == Tile.FLOOR))
        for (row, column), tile in zip(cells, [Tile.PLAYER, Tile.TARGET, *[Tile.CRATE] * crates], strict=False):
            tiles[row, column] = tile
    return maps


def solvable(count: int, request: Request | None = None, seed: int = 0) -> list[Level]:
    """Levels that a request allows."""
    proposals = RandomSource().proposals(request or Request(), seed)
    levels = (proposal.level for proposal in proposals if proposal.level is not None)
    return list(islice(levels, count))
