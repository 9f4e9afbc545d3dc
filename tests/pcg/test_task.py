import numpy as np

from pcg.episodes import EpisodeSettings
from pcg.frozen import OPEN, FrozenTiles
from pcg.level import Tile
from pcg.request import Request
from pcg.reward import Control
from pcg.task import request_beginning, request_controls


def test_controls_say_what_the_request_says():
    """Densities become numbers of walls within the band, flags signs."""
    asked = request_controls(Request(wall_density=(0.07, 0.104), pushes=(7, 11), occluded=False, dependency=True))
    assert asked[[Control.WALLS_LOW, Control.WALLS_HIGH]].tolist() == [7, 10]
    assert asked[[Control.PUSHES_LOW, Control.PUSHES_HIGH]].tolist() == [7, 11]
    assert asked[[Control.OCCLUDED, Control.DEPENDENCY]].tolist() == [-1, 1]
    assert request_controls(Request())[[Control.OCCLUDED, Control.DEPENDENCY]].tolist() == [0, 0]


def test_start_maps_hold_the_frozen_tiles():
    """Every start map has them, flagged; the other cells are random."""
    tiles = np.full((10, 10), OPEN)
    tiles[0] = Tile.WALL
    tiles[5, 5] = Tile.TARGET
    begun = request_beginning(np.random.default_rng(0), 20, Request(frozen=FrozenTiles(tiles)), EpisodeSettings())
    assert (begun.maps[:, 0] == Tile.WALL).all()
    assert (begun.maps[:, 5, 5] == Tile.TARGET).all()
    assert (begun.frozen.sum(axis=(1, 2)) == 11).all()
    assert len({tiles.tobytes() for tiles in begun.maps}) == 20
