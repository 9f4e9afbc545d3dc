"""Jumps: configurations that a route need not pass through are left out, and what is left is a plan."""

from pathlib import Path

import numpy as np
import pytest

import planner
from converter.formats import read_scene
from converter.scene import Scene
from converter.shape import FloatArray
from planner.carries import Carry, Route, RoutePlanner, route_of
from planner.improve_jumps import Jumps
from planner.problem import Problem
from planner.settings import Settings
from tests.planner.scenes import RADIUS, body, room, wall

PUZZLES = Path(__file__).parents[2] / "data" / "puzzles"
OPEN = room(objects=(body("obj", 0.6, 0.0), body("other", -1.0, 1.0)), goal=(1.5, 0.0), agent=(-1.0, 0.0))
BEHIND = np.array([-0.1 - RADIUS, 0.0])
BELOW = np.array([0.0, -0.1 - RADIUS])
OBJ, OTHER = 0, 1


def route_by(scene: Scene, *carries: tuple[int, FloatArray, tuple[float, float]]) -> Route:
    """The route of some carries: object, grasp, placement."""
    route = RoutePlanner(Problem(scene)).route([Carry(index, grasp, np.array(at)) for index, grasp, at in carries])
    assert route is not None
    return route


def jumped(scene: Scene, route: Route, seed: int = 0) -> Route:
    """The route after its configurations have been skipped; it has to be a plan."""
    problem = Problem(scene)
    motions = RoutePlanner(problem)
    found = motions.route(Jumps(problem, motions, np.random.default_rng(seed)).fewest(route))
    assert found is not None
    return found


def test_a_way_in_small_steps_becomes_one_carry():
    """In the open four carries of the goal-object are as good as one."""
    stops = [(0.8, 0.0), (1.0, 0.0), (1.2, 0.0), (1.5, 0.0)]
    route = route_by(OPEN, *((OBJ, BEHIND, stop) for stop in stops))
    assert len(jumped(OPEN, route).carries) == 1


def test_an_object_moved_for_nothing_stays():
    """One carry is left, that of the goal-object, wherever the needless one stands in the order."""
    needless, needed = (OTHER, BELOW, (-1.0, 1.3)), (OBJ, BEHIND, (1.5, 0.0))
    for carries in [(needless, needed), (needed, needless)]:
        (carry,) = jumped(OPEN, route_by(OPEN, *carries)).carries
        assert carry.index == OBJ


def test_what_has_to_be_moved_is_moved():
    """In a corridor that the other object shuts both carries are needed."""
    walls = (wall(1.0, 0.45, 0.9, 0.1), wall(1.0, -0.45, 0.9, 0.1), wall(1.5, 0.0, 0.1, 0.7))
    shut = room(*walls, objects=(body("obj", -0.5, -1.0), body("other", 0.7, 0.0)), goal=(1.1, 0.0))
    route = route_by(shut, (OTHER, BEHIND, (-1.0, 1.0)), (OBJ, BEHIND, (1.1, 0.0)))
    assert [carry.index for carry in jumped(shut, route).carries] == [OTHER, OBJ]


@pytest.mark.parametrize("name", ["maze", "o-room", "four-blocks", "wall"])
def test_puzzles_need_no_more_carries_than_before(name: str):
    """What comes out is a plan without more carries, and the same for the same seed."""
    scene = read_scene(PUZZLES / f"{name}.yaml")
    result = planner.solve(scene, Settings(), np.random.default_rng(4))
    problem = Problem(scene)
    route = RoutePlanner(problem).route(route_of(problem, result.segments).carries)
    assert route is not None
    first, second = (jumped(scene, route, seed=1) for _ in range(2))
    assert len(first.carries) <= len(route.carries)
    assert first.cost == second.cost


def test_maze_needs_few_of_the_carries_of_a_search():
    """Of the many short carries that found the way at most two thirds are left."""
    scene = read_scene(PUZZLES / "maze.yaml")
    result = planner.solve(scene, Settings(), np.random.default_rng(0))
    problem = Problem(scene)
    route = RoutePlanner(problem).route(route_of(problem, result.segments).carries)
    assert route is not None
    assert len(jumped(scene, route).carries) <= len(route.carries) * 2 / 3
