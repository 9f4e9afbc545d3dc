"""Carries and their motions."""

import numpy as np
import pytest

from converter.polyline import path_length
from planner.carries import Carry, RoutePlanner, route_of
from planner.problem import Problem
from planner.search import Search
from planner.settings import Settings
from planner.visibility import ShortestPathTree
from tests.planner.scenes import RADIUS, body, room, vectors, wall

GRASP = np.array([-(0.1 + RADIUS), 0.0])
"""From the left, by an object of side 0.2."""
CARRY = Carry(0, GRASP, np.array([1.5, 0.0]))
PROBLEM = Problem(room(objects=(body("obj", 0.6, 0.0), body("other", -1.0, 1.0)), goal=(1.5, 0.0), agent=(-1.0, 0.0)))


def test_the_way_in_the_open_is_straight():
    """Drive to the grasp, carry to the placement; lengths add up."""
    route = RoutePlanner(PROBLEM).route([CARRY])
    assert route is not None
    np.testing.assert_allclose(route.steps[0].approach, [[-1.0, 0.0], [0.3, 0.0]])
    np.testing.assert_allclose(route.steps[0].carry, [[0.3, 0.0], [1.2, 0.0]])
    assert route.cost == (1, pytest.approx(2.2))
    np.testing.assert_allclose(route.configurations[1].objects, [[1.5, 0.0], [-1.0, 1.0]])
    np.testing.assert_allclose(route.configurations[1].agent, [1.2, 0.0])


def test_bounds_are_strict():
    """A route that is not shorter than what is known is none."""
    motions = RoutePlanner(PROBLEM)
    assert motions.route([CARRY], bound=2.21) is not None
    assert motions.route([CARRY], bound=2.19) is None


def test_carries_that_are_no_plan():
    """The goal-object elsewhere, an object in another or out of reach, nothing done at all."""
    motions = RoutePlanner(PROBLEM)
    assert motions.route([Carry(0, GRASP, np.array([1.0, 0.0]))]) is None
    assert motions.route([Carry(1, GRASP, np.array([0.65, 0.0])), CARRY]) is None
    assert motions.route([Carry(0, GRASP, np.array([2.3, 0.0]))]) is None
    assert motions.route([]) is None


def test_ways_around_a_wall_are_shortest_in_both_directions():
    """Whichever end a tree is rooted at, the path has the length of a fresh tree's, and it is free."""
    scene = room(wall(0.0, 0.0, 0.2, 2.0), objects=(body("obj", 1.5, 0.3),), agent=(-1.5, 0.0), goal=(1.5, -1.5))
    problem, motions = Problem(scene), RoutePlanner(Problem(scene))
    there = Carry(0, np.array([0.1 + RADIUS, 0.0]), np.array([-1.5, 0.4]))
    back = Carry(0, np.array([0.1 + RADIUS, 0.0]), np.array([1.5, -1.5]))
    route = motions.route([there, back])
    assert route is not None
    for carry, step, before in zip(route.carries, route.steps, route.configurations, strict=False):
        for path, space in (
            (step.approach, problem.agent_space(before)),
            (step.carry, problem.carry_space(before, carry.index, carry.grasp)),
        ):
            assert space.path_free(path)
            shortest = ShortestPathTree(space, path[0]).path_to(path[-1])
            assert shortest is not None
            assert path_length(path) == pytest.approx(path_length(shortest), abs=1e-9)


def test_the_carries_of_a_plan_give_it_back():
    """Grasps and placements are read off the motion; the exact ways between them are never longer."""
    problem = Problem(room(wall(0.0, -1.0, 0.2, 1.2), objects=(body("obj", -1.5, -1.5),), goal=(1.5, -1.5)))
    result = Search(problem, Settings(), np.random.default_rng(0)).run()
    route = RoutePlanner(problem).route(route_of(problem, result.segments).carries)
    assert route is not None
    assert route.length <= sum(segment.length for segment in result.segments) + 1e-9
    np.testing.assert_allclose([carry.placement for carry in route.carries], [s.position for s in result.subgoals])


def test_the_length_of_a_path():
    """Of straight lines; a point has none."""
    assert path_length(vectors([0, 0], [3, 4], [3, 5])) == 6
    assert path_length(vectors([1, 1])) == 0
