import numpy as np
import pytest

from pcg.episodes import Episodes, EpisodeSettings
from pcg.observation import WINDOW, observation_parts, observation_size, observations
from pcg.representation import REPRESENTATIONS
from pcg.reward import Control
from pcg.scalar_kernel import SCALAR_LIMIT, SCALARS
from pcg.statistics_kernel import CRATE_PASSES, PUSHED_FROM, Column
from pcg.task_distribution import TaskDistribution


def played(name: str, shape: tuple[int, int] = (6, 9), n: int = 5, steps: int = 20) -> Episodes:
    """Episodes after some random steps."""
    settings = EpisodeSettings(name, *shape)
    rng = np.random.default_rng(0)
    episodes = Episodes(settings, n)
    episodes.begin(rng, np.arange(n), TaskDistribution().beginning(rng, n, settings))
    for _ in range(steps):
        episodes.step(rng.integers(episodes.representation.n_actions, size=n))
    return episodes


@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_vectors_hold_the_map_the_position_and_the_window(name: str):
    """Part by part the vector says what the episode holds."""
    episodes = played(name)
    cells = episodes.settings.cells
    vectors = observations(episodes)
    assert vectors.shape == (5, observation_size(episodes.settings))
    for k, vector in enumerate(vectors):
        one_hot, frozen, goal, rest = np.split(vector, [5 * cells, 6 * cells, 7 * cells])
        assert (one_hot.reshape(cells, 5).argmax(axis=1) == episodes.maps[k].ravel()).all()
        assert (one_hot.reshape(cells, 5).sum(axis=1) == 1).all()
        assert (frozen == episodes.frozen[k].ravel()).all()
        assert np.flatnonzero(goal).tolist() == [c for c in [episodes.statistics[k, Column.GOAL]] if c >= 0]
        if name == "flip":
            passed, pushed_from, rest = np.split(rest, [cells, 2 * cells])
            marks = episodes.statistics[k, len(Column) :]
            assert (CRATE_PASSES * passed + PUSHED_FROM * pushed_from == marks).all()
        elif name != "wide":
            position, window, rest = np.split(rest, [cells, cells + 7 * WINDOW**2])
            here = int(episodes.representation.positions()[k])
            assert np.flatnonzero(position).tolist() == [here]
            check_window(window, episodes, k, *divmod(here, 9))
        assert rest.shape == (SCALARS,)


def check_window(window: np.ndarray, episodes: Episodes, k: int, row: int, column: int) -> None:
    """Every cell of the window holds the tile there, or 5 and frozen outside of the map."""
    tiles, frozen = window[: 6 * WINDOW**2].reshape(WINDOW, WINDOW, 6).argmax(axis=2), window[6 * WINDOW**2 :]
    for i, j in np.ndindex(WINDOW, WINDOW):
        r, c = row + i - 2, column + j - 2
        inside = 0 <= r < episodes.settings.rows and 0 <= c < episodes.settings.columns
        assert tiles[i, j] == (episodes.maps[k, r, c] if inside else 5)
        assert frozen[i * WINDOW + j] == (episodes.frozen[k, r, c] if inside else 1)


@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_parts_of_chosen_episodes_are_those_of_all(name: str):
    """Observing some episodes gives their rows of the observation of all."""
    episodes = played(name)
    chosen = np.array([3, 1])
    everything, some = observation_parts(episodes), observation_parts(episodes, chosen)
    assert everything.keys() == some.keys()
    for part in some:
        assert (some[part] == everything[part][chosen]).all()


def test_observations_are_copies():
    """What was observed does not change with the episode."""
    episodes = played("wide")
    before = observation_parts(episodes)
    kept = {name: part.copy() for name, part in before.items()}
    for _ in range(10):
        episodes.step(np.arange(5) * 13 % 270)
    assert all((before[name] == kept[name]).all() for name in kept)


def test_scalars_by_hand():
    """Counts, distances to the bands, flags, controls and what is left of the budgets, in their order."""
    episodes = played("narrow", (10, 10), n=1, steps=0)
    for column, value in {
        Column.PLAYERS: 1, Column.CRATES: 3, Column.TARGETS: 1, Column.WALLS: 25, Column.REGIONS: 2,
        Column.SOLVABLE: 1, Column.PUSHES: 5, Column.OCCLUDED: 1, Column.DEPENDENCY: 0,
    }.items():  # fmt: skip
        episodes.statistics[0, column] = value
    for control, asked in {
        Control.WALLS_LOW: 10, Control.WALLS_HIGH: 20, Control.PUSHES_LOW: 8, Control.PUSHES_HIGH: 1e4,
        Control.OCCLUDED: -1, Control.DEPENDENCY: 1,
    }.items():  # fmt: skip
        episodes.controls[0, control] = asked
    episodes.distance[:], episodes.changes[:], episodes.steps[:] = 4.0, 15, 75
    found = observation_parts(episodes)["scalars"][0]
    expected = [0, 0.5, 0, 0.5, 1.25, 0, 0.5, 1, 0.5, 0.3, 0, 1, 0, 0.5, 1, 0.8, 4, -1, 1, -1, -1, 0.4, 0.5, 0.75]
    assert found == pytest.approx(expected, abs=1e-6)


def test_scalars_are_bounded():
    """Absurd requests and maps stay within the limits of the observation space."""
    episodes = played("narrow", (4, 4), n=1, steps=0)
    episodes.statistics[:], episodes.controls[:], episodes.distance[:] = 10_000, 10_000, 1e9
    episodes.statistics[:, Column.GOAL] = 0
    episodes.statistics[:, [Column.WALLS, Column.SOLVABLE, Column.OCCLUDED, Column.DEPENDENCY]] = [16, 1, 1, 1]
    episodes.controls[:, Control.WALLS_LOW : Control.WALLS_HIGH + 1] = 16
    episodes.controls[:, Control.OCCLUDED :] = 1
    assert np.abs(observation_parts(episodes)["scalars"]).max() <= SCALAR_LIMIT
