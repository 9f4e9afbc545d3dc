"""Merged walls: the fewest rectangles, and exactly the same geometry as the blocks of the single cells."""

from collections.abc import Sequence
from functools import cache

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from converter.convert import ConversionSettings, convert_level
from converter.formats.body_document import MAX_PARTS
from converter.merge_walls import Rectangle, merged
from converter.preset import BLOCK_PREFIX
from converter.scene import Body, Scene
from pcg.arrays import BoolArray
from pcg.grid import Cell, cells_of
from pcg.level import Level

SIDES = st.integers(1, 5)
SEEDS = st.integers(0, 2**32 - 1)


def mask(text: str) -> BoolArray:
    """The walls `#` of a text, one row a word."""
    return np.array([[character == "#" for character in row] for row in text.split()])


def random_mask(rows: int, columns: int, seed: int) -> BoolArray:
    """Walls of random density."""
    rng = np.random.default_rng(seed)
    return rng.random((rows, columns)) < rng.uniform(0.1, 1.0)


def least(cells: frozenset[Cell]) -> int:
    """The least number of rectangles that partition `cells`, by trying every rectangle at the first cell."""

    @cache
    def least_of(rest: frozenset[Cell]) -> int:
        if not rest:
            return 0
        return min(1 + least_of(rest - rectangle) for rectangle in _rectangles_at(min(rest), rest))

    return least_of(cells)


def _rectangles_at(corner: Cell, cells: frozenset[Cell]) -> list[frozenset[Cell]]:
    (top, left), found, width = corner, [], len(cells)
    for bottom in range(top, top + len(cells)):
        run = 0
        while run < width and (bottom, left + run) in cells:
            run += 1
        width = run
        found += [frozenset(Rectangle(top, left, bottom, right).cells) for right in range(left, left + width)]
    return found


@pytest.mark.parametrize(
    ("text", "rectangles"),
    [
        ("...", []),
        ("#", [Rectangle(0, 0, 0, 0)]),
        (".## .##", [Rectangle(0, 1, 1, 2)]),
        ("#. .#", [Rectangle(0, 0, 0, 0), Rectangle(1, 1, 1, 1)]),
        (".#. ### .#.", [Rectangle(0, 1, 2, 1), Rectangle(1, 0, 1, 0), Rectangle(1, 2, 1, 2)]),
        ("##. ### .##", [Rectangle(0, 0, 0, 1), Rectangle(1, 0, 1, 2), Rectangle(2, 1, 2, 2)]),
        ("### #.# ###", None),
    ],
)
def test_small_walls(text: str, rectangles: list[Rectangle] | None):
    """Nothing, one cell, a block, a diagonal, a plus, a step; a ring needs four."""
    found = merged(mask(text))
    assert len(found) == 4 if rectangles is None else found == rectangles


def test_a_chord_resolves_two_corners():
    """One cut between the two inner corners leaves two rectangles; the largest one, in the middle, would leave three."""
    found = merged(mask("###. ###. ###. .### .### .###"))
    assert found == [Rectangle(0, 0, 2, 2), Rectangle(3, 1, 5, 3)]


@given(SIDES, SIDES, SEEDS)
def test_the_fewest_disjoint_rectangles(rows: int, columns: int, seed: int):
    """Every wall cell is in exactly one rectangle, no other cell in any, and no partition has fewer."""
    walls = random_mask(rows, columns, seed)
    found = merged(walls)
    count = np.zeros(walls.shape, dtype=int)
    for rectangle in found:
        for cell in rectangle.cells:
            count[cell] += 1
    np.testing.assert_array_equal(count, walls)
    assert found == sorted(found)
    assert len(found) == least(frozenset(cells_of(walls)))


@given(SIDES, SIDES, st.integers(1, 12))
def test_pieces_of_a_rectangle(rows: int, columns: int, most: int):
    """Pieces cover each cell once and none is larger than asked for."""
    rectangle = Rectangle(2, 3, rows + 1, columns + 2)
    pieces = rectangle.pieces(most)
    assert sorted(cell for piece in pieces for cell in piece.cells) == rectangle.cells
    assert max(len(piece.cells) for piece in pieces) <= most


def converted(walls: BoolArray, preset: str, cell: float, *, merge: bool) -> Scene:
    """The scene of a level with these walls and a free row above them."""
    tiles = np.vstack([np.zeros((1, max(3, walls.shape[1]))), np.pad(walls, ((0, 0), (0, max(0, 3 - walls.shape[1]))))])
    tiles[0, :3] = [2, 3, 4]
    settings = ConversionSettings(preset=preset, cell=cell, merge_walls=merge)
    return convert_level(Level(tiles.astype(np.uint8), goal_crate=(0, 1)), settings)


def blocks_of(scene: Scene) -> list[Body]:
    """The bodies that wall cells became."""
    return [wall for wall in scene.walls if wall.name.startswith(BLOCK_PREFIX)]


def space(blocks: Sequence[Body]) -> shapely.Geometry:
    """The union of sharp footprints in whole micrometres, so that it is computed without rounding."""
    corners = [np.rint((core + block.position[:2]) * 1e6) for block in blocks for core in block.cores]
    return shapely.union_all([shapely.Polygon(polygon) for polygon in corners])


@given(st.integers(1, 8), st.integers(1, 8), SEEDS, st.sampled_from([0.4, 0.35, 0.5]))
def test_merged_walls_fill_the_same_space(rows: int, columns: int, seed: int, cell: float):
    """In preset `clear` the union of the larger boxes is the union of the blocks, at the same heights."""
    walls = random_mask(rows, columns, seed)
    single, joined = (blocks_of(converted(walls, "clear", cell, merge=merge)) for merge in (False, True))
    assert len(joined) <= len(single) == walls.sum()
    assert all(len(block.parts) == 1 and block.parts[0].box_size is not None for block in joined)
    assert space(single).equals(space(joined))
    assert {block.bottom_top for block in joined} <= {(0.0, 0.4)}


@given(st.integers(1, 8), st.integers(1, 8), SEEDS, st.sampled_from([0.4, 0.35, 0.5]))
def test_merged_rounded_walls_have_the_same_parts(rows: int, columns: int, seed: int, cell: float):
    """In preset `published` the notches between rounded blocks stay: the parts are the same, in fewer bodies."""
    walls = random_mask(rows, columns, seed)
    single, joined = (blocks_of(converted(walls, "published", cell, merge=merge)) for merge in (False, True))
    assert len(joined) == len(merged(walls))

    def parts(blocks: Sequence[Body]) -> list[object]:
        return sorted(
            (part.edge_radius, np.round(core + block.position[:2], 9).tolist())
            for block in blocks
            for part, core in zip(block.parts, block.cores, strict=True)
        )

    assert parts(single) == parts(joined)


def test_no_body_has_too_many_parts():
    """A large block of rounded cells becomes several bodies."""
    joined = blocks_of(converted(np.ones((11, 11), dtype=np.bool_), "published", 0.4, merge=True))
    assert sum(len(block.parts) for block in joined) == 121
    assert max(len(block.parts) for block in joined) <= MAX_PARTS


def test_names_of_merged_walls():
    """The lower left and the upper right cell, counted from the lower left corner; single cells keep their names."""
    names = [block.name for block in blocks_of(converted(mask("##. ##. ..#"), "clear", 0.4, merge=True))]
    assert names == ["block_1_2_to_2_3", "block_3_1"]
