import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from pcg.errors import InputError
from pcg.grid import Cell
from pcg.level import Level, Tile, TileArray

TILES = hnp.arrays(
    np.uint8, hnp.array_shapes(min_dims=2, max_dims=2, max_side=5), elements=st.integers(0, len(Tile) - 1)
)
ALL_TILES = Level(np.array([[0, 1, 2, 3], [4, 5, 6, 0]]))


def test_things_are_listed_in_reading_order():
    """Every accessor finds its tiles, those on targets too."""
    assert ALL_TILES.shape == (2, 4)
    assert ALL_TILES.players == [(0, 2), (1, 2)]
    assert ALL_TILES.crates == [(0, 3), (1, 1)]
    assert ALL_TILES.targets == [(1, 0), (1, 1), (1, 2)]
    assert ALL_TILES.is_wall.tolist() == [[False, True, False, False], [False] * 4]


@given(TILES)
def test_a_level_is_the_sum_of_its_things(tiles: TileArray):
    """A level put together from the things of another one equals it."""
    level = Level(tiles)
    assert Level.of(level.is_wall, players=level.players, crates=level.crates, targets=level.targets) == level


def test_tiles_are_a_read_only_copy():
    """Neither the given array nor the level's own can change a level."""
    tiles = np.zeros((2, 2), dtype=np.uint8)
    level = Level(tiles)
    tiles[0, 0] = Tile.WALL
    assert not level.is_wall.any()
    with pytest.raises(ValueError, match="read-only"):
        level.tiles[0, 0] = Tile.WALL
    with pytest.raises(ValueError, match="read-only"):
        level.is_wall[0, 0] = True


@pytest.mark.parametrize(
    ("tiles", "problem"),
    [
        ([0, 1], "shape"),
        (np.zeros((0, 3), dtype=int), "shape"),
        ([[7]], "0 to 6"),
        ([[-1]], "0 to 6"),
        ([[256]], "0 to 6"),
        ([[0.5]], "0 to 6"),
    ],
)
def test_bad_tiles_are_refused(tiles: list[list[float]], problem: str):
    """Tiles must be a table of known values; none wraps around into a valid one."""
    with pytest.raises(ValueError, match=problem):
        Level(np.array(tiles))


@pytest.mark.parametrize("name", [" a", "a ", "a\nb", "a\x1bb"])
def test_names_are_one_printable_line(name: str):
    """A name that could not be written as a line of its own is refused."""
    with pytest.raises(ValueError, match="printable line"):
        Level(np.zeros((1, 1), dtype=int), name)


def test_the_goal_crate_is_a_crate():
    """A crate on a target can be the goal crate, a floor cell cannot."""
    assert dataclasses.replace(ALL_TILES, goal_crate=(1, 1)).goal_crate == (1, 1)
    with pytest.raises(ValueError, match="not a crate"):
        dataclasses.replace(ALL_TILES, goal_crate=(0, 0))


def test_equality_covers_tiles_shape_name_and_goal_crate():
    """Levels that differ in any of these differ; equal ones have one hash."""
    wide, tall = (Level(np.full(shape, Tile.CRATE)) for shape in ((1, 2), (2, 1)))
    variants = [wide, tall, dataclasses.replace(wide, name="a"), dataclasses.replace(wide, goal_crate=(0, 0))]
    assert len({*variants, *map(dataclasses.replace, variants)}) == len(variants)
    assert wide != "level"


@pytest.mark.parametrize("things", [{"players": [(0, 0)]}, {"crates": [(0, 1)] * 2}, {"targets": [(0, 1)] * 2}])
def test_two_things_cannot_share_a_cell(things: dict[str, list[Cell]]):
    """A wall takes nothing, and no cell takes two crates or two targets."""
    with pytest.raises(ValueError, match="taken"):
        Level.of(np.array([[True, False]]), **things)


@pytest.mark.parametrize(
    ("tiles", "problem"),
    [
        ([[3, 4]], "no players"),
        ([[2, 2, 3, 4]], "2 players"),
        ([[2, 3]], "no target"),
        ([[2, 3, 4, 4]], r"fewer crates \(1\) than targets \(2\)"),
    ],
)
def test_unplayable_levels_are_refused(tiles: list[list[int]], problem: str):
    """The message names the place and what is missing or too much."""
    with pytest.raises(InputError, match=f"file: .*{problem}"):
        Level(np.array(tiles)).require_playable("file")


def test_playable_levels_may_have_more_crates_than_targets():
    """A surplus crate is allowed, and a thing on a target counts for both."""
    Level(np.array([[2, 3, 5]])).require_playable("file")
    Level(np.array([[6, 3]])).require_playable("file")


def test_the_player_is_the_only_one():
    """Asking for the player of a level with none or two is an error."""
    assert Level(np.array([[0, 6]])).player == (0, 1)
    for tiles in ([[0]], [[2, 6]]):
        with pytest.raises(ValueError, match="not one"):
            _ = Level(np.array(tiles)).player
