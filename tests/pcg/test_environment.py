import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from pcg.environment import SokobanEnvironment
from pcg.errors import InputError
from pcg.frozen import OPEN, FrozenTiles
from pcg.level import Tile
from pcg.representation import REPRESENTATIONS
from pcg.request import Request
from pcg.xsb import format_level


def made(name: str, **settings: object) -> SokobanEnvironment:
    """The environment itself, without the wrappers of `make`."""
    env = gymnasium.make(f"Sokoban-{name}-v0", **settings).unwrapped
    assert isinstance(env, SokobanEnvironment)
    return env


@pytest.mark.parametrize("name", REPRESENTATIONS)
@pytest.mark.parametrize("shape", [(10, 10), (4, 7), (1, 8)])
def test_gymnasium_accepts_the_environments(name: str, shape: tuple[int, int]):
    """Gymnasium's own checker finds nothing to object to, whatever the size."""
    check_env(made(name, rows=shape[0], columns=shape[1], render_mode="ansi"))


@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_a_seed_reaches_every_draw(name: str):
    """With one seed two environments show the same episodes, start maps, orders and requests, also after the first."""
    runs = []
    for _ in range(2):
        env = made(name, step_share=0.2)
        actions = np.random.default_rng(1)
        seen = [env.reset(seed=3)[0]]
        for _ in range(60):
            observation, _, terminated, truncated, _ = env.step(actions.integers(env.action_space.n))
            seen.append(env.reset()[0] if terminated or truncated else observation)
        runs.append(seen)
    for first, second in zip(*runs, strict=True):
        assert all((first[part] == second[part]).all() for part in first)
    assert any((runs[0][0][part] != made(name).reset(seed=4)[0][part]).any() for part in ("map", "scalars"))


def test_budgets_belong_to_the_size_also_behind_wrappers():
    """An episode of a small map ends by its own budget, not by that of another size."""
    env = gymnasium.make("Sokoban-narrow-v0", rows=5, columns=4, step_share=0.5)
    assert (env.unwrapped.max_steps, env.unwrapped.max_changes) == (10, 6)
    env = gymnasium.wrappers.TimeLimit(env, 1000)
    env.reset(seed=0)
    ends = [env.step(0)[2:4] for _ in range(10)]
    assert ends == [(False, False)] * 9 + [(False, True)]


def test_success_terminates_and_the_level_is_what_was_asked_for():
    """From a start that lacks one tile, the right action terminates with a level that names its goal crate."""
    request = Request(rows=1, columns=7, crates=2, targets=1, wall_density=(0, 1), pushes=(1, 9))
    start = np.array([[Tile.CRATE, Tile.FLOOR, Tile.FLOOR, Tile.PLAYER, Tile.CRATE, Tile.FLOOR, Tile.FLOOR]])
    env = made("wide", rows=1, columns=7, request=request, render_mode="ansi")
    env.reset(seed=0, options={"start": start})
    _, reward, terminated, truncated, info = env.step(np.int64(5 * 6 + Tile.TARGET))
    assert (terminated, truncated, info["pushes"], info["changes"]) == (True, False, 2, 1)
    assert reward > 1
    assert env.level().goal_crate == (0, 4)
    assert env.render() == format_level(env.level())


def test_the_request_of_a_reset_holds_for_its_episode():
    """Frozen tiles are on the map and stay; the next episode asks for something else."""
    tiles = np.full((6, 6), OPEN)
    tiles[2, 1:5] = Tile.WALL
    env = made("wide", rows=6, columns=6, change_share=10)
    request = Request(rows=6, columns=6, frozen=FrozenTiles(tiles))
    observation, _ = env.reset(seed=0, options={"request": request})
    assert (observation["map"][2, 1:5] == Tile.WALL).all()
    assert observation["frozen"].sum() == 4
    for action in range(0, 180, 5):
        observation, *_ = env.step(np.int64(action))
    assert (observation["map"] == Tile.WALL).sum() == 4
    assert env.reset()[0]["frozen"].sum() != 4


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        (Request(rows=5, columns=6), "asked for 5 x 6 cells"),
        (Request(crates=3), "3 crates and 1 targets; it makes 10 x 10 cells, 2 crates and 1 targets"),
        (Request(frozen=FrozenTiles(np.full((10, 10), Tile.CRATE_ON_TARGET))), "stands on a target cannot be kept"),
    ],
)
def test_requests_that_do_not_fit_are_refused(request_: Request, message: str):
    """Another size, other numbers, and tiles that no action can write."""
    with pytest.raises(InputError, match=message):
        made("narrow").reset(seed=0, options={"request": request_})


@pytest.mark.parametrize("start", [np.zeros((2, 2)), np.full((10, 10), Tile.CRATE_ON_TARGET)])
def test_start_maps_that_do_not_fit_are_refused(start: np.ndarray):
    """Another shape, and tiles that are none of the five."""
    with pytest.raises(ValueError, match="start must hold 10 x 10 tiles from 0 to 4"):
        made("narrow").reset(seed=0, options={"start": start})
