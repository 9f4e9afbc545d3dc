import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from pcg.episodes import EpisodeSettings
from pcg.observation import observation_size
from pcg.representation import REPRESENTATIONS
from pcg.wrappers import OUTSIDE, CroppedObservation, FlatObservation, OneHotObservation


@pytest.mark.parametrize("name", ["narrow", "turtle"])
def test_a_cropped_map_is_centred_on_the_position(name: str):
    """The middle is the tile at the position; beyond the edge there is nothing but `OUTSIDE`, and it is frozen."""
    plain = gymnasium.make(f"Sokoban-{name}-v0", rows=4, columns=6)
    cropped = CroppedObservation(gymnasium.make(f"Sokoban-{name}-v0", rows=4, columns=6), 11)
    whole, _ = plain.reset(seed=2)
    part, _ = cropped.reset(seed=2)
    for action in np.random.default_rng(0).integers(plain.action_space.n, size=30):
        assert cropped.observation_space.contains(part)
        row, column = whole["position"]
        assert part["map"][5, 5] == whole["map"][row, column]
        inside = part["map"] != OUTSIDE
        assert (part["map"][inside] == whole["map"].ravel()).all()
        assert (part["frozen"][~inside] == 1).all()
        assert (part["goal"][inside] == whole["goal"].ravel()).all()
        whole, part = plain.step(action)[0], cropped.step(action)[0]


@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_one_hot_maps_say_the_same(name: str):
    """Exactly one flag a cell is set, that of its tile."""
    plain, flags = (gymnasium.make(f"Sokoban-{name}-v0", rows=5, columns=3) for _ in range(2))
    wrapped = OneHotObservation(flags)
    whole, one_hot = plain.reset(seed=1)[0], wrapped.reset(seed=1)[0]
    assert one_hot["map"].shape == (5, 3, 5)
    assert (one_hot["map"].sum(axis=2) == 1).all()
    assert (one_hot["map"].argmax(axis=2) == whole["map"]).all()


@pytest.mark.filterwarnings("ignore:.*is different from the unwrapped version")
def test_wrapped_environments_pass_the_checker():
    """Cropped and one-hot together, and the flat vector, are environments that Gymnasium accepts."""
    env = gymnasium.make("Sokoban-narrow-v0")
    check_env(OneHotObservation(CroppedObservation(env.unwrapped, 5)), skip_render_check=True)
    check_env(FlatObservation(gymnasium.make("Sokoban-wide-v0").unwrapped), skip_render_check=True)


@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_the_flat_vector_has_the_size_that_policies_expect(name: str):
    """It is what `observation_size` says."""
    vector, _ = FlatObservation(gymnasium.make(f"Sokoban-{name}-v0", rows=3, columns=8)).reset(seed=0)
    assert vector.shape == (observation_size(EpisodeSettings(name, 3, 8)),)


@pytest.mark.parametrize(
    ("name", "size", "message"), [("wide", 5, "wide and flip have none"), ("narrow", 4, "odd number")]
)
def test_impossible_crops_are_refused(name: str, size: int, message: str):
    """There is no centre without a position, nor in an even square."""
    with pytest.raises(ValueError, match=message):
        CroppedObservation(gymnasium.make(f"Sokoban-{name}-v0"), size)


def test_wrappers_in_another_order_are_refused():
    """Flags cannot be cropped, and what was cropped or made flags is no vector of a policy."""
    env = gymnasium.make("Sokoban-narrow-v0")
    with pytest.raises(ValueError, match="crop first"):
        CroppedObservation(OneHotObservation(env), 5)
    for wrapped in (CroppedObservation(env, 5), OneHotObservation(env)):
        with pytest.raises(ValueError, match="own observations"):
            FlatObservation(wrapped)
    assert FlatObservation(gymnasium.wrappers.TimeLimit(env, 9)).reset(seed=0)[0].ndim == 1


def test_only_our_environments_can_be_flattened():
    """Another environment has no such settings."""
    with pytest.raises(TypeError, match="no SokobanEnvironment"):
        FlatObservation(gymnasium.Env())
