"""RRT-Connect: free paths, repeatable whatever ran before, bounded, silent."""

import subprocess
import sys

import numpy as np
import pytest

from converter.shape import FloatArray
from planner.configuration_space import ConfigurationSpace, ObstacleSet
from planner.motion_ompl import MotionResult, rrt_connect
from tests.planner.scenes import vectors

BOUNDS = vectors([-2, -2], [2, 2])
BARRIER = vectors([-0.1, -2], [0.1, -2], [0.1, 1.5], [-0.1, 1.5])
LEFT, RIGHT = vectors([-1, -1], [1, -1])


def space_with(*cores: FloatArray, rho: float = 0.1) -> ConfigurationSpace:
    """A square of 4 m with these obstacles."""
    return ConfigurationSpace(ObstacleSet.of(cores, [rho] * len(cores)), BOUNDS)


def query(space: ConfigurationSpace, *goals: FloatArray, seed: int = 0, iterations: int = 5000) -> MotionResult:
    """A query from the left side."""
    return rrt_connect(space, LEFT, np.array(goals or [RIGHT]), iterations, np.random.default_rng(seed))


@pytest.mark.parametrize("seed", range(5))
def test_paths_are_free_and_join_the_ends(seed: int):
    """The path begins and ends exactly where asked, and the exact test of its pieces confirms it."""
    space = space_with(BARRIER)
    result = query(space, seed=seed)
    assert result.path is not None
    np.testing.assert_array_equal(result.path[[0, -1]], [LEFT, RIGHT])
    assert space.path_free(result.path)
    assert 0 < result.iterations <= 5000


def test_same_seed_gives_the_same_path_whatever_ran_before():
    """Other queries in between, found or not, change nothing; another seed gives another path."""
    space = space_with(BARRIER)
    first = query(space, seed=7)
    query(space_with(), seed=1)
    query(space_with(vectors([-0.1, -2], [0.1, -2], [0.1, 2], [-0.1, 2])), seed=2, iterations=50)
    again, other = query(space, seed=7), query(space, seed=8)
    assert first.path is not None
    assert again.path is not None
    assert other.path is not None
    np.testing.assert_array_equal(first.path, again.path)
    assert first.iterations == again.iterations
    assert first.path.shape != other.path.shape or (first.path != other.path).any()


def test_a_fresh_process_gives_the_same_path():
    """The first query of a process is no different from later ones, and nothing is printed beside the answer."""
    program = (
        "import tests.planner.test_motion_ompl as t; print(t.query(t.space_with(t.BARRIER), seed=7).path.tolist())"
    )
    fresh = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)  # noqa: S603  # our own program
    here = query(space_with(BARRIER), seed=7).path
    assert here is not None
    assert fresh.stdout == f"{here.tolist()}\n"
    assert fresh.stderr == ""


def test_one_of_several_goals():
    """The path ends at one of the goals; those that are not free are left out."""
    space = space_with(BARRIER)
    goals = vectors([0, 0], [3, 0], [1, 1], [1.5, -1.5])
    for seed in range(5):
        path = query(space, *goals, seed=seed).path
        assert path is not None
        assert (path[-1] == goals[2:]).all(axis=1).any()


@pytest.mark.parametrize("goals", [[[0, 0]], [[0, 0], [2.1, 0]], np.empty((0, 2))])
def test_without_a_free_goal_there_is_no_search(goals: list[list[float]]):
    """Goals in collision or out of bounds give no path and take no iterations."""
    result = rrt_connect(space_with(BARRIER), LEFT, np.array(goals, dtype=float), 100, np.random.default_rng(0))
    assert (result.path, result.iterations) == (None, 0)


@pytest.mark.parametrize("start", [[0.0, 0.0], [-2.1, 0.0]])
def test_a_start_that_is_not_free_has_no_path(start: list[float]):
    """The same for the start."""
    result = rrt_connect(space_with(BARRIER), np.array(start), RIGHT[None], 100, np.random.default_rng(0))
    assert (result.path, result.iterations) == (None, 0)


def test_start_and_goal_on_the_bounds_are_allowed():
    """The border belongs to the space."""
    ends = vectors([-2, -2], [2, 2])
    path = rrt_connect(space_with(), ends[0], ends[1:], 100, np.random.default_rng(0)).path
    assert path is not None
    np.testing.assert_array_equal(path[[0, -1]], ends)


@pytest.mark.parametrize("iterations", [0, 1, 50])
def test_iterations_are_bounded(iterations: int):
    """Where there is no way, the query ends after exactly as many iterations as allowed."""
    closed = space_with(vectors([-0.1, -2], [0.1, -2], [0.1, 2], [-0.1, 2]))
    result = query(closed, iterations=iterations)
    assert (result.path, result.iterations) == (None, iterations)


def test_the_query_can_be_stopped():
    """It is asked in every iteration whether to stop."""
    closed = space_with(vectors([-0.1, -2], [0.1, -2], [0.1, 2], [-0.1, 2]))
    asked = iter(range(1000))
    result = rrt_connect(
        closed, LEFT, RIGHT[None], 1000, np.random.default_rng(0), should_stop=lambda: next(asked) == 10
    )
    assert (result.path, result.iterations) == (None, 10)


def test_a_query_from_the_goal_to_itself():
    """Start and goal may agree, though the path between them need not stay there."""
    path = rrt_connect(space_with(), LEFT, LEFT[None], 100, np.random.default_rng(0)).path
    assert path is not None
    np.testing.assert_array_equal(path[[0, -1]], [LEFT, LEFT])


def test_nothing_is_printed(capfd: pytest.CaptureFixture[str]):
    """OMPL's messages stay off both streams, also when a query is refused or fails."""
    query(space_with(BARRIER))
    query(space_with(BARRIER), np.zeros(2))
    query(space_with(vectors([-0.1, -2], [0.1, -2], [0.1, 2], [-0.1, 2])), iterations=20)
    assert capfd.readouterr() == ("", "")
