"""RRT-Connect of OMPL: repeatable in a fresh process, to be stopped, silent. What all back ends promise is in `test_motion`."""

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


def test_the_query_can_be_stopped():
    """It is asked in every iteration whether to stop."""
    closed = space_with(vectors([-0.1, -2], [0.1, -2], [0.1, 2], [-0.1, 2]))
    asked = iter(range(1000))
    result = rrt_connect(
        closed, LEFT, RIGHT[None], 1000, np.random.default_rng(0), should_stop=lambda: next(asked) == 10
    )
    assert (result.path, result.iterations) == (None, 10)


def test_nothing_is_printed(capfd: pytest.CaptureFixture[str]):
    """OMPL's messages stay off both streams, also when a query is refused or fails."""
    query(space_with(BARRIER))
    query(space_with(BARRIER), np.zeros(2))
    query(space_with(vectors([-0.1, -2], [0.1, -2], [0.1, 2], [-0.1, 2])), iterations=20)
    assert capfd.readouterr() == ("", "")
