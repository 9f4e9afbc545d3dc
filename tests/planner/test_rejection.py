"""Rejection of equal configurations."""

from typing import Any

import numpy as np
import pytest

from planner.contact_curve import ContactCurve
from planner.problem import Configuration, Problem
from planner.rejection import GRASPS, Rejection
from planner.settings import Settings
from planner.visibility import ShortestPathTree
from tests.planner.scenes import body, room, vectors, wall


def at(*objects: tuple[float, float]) -> Configuration:
    """Objects at these places, the agent at the origin."""
    return Configuration(np.zeros(2), vectors(*objects))


def rejection(**changes: Any) -> Rejection:
    """Rejection in an empty room by object positions alone, unless changed."""
    objects = body("obj", 1, 1), body("other", -1, -1)
    settings = {"method": "Rnd+R", "rejection_by_access": False, "equal_configurations": 2, **changes}
    return Rejection(Problem(room(objects=objects)), Settings(**settings))


def test_two_equal_configurations_pass():
    """The third configuration with equal object positions is refused, wherever the agent is; others pass."""
    rej = rejection()
    equal = [Configuration(np.array([x, 0.0]), vectors([0.51, 0.12], [1, 1])) for x in (0.0, 1.0, 2.0)]
    assert [rej.accepts(one, 0) for one in equal] == [True, True, False]
    assert rej.accepts(at((0.51, 0.12), (1, 1.2)), 0)


@pytest.mark.parametrize(
    ("other", "equal"),
    [((0.59, 0.11), True), ((0.61, 0.11), False), ((0.51, 0.09), False), ((0.51, -0.11), False)],
)
def test_equal_means_in_the_same_cells(other: tuple[float, float], *, equal: bool):
    """Positions are compared by cells of 0.1 m, on both sides of zero."""
    rej = rejection(equal_configurations=1)
    assert rej.accepts(at((0.51, 0.11), (1, 1)), 0)
    assert rej.accepts(at(other, (1, 1)), 0) == (not equal)


def test_swapped_objects_are_another_configuration():
    """Which object stands where counts."""
    rej = rejection(equal_configurations=1)
    assert rej.accepts(at((0.5, 0), (1, 0)), 0)
    assert rej.accepts(at((1, 0), (0.5, 0)), 0)


def test_without_the_letter_nothing_is_refused():
    """Rejection is off in methods without R."""
    rej = rejection(method="Rnd+FP")
    assert all(rej.accepts(at((0.5, 0.1), (1, 1)), 0) for _ in range(5))


def test_in_the_open_as_many_pass_as_published():
    """Where the agent can drive to every grasp, the third equal configuration is refused, wherever the agent is."""
    rej = rejection(rejection_by_access=True)
    equal = [Configuration(np.array([x, 0.0]), vectors([0.51, 0.12], [1, 1])) for x in (0.0, 1.0, -1.0)]
    assert [rej.accepts(one, 0) for one in equal] == [True, True, False]


def passing(rej: Rejection, x: float) -> int:
    """How many equal configurations pass with the agent at (x, 0) and the object at the origin."""
    return sum(rej.accepts(Configuration(np.array([x, 0.0]), vectors([0, 0])), 0) for _ in range(3 * GRASPS))


def corridor() -> Problem:
    """The agent left of an object in a corridor in which it cannot pass the object."""
    sides = [wall(x, sign * 1.35, 1, 2) for sign in (1, -1) for x in (-1.5, -0.5, 0.5, 1.5)]
    return Problem(room(*sides, objects=(body("obj", 0, 0),), agent=(-1.5, 0)))


def test_in_a_narrow_place_more_pass():
    """In a corridor the agent can drive to a side of the object only: as many more pass as there are fewer grasps."""
    problem = corridor()
    tree = ShortestPathTree(problem.agent_space(problem.initial), problem.initial.agent)
    curve = ContactCurve(problem.scene.objects[0], problem.scene.agent.radius)
    grasps = curve.at(np.linspace(0.0, curve.length, GRASPS, endpoint=False))
    reached = np.count_nonzero(tree.reaches(grasps))
    assert 0 < reached < GRASPS / 2
    limit = 2 * GRASPS / reached
    assert limit <= passing(Rejection(problem, Settings(equal_configurations=2)), -1.0) < limit + 1


def test_agents_on_either_side_of_an_object_are_told_apart():
    """By access, configurations are equal only if the agent can drive from one to the other."""
    rej = Rejection(corridor(), Settings(method="Rnd+R", equal_configurations=2))
    assert passing(rej, -1.0) == passing(rej, 1.0) > 0
    assert passing(rej, -0.5) == passing(rej, 1.5) == 0
