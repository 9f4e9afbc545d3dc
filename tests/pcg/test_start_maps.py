import numpy as np
import pytest

from pcg.episodes import EpisodeSettings
from pcg.frozen import OPEN, FrozenTiles
from pcg.level import Level, Tile
from pcg.metrics import statistics
from pcg.reward import Control
from pcg.start_maps import start_maps


def controls(n: int, fewest: int, most: int) -> np.ndarray:
    """Controls that ask for a number of walls within a band."""
    asked = np.zeros((n, len(Control)))
    asked[:, Control.WALLS_LOW], asked[:, Control.WALLS_HIGH] = fewest, most
    return asked


def test_scattered_maps_have_about_the_wanted_walls():
    """Walls are drawn around the middle of the band, other things are rare."""
    maps = start_maps(np.random.default_rng(0), controls(400, 10, 20), EpisodeSettings())
    assert (maps == Tile.WALL).mean() == pytest.approx(0.15, abs=0.01)
    assert (maps == Tile.CRATE).mean() == pytest.approx(0.01, abs=0.003)


def test_drawn_maps_are_furnished():
    """Walls within the band, each number of them; one player, the wanted crates and targets; one region."""
    maps = start_maps(np.random.default_rng(0), controls(200, 10, 14), EpisodeSettings("flip"))
    counted = [statistics(Level(tiles)) for tiles in maps]
    assert {s.walls for s in counted} == set(range(10, 15))
    assert {(s.players, s.crates, s.targets, s.regions) for s in counted} == {(1, 2, 1, 1)}


@pytest.mark.parametrize("name", ["wide", "flip"])
def test_frozen_tiles_are_where_they_belong(name: str):
    """Every map has them; drawn ones have what they lack of walls and things around them."""
    tiles = np.full((10, 10), OPEN)
    tiles[5, :9] = Tile.WALL
    tiles[8, 8] = Tile.TARGET
    fixed = FrozenTiles(tiles)
    maps = start_maps(np.random.default_rng(0), controls(50, 20, 20), EpisodeSettings(name), fixed)
    assert all(fixed.kept_by(Level(each)) for each in maps)
    if name == "flip":
        counted = [statistics(Level(each)) for each in maps]
        assert {(s.walls, s.players, s.crates, s.targets) for s in counted} == {(20, 1, 2, 1)}


def test_impossible_bands_leave_what_fits():
    """Where not so many walls fit, or the ends of the band are exchanged, there is a map all the same."""
    full, exchanged = controls(5, 100, 100), controls(5, 11, 10)
    settings = EpisodeSettings("flip")
    assert (start_maps(np.random.default_rng(0), full, settings) == Tile.WALL).mean() > 0.3
    assert set((start_maps(np.random.default_rng(0), exchanged, settings) == Tile.WALL).sum(axis=(1, 2))) == {11}
