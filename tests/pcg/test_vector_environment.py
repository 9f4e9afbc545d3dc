import gymnasium
import numpy as np
import pytest

import pcg.environment  # noqa: F401  # registers the environments
from pcg.representation import REPRESENTATIONS
from pcg.request import Request


@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_a_batch_of_one_is_the_single_environment(name: str):
    """With the same seed and actions both show the same, episode after episode."""
    single = gymnasium.make(f"Sokoban-{name}-v0", step_share=0.3)
    batch = gymnasium.make_vec(f"Sokoban-{name}-v0", num_envs=1, step_share=0.3)
    alone, _ = single.reset(seed=5)
    together, _ = batch.reset(seed=5)
    ended = 0
    for action in np.random.default_rng(0).integers(single.action_space.n, size=100):
        assert all((alone[part] == together[part][0]).all() for part in alone)
        alone, reward, terminated, truncated, said = single.step(action)
        together, rewards, terminations, truncations, information = batch.step(np.array([action]))
        assert (rewards[0], terminations[0], truncations[0]) == (reward, terminated, truncated)
        assert information.get("_final_obs", [False])[0] == (terminated or truncated)
        if terminated or truncated:
            ended += 1
            assert all((alone[part] == information["final_obs"][0][part]).all() for part in alone)
            assert said == {name: numbers[0] for name, numbers in information["final_info"].items()}
            alone, said = single.reset()
        assert said == {name: information[name][0] for name in said}
    assert ended >= 3


def test_only_what_ended_is_final():
    """What is marked has ended, with its last observation; the others go on and have none."""
    envs = gymnasium.make_vec("Sokoban-turtle-v0", num_envs=8, change_share=0.02, step_share=0.3)
    envs.reset(seed=0)
    envs.action_space.seed(0)
    partly = 0
    for _ in range(100):
        _, _, terminated, truncated, information = envs.step(envs.action_space.sample())
        ended = terminated | truncated
        if not ended.any():
            assert "final_obs" not in information
            continue
        partly += not ended.all()
        assert (information["_final_obs"] == ended).all()
        assert (information["_final_info"] == ended).all()
        assert [last is not None for last in information["final_obs"]] == ended.tolist()
        assert all(envs.single_observation_space.contains(last) for last in information["final_obs"][ended])
        assert (information["final_info"]["steps"][ended] > 0).all()
        assert (information["steps"][ended] == 0).all()
    assert partly > 0


@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_a_batch_stays_in_its_spaces(name: str):
    """Observations of 16 environments are in the space, and ended ones begin anew in the same step."""
    envs = gymnasium.make_vec(f"Sokoban-{name}-v0", num_envs=16, rows=5, columns=6, step_share=0.5)
    observations, _ = envs.reset(seed=0)
    envs.action_space.seed(0)
    for step in range(1, 46):
        assert envs.observation_space.contains(observations)
        observations, *_ = envs.step(envs.action_space.sample())
        assert (envs.unwrapped.episodes.steps < 15).all(), step


def test_options_hold_for_all_episodes_until_the_next_reset():
    """A request of a reset is that of every episode that begins before the next one."""
    envs = gymnasium.make_vec("Sokoban-narrow-v0", num_envs=4, step_share=0.02)
    envs.reset(seed=0, options={"request": Request(pushes=(7, 9))})
    for _ in range(5):
        envs.step(np.zeros(4, dtype=np.int64))
        assert (envs.unwrapped.episodes.controls[:, 2:4] == [7, 9]).all()


def test_one_seed_for_the_batch():
    """A list of seeds is refused: there is one generator."""
    envs = gymnasium.make_vec("Sokoban-narrow-v0", num_envs=2)
    with pytest.raises(ValueError, match="takes one seed"):
        envs.reset(seed=[1, 2])
