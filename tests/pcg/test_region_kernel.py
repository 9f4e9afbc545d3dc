from itertools import product

import numpy as np
import pytest

from pcg.grid import count_regions as plain_count
from pcg.level import Tile
from pcg.region_kernel import count_regions, fill, make_scratch, parts_around
from tests.pcg.maps import scattered


@pytest.mark.parametrize("shape", [(10, 10), (3, 7), (1, 5)])
def test_regions_are_those_of_the_grid(shape: tuple[int, int]):
    """One scratch memory after the other counts as the plain function does."""
    scratch = make_scratch(*shape)
    for tiles in scattered(np.random.default_rng(0), 100, shape):
        fill(scratch, tiles)
        assert count_regions(scratch) == plain_count(tiles != Tile.WALL)


def test_parts_are_regions_of_the_ring():
    """All 256 surroundings of a cell: as many parts as regions of the eight cells that hold a direct neighbour."""
    ring = [(0, 0), (0, 1), (0, 2), (1, 2), (2, 2), (2, 1), (2, 0), (1, 0)]
    for free in product((False, True), repeat=8):
        passable = np.zeros((3, 3), dtype=np.bool_)
        for cell, is_free in zip(ring, free, strict=True):
            passable[cell] = is_free
        # Corners that touch no free neighbour are regions of their own, which do not count.
        without_corners = passable.copy()
        for i, j in product((0, 2), repeat=2):
            without_corners[i, j] &= passable[i, 1] or passable[1, j]
        tiles = np.where(passable, Tile.FLOOR, Tile.WALL).astype(np.uint8)
        assert parts_around(tiles, 1, 1) == plain_count(without_corners)


@pytest.mark.parametrize("cell", [(0, 0), (0, 1), (1, 2)])
def test_outside_of_the_map_nothing_is_free(cell: tuple[int, int]):
    """A cell at the border of an empty map has one part around it, the only cell of a map none."""
    assert parts_around(np.zeros((3, 3), dtype=np.uint8), *cell) == 1
    assert parts_around(np.zeros((1, 1), dtype=np.uint8), 0, 0) == 0
