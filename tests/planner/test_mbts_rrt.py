"""The path bound by RRT-Connect: exact, and only between valid switches."""

from collections import Counter

import numpy as np
import pytest

from converter.scene import Scene
from converter.shape import FloatArray
from planner.logic import Action, Surface
from planner.mbts_rrt import motions_between
from planner.problem import Problem
from planner.settings import Settings
from tests.planner.scenes import body, room, vectors, wall

DIRECT = (Action(0), Action(0, Surface.GOAL))
OBJECT = body("obj", 1.0, 0.0)
AROUND_A_WALL = room(wall(0.5, 0.0, 0.1, 2.0), objects=(OBJECT,), agent=(0.0, 0.0), tolerance=1e-3)


def motions(scene: Scene, switches: FloatArray, iterations: int = 5000) -> tuple[list[FloatArray] | None, Counter[str]]:
    """What `motions_between` answers, and its counters."""
    counters: Counter[str] = Counter()
    settings = Settings(method="MBTS-rrt", motion_iterations=iterations)
    rng = np.random.default_rng(0)
    return motions_between(Problem(scene), DIRECT, switches, settings, rng, counters, lambda: False), counters


def test_motions_lead_around_walls_from_switch_to_switch():
    """The straight way to the object is blocked; both motions are free in the spaces of their phases."""
    switches = vectors([1.3, 0], [1.8, 1.5])
    found, counters = motions(AROUND_A_WALL, switches)
    assert found is not None
    problem = Problem(AROUND_A_WALL)
    np.testing.assert_array_equal(found[0][0], [0, 0])
    np.testing.assert_array_equal([motion[-1] for motion in found], switches)
    np.testing.assert_array_equal(found[1][0], switches[0])
    assert problem.agent_space(problem.initial).path_free(found[0])
    assert problem.carry_space(problem.initial, 0, np.array([0.3, 0])).path_free(found[1])
    assert counters["rrt_calls"] == 2


@pytest.mark.parametrize(
    "switches",
    [
        vectors([1.31, 0], [1.81, 1.5]),
        vectors([1.29, 0], [1.79, 1.5]),
        vectors([1.3, 0], [1.8, 1.2]),
        vectors([0.7, 0], [1.2, 1.5]),
    ],
    ids=["a grasp 1 cm away", "a grasp 1 cm inside", "a placement outside of the goal", "a grasp in the wall"],
)
def test_invalid_switches_fail(switches: FloatArray):
    """Nothing is searched for where a switch violates touch, goal or collisions by more than the tolerance."""
    found, counters = motions(AROUND_A_WALL, switches, iterations=100)
    assert found is None
    assert counters["rrt_iterations"] < 200


def test_unreachable_switches_fail():
    """A wall across the whole room cannot be passed, so the budget of iterations ends the query."""
    found, counters = motions(room(wall(0.4, 0.0, 0.1, 4.0), objects=(OBJECT,)), vectors([1.3, 0], [1.8, 1.5]), 50)
    assert found is None
    assert counters["rrt_iterations"] >= 50
