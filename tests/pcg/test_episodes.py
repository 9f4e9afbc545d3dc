import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pcg.episodes import Beginning, Episodes, EpisodeSettings
from pcg.level import Tile
from pcg.representation import REPRESENTATIONS
from pcg.request import Request
from pcg.reward import Control
from pcg.statistics_kernel import Column
from pcg.task import request_controls
from pcg.task_distribution import TaskDistribution
from tests.pcg.maps import solvable


def begun(settings: EpisodeSettings, n: int, seed: int = 0) -> tuple[Episodes, np.random.Generator]:
    """Episodes with drawn tasks, and the generator that drew them."""
    rng = np.random.default_rng(seed)
    episodes = Episodes(settings, n)
    episodes.begin(rng, np.arange(n), TaskDistribution().beginning(rng, n, settings))
    return episodes, rng


@given(st.integers(1, 40), st.integers(1, 40), st.floats(0.01, 2), st.floats(0.01, 5))
def test_budgets_are_shares_of_the_size(rows: int, columns: int, change_share: float, step_share: float):
    """Both budgets follow from the size at hand, and are never zero."""
    settings = EpisodeSettings(rows=rows, columns=columns, change_share=change_share, step_share=step_share)
    assert settings.max_changes == max(1, round(change_share * rows * columns))
    assert settings.max_steps == max(1, round(step_share * rows * columns))


@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_frozen_cells_keep_their_tiles(name: str):
    """No action changes a frozen cell, and trying costs no change."""
    settings = EpisodeSettings(name, step_share=100, change_share=100)
    episodes, rng = begun(settings, 16)
    frozen, before = episodes.frozen.astype(bool), episodes.maps.copy()
    assert frozen.any()
    for _ in range(200):
        episodes.step(rng.integers(episodes.representation.n_actions, size=16))
    assert (episodes.maps[frozen] == before[frozen]).all()
    assert (episodes.maps[~frozen] != before[~frozen]).any()


@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_changes_are_counted_where_a_tile_changed(name: str):
    """A change is one differing tile; each step makes at most one."""
    episodes, rng = begun(EpisodeSettings(name, step_share=10, change_share=10), 8)
    for step in range(1, 60):
        before, changes = episodes.maps.copy(), episodes.changes.copy()
        done = episodes.step(rng.integers(episodes.representation.n_actions, size=8))
        differing = (episodes.maps != before).sum(axis=(1, 2))
        assert (differing == done.changed).all()
        assert (episodes.changes - changes == differing).all()
        assert (episodes.steps == step).all()


def test_an_episode_ends_with_either_budget():
    """It is truncated, not terminated, at the last step or the last change."""
    few_steps, rng = begun(EpisodeSettings("narrow", step_share=0.05), 4)
    ends = [few_steps.step(np.zeros(4, dtype=np.int64)).truncated.tolist() for _ in range(5)]
    assert ends == [[False] * 4] * 4 + [[True] * 4]
    few_changes, rng = begun(EpisodeSettings("wide", change_share=0.03), 4)
    while not (done := few_changes.step(rng.integers(500, size=4))).truncated.any():
        assert (few_changes.changes < 3).all()
    assert (few_changes.changes[done.truncated] == 3).all()
    assert not done.terminated[done.truncated].any()


def test_success_terminates():
    """Writing the one missing tile of a level that meets the request ends the episode with the bonus."""
    request = Request(pushes=(5, 1000))
    (level,) = solvable(1, request)
    settings = EpisodeSettings("wide")
    tiles = level.tiles.copy()
    row, column = level.player
    tiles[row, column] = Tile.FLOOR
    episodes = Episodes(settings, 1)
    nothing_frozen = np.zeros((1, 10, 10), dtype=np.uint8)
    start = Beginning(tiles[None], nothing_frozen, request_controls(request)[None])
    episodes.begin(np.random.default_rng(0), np.array([0]), start)
    far = float(episodes.distance[0])
    done = episodes.step(np.array([5 * (10 * row + column) + Tile.PLAYER]))
    assert (bool(done.terminated[0]), bool(done.truncated[0])) == (True, False)
    assert done.reward[0] == pytest.approx(0.2 * (far + 5.0))
    assert episodes.is_valid()[0]


@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_rewards_add_up_to_the_way_covered(name: str):
    """Without success the rewards of an episode sum to the scaled decrease of the distance: nothing can be farmed."""
    settings = EpisodeSettings(name, step_share=10, change_share=10)
    episodes, rng = begun(settings, 16)
    start, total, succeeded = episodes.distance.copy(), np.zeros(16), np.zeros(16, dtype=bool)
    for _ in range(100):
        done = episodes.step(rng.integers(episodes.representation.n_actions, size=16))
        total += done.reward
        succeeded |= done.terminated
    gained = settings.reward.scale * (start - episodes.distance)
    assert total[~succeeded] == pytest.approx(gained[~succeeded])


def test_a_valid_map_has_the_wanted_numbers():
    """A solvable map with one crate too few is no valid level."""
    episodes, _ = begun(EpisodeSettings(), 2)
    episodes.statistics[:] = 0
    episodes.statistics[:, [Column.PLAYERS, Column.TARGETS, Column.SOLVABLE]] = 1
    episodes.statistics[:, Column.CRATES] = [2, 1]
    assert episodes.is_valid().tolist() == [True, False]


@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_edits_for_the_worse_are_taken_back(name: str):
    """No step leads away from what is wanted; what is taken back leaves map and statistics as they were, at no change."""
    settings = EpisodeSettings(name, step_share=10, change_share=10, takes_back=True)
    episodes, rng = begun(settings, 16)
    taken_back = 0
    for _ in range(150):
        before = episodes.maps.copy(), episodes.distance.copy(), episodes.statistics.copy(), episodes.changes.copy()
        done = episodes.step(rng.integers(episodes.representation.n_actions, size=16))
        maps, distance, statistics, changes = before
        assert (episodes.distance <= distance).all()
        assert (done.reward >= 0).all()
        assert (done.changed == (episodes.maps != maps).any(axis=(1, 2))).all()
        assert (episodes.changes == changes + done.changed).all()
        assert (episodes.statistics[~done.changed] == statistics[~done.changed]).all()
        fresh = Episodes(settings, 16)
        fresh.begin(rng, np.arange(16), Beginning(episodes.maps, episodes.frozen, episodes.controls))
        assert (fresh.statistics == episodes.statistics).all()
        taken_back += int((~done.changed).sum())
    assert taken_back > 0


@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_unknown_actions_are_refused(name: str):
    """An action out of range is named, a wrong number of actions too, and nothing is written."""
    episodes, _ = begun(EpisodeSettings(name), 2)
    before, last = episodes.maps.copy(), episodes.representation.n_actions - 1
    for wrong in (-1, last + 1):
        with pytest.raises(ValueError, match=f"0 to {last}"):
            episodes.step(np.array([0, wrong]))
    for count in (1, 3):
        with pytest.raises(ValueError, match="2 actions are needed"):
            episodes.step(np.zeros(count, dtype=np.int64))
    assert (episodes.maps == before).all()


def test_an_archive_of_another_shape_is_refused():
    """Its maps could not be compared."""
    with pytest.raises(ValueError, match="needs maps of 5 x 6 cells"):
        Episodes(EpisodeSettings(rows=5, columns=6), 1, np.zeros((3, 6, 5), dtype=np.uint8))


@pytest.mark.parametrize(("rows", "columns"), [(100, 101), (200, 200), (0, 5)])
def test_impossible_sizes_are_refused(rows: int, columns: int):
    """Compiled code numbers cells in 16 bits, so it must never see a larger board."""
    with pytest.raises(
        ValueError, match=f"{rows} x {columns} cells are too many|at least 1, found {rows} and {columns}"
    ):
        EpisodeSettings(rows=rows, columns=columns)


@pytest.mark.parametrize("shape", [(1, 10_000), (10_000, 1), (100, 100)])
def test_the_largest_maps_are_solved(shape: tuple[int, int]):
    """Whatever their shape: the last cells of the board have numbers, too."""
    tiles = np.zeros(10_000, dtype=np.uint8)
    tiles[[-6, -4, -2, -1]] = [Tile.PLAYER, Tile.CRATE, Tile.TARGET, Tile.CRATE]
    settings = EpisodeSettings("wide", *shape)
    episodes = Episodes(settings, 1)
    start = Beginning(tiles.reshape(1, *shape), np.zeros((1, *shape), dtype=np.uint8), np.zeros((1, len(Control))))
    episodes.begin(np.random.default_rng(0), np.array([0]), start)
    solvable, pushes, goal = episodes.statistics[0, [Column.SOLVABLE, Column.PUSHES, Column.GOAL]]
    assert (solvable, pushes, goal) == (1, 2, 9_996)


def test_unknown_representations_are_refused():
    """The message lists what there is."""
    with pytest.raises(ValueError, match="narrow, turtle, wide, flip"):
        EpisodeSettings("broad")
