import numpy as np

from pcg.episodes import EpisodeSettings
from pcg.level import Tile
from pcg.request import MAX_PUSHES
from pcg.reward import Control
from pcg.task_distribution import TaskDistribution


def test_controls_are_drawn_from_the_ranges():
    """Bands are bands, within the ranges; the shares of flags and open bands are about those asked for."""
    tasks = TaskDistribution(occluded_share=0.2, dependency_share=0.1, open_share=0.5)
    drawn = tasks.controls(np.random.default_rng(0), 4000, 100)
    assert (drawn[:, Control.WALLS_LOW] < drawn[:, Control.WALLS_HIGH]).all()
    assert (drawn[:, Control.PUSHES_LOW] <= drawn[:, Control.PUSHES_HIGH]).all()
    assert set(drawn[:, Control.PUSHES_LOW]) == set(range(3, 19))
    for share, found in (
        (0.2, drawn[:, Control.OCCLUDED] == 1),
        (0.2, drawn[:, Control.OCCLUDED] == -1),
        (0.1, drawn[:, Control.DEPENDENCY] == 1),
        (0.5, drawn[:, Control.PUSHES_HIGH] == MAX_PUSHES),
    ):
        assert abs(found.mean() - share) < 0.03


def test_only_walls_and_floor_are_frozen():
    """Some tasks freeze a rectangle of the start map, but nothing that has to be moved about."""
    settings = EpisodeSettings()
    begun = TaskDistribution(frozen_share=0.5).beginning(np.random.default_rng(0), 400, settings)
    frozen = begun.frozen.astype(bool)
    assert 0.3 < frozen.any(axis=(1, 2)).mean() < 0.6
    assert set(begun.maps[frozen]) == {Tile.FLOOR, Tile.WALL}
