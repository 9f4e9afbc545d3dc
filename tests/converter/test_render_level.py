from dataclasses import replace

import numpy as np
import pytest

from converter.raster import Image, paint
from converter.render_level import GOAL_CRATE, GOAL_CRATE_ON_TARGET, level_drawing, tile_drawings
from converter.theme import PAPER, Color
from pcg.level import Level, Tile


@pytest.fixture
def every_tile():
    """A level of one row in which cell i holds tile i."""
    return Level(np.array([[tile.value for tile in Tile]]))


def image_of(level: Level, tile_px: int = 40) -> Image:
    """The picture of a level, a tile `tile_px` pixels wide."""
    return paint(level_drawing(level), (level.shape[1] + 2) * tile_px)


def tile_at(image: Image, row: int, column: int, tile_px: int = 40) -> Image:
    """Pixels of a cell; rows and columns count the outer wall."""
    return image[row * tile_px : (row + 1) * tile_px, column * tile_px : (column + 1) * tile_px]


def share(tile: Image, color: Color) -> float:
    """Share of a tile's pixels that have `color`."""
    return (tile == np.rint(np.array(color) * 255)).all(axis=-1).mean()


def test_size_includes_the_outer_wall(every_tile: Level):
    """A level of 1 x 7 cells is a picture of 3 x 9 tiles."""
    assert image_of(every_tile, 16).shape == (3 * 16, 9 * 16, 3)


@pytest.mark.parametrize("width_px", [77, 148, 250, 401, 500])
def test_tiles_meet_at_any_width(width_px: int):
    """Between tiles of floor nothing shines through, however many pixels a tile has."""
    image = paint(level_drawing(Level(np.zeros((8, 10), dtype=np.uint8))), width_px)
    tile_px = width_px / 12
    first, beyond = int(np.ceil(tile_px)) + 1, int(11 * tile_px) - 1
    inner = image[first : int(9 * tile_px) - 1, first:beyond]
    assert inner.min() >= np.rint(np.array(PAPER.floor_line) * 255).min()


def test_outer_wall_surrounds_the_level(every_tile: Level):
    """Each tile of the border is the picture of a wall."""
    image = image_of(every_tile)
    wall = tile_at(image, 1, 1 + Tile.WALL)
    border = [(row, column) for row in range(3) for column in range(9) if row != 1 or column in (0, 8)]
    assert share(wall, PAPER.wall) > 0.5
    assert all(np.array_equal(tile_at(image, row, column), wall) for row, column in border)


@pytest.mark.parametrize(
    ("tile", "colors"),
    [
        (Tile.FLOOR, [PAPER.floor]),
        (Tile.WALL, [PAPER.wall]),
        (Tile.PLAYER, [PAPER.floor, PAPER.agent]),
        (Tile.CRATE, [PAPER.floor, PAPER.crate]),
        (Tile.TARGET, [PAPER.floor, PAPER.goal]),
        (Tile.CRATE_ON_TARGET, [PAPER.floor, PAPER.crate, PAPER.goal]),
        (Tile.PLAYER_ON_TARGET, [PAPER.floor, PAPER.agent, PAPER.goal]),
    ],
)
def test_tiles_show_their_content(every_tile: Level, tile: Tile, colors: list[Color]):
    """A tile has the colours of what it holds, and of nothing else that a tile can hold."""
    pixels = tile_at(image_of(every_tile), 1, 1 + tile)
    possible = [PAPER.floor, PAPER.wall, PAPER.agent, PAPER.crate, PAPER.goal, PAPER.goal_object]
    assert [color for color in possible if share(pixels, color) > 0.02] == [c for c in possible if c in colors]


@pytest.mark.parametrize("tile", [Tile.CRATE, Tile.CRATE_ON_TARGET])
def test_goal_crate_is_blue(every_tile: Level, tile: Tile):
    """Only the crate that has to reach the goal has the goal-object's colour, on a target or not."""
    image = image_of(replace(every_tile, goal_crate=(0, int(tile))))
    blue = [share(tile_at(image, 1, 1 + other), PAPER.goal_object) > 0.02 for other in Tile]
    assert blue == [other is tile for other in Tile]
    red = share(tile_at(image, 1, 1 + tile), PAPER.goal) > 0.02
    assert red == (tile is Tile.CRATE_ON_TARGET)


def test_there_is_a_drawing_for_every_kind_of_tile():
    """The kinds are numbered without a gap, so that an array of kinds can index them."""
    assert sorted(tile_drawings(PAPER)) == [*map(int, Tile), GOAL_CRATE, GOAL_CRATE_ON_TARGET]


def test_row_0_is_at_the_top():
    """A player in the first row and last column is in the upper right."""
    tiles = np.zeros((3, 4), dtype=np.uint8)
    tiles[0, 3] = Tile.PLAYER
    image = image_of(Level(tiles))
    assert image[60, 4 * 40 + 20].tolist() == [247, 189, 79]


@pytest.mark.parametrize("tile_px", [4, 7, 100])
def test_any_tile_size_shows_walls_and_player(tile_px: int):
    """The middle of a tile keeps its colour down to small sizes."""
    image = image_of(Level(np.array([[Tile.PLAYER]])), tile_px)
    middle = tile_px // 2
    assert image.shape == (3 * tile_px, 3 * tile_px, 3)
    assert image[tile_px + middle, tile_px + middle].tolist() == [247, 189, 79]
    assert np.abs(image[middle, middle] - np.array(PAPER.wall) * 255).max() < 30
