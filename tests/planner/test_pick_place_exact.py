"""Exact subproblems: no clearance, tolerance 0, and nothing feasible lost."""

from collections import Counter

import numpy as np
import pytest

from converter.scene import Scene
from converter.shape import rotation
from planner.pick_place import Region
from planner.pick_place_exact import ExactPickPlace
from planner.problem import Problem
from planner.settings import Settings
from planner.subproblems import subproblem_solvers
from planner.verify import ViolationKind
from tests.planner.scenes import RADIUS, body, room, turned, vectors, violations, wall

WIDTH = 2 * RADIUS


def solver_at_start(scene: Scene, seed: int = 0, **changes: float) -> ExactPickPlace:
    """The exact solver at the start."""
    problem = Problem(scene)
    rng = np.random.default_rng(seed)
    solver = subproblem_solvers(problem, Settings(**changes), rng, Counter(), lambda: False)(problem.initial)
    assert isinstance(solver, ExactPickPlace)
    return solver


def corridor(yaw: float, obj_y: float = 0.0) -> Scene:
    """The agent and a 0.2 m object between two rows of blocks as far apart as the agent is wide, tolerance 0.

    The corridor runs along x before it is turned by `yaw`.
    """
    sides = [turned(wall(x, sign * (RADIUS + 5), 1, 10), yaw) for sign in (1, -1) for x in range(-4, 5)]
    obj = turned(body("obj", 0, obj_y), yaw)
    agent, goal = vectors([-1, 0], [1, obj_y]) @ rotation(yaw)
    return room(*sides, objects=(obj,), agent=tuple(agent), goal=tuple(goal), goal_size=(0.3, 0.3), half=4)


@pytest.mark.parametrize("yaw", np.deg2rad([0, 90, 30, 45]))
@pytest.mark.parametrize("obj_y", [0.0, 0.1])
@pytest.mark.parametrize("seed", range(3))
def test_pushing_through_a_corridor_without_clearance(yaw: float, obj_y: float, seed: int):
    """The agent grasps the object from behind, also where it touches the corridor's wall, and carries it to the goal."""
    scene = corridor(yaw, obj_y)
    step = solver_at_start(scene, seed).pick_place(0, Region.of_goal(scene.goal))
    assert step is not None
    assert violations(scene, step) == set()


@pytest.mark.parametrize("seed", range(5))
def test_a_corner_grasp_where_no_side_is_free(seed: int):
    """An object that fills a nook can only be grasped at its outer corner, on a quarter of an arc, and out it comes."""
    nook = wall(-1.1, 0, 2, 4), wall(0, 1.1, 4, 2)
    scene = room(*nook, objects=(body("obj", 0, 0),), agent=(1.5, -0.5), goal=(1.0, -1.0))
    step = solver_at_start(scene, seed).pick_place(0, Region.of_goal(scene.goal))
    assert step is not None
    assert violations(scene, step) == set()
    right, up = step.carry[0]
    assert right >= 0.1 - 1e-8
    assert up <= -0.1 + 1e-8


def test_placeable_is_what_a_carry_leads_near():
    """Positions in walls and behind the object's reach are not; positions in the open are."""
    scene = room(wall(0, 0, 0.2, 4), objects=(body("obj", -1, 0),), agent=(-1.5, 0))
    solver = solver_at_start(scene)
    positions = vectors([-1, 1], [0, 0], [1, 0], [-1.9, -1.9], [-1, 0])
    assert solver.placeable(0, positions).tolist() == [True, False, False, True, True]
    assert solver.placeable(0, np.empty((0, 2))).shape == (0,)


@pytest.mark.parametrize("yaw", [0.0, np.pi / 2])
def test_random_subgoals_in_a_corridor_are_served_nearby(yaw: float):
    """No random position in a corridor without clearance is free, yet the object can be placed close to one."""
    subgoals = vectors([0.5, 0.03], [-0.3, -0.04], [0.5, 0.06]) @ rotation(yaw)
    solver = solver_at_start(corridor(yaw))
    assert solver.placeable(0, subgoals).tolist() == [True, True, False]
    for subgoal, expected in zip(subgoals, [True, True, False], strict=True):
        region = Region.around(subgoal, 0.1)
        step = solver.pick_place(0, region)
        assert (step is not None) == expected
        if step is not None:
            assert region.contains(step.placement[np.newaxis])[0]
            assert violations(corridor(yaw), step) <= {ViolationKind.GOAL_MISSED}


def test_unreachable_placements_are_refused():
    """The object fits through the gap, the agent behind it does not."""
    gap = [wall(0, sign * (0.15 + 2), 0.2, 4) for sign in (1, -1)]
    scene = room(*gap, objects=(body("obj", -0.4, 0),), agent=(-1, 0), goal=(1.0, 0.0))
    solver = solver_at_start(scene)
    assert solver.reachable(0)
    # As far as the agent's disc allows the object goes through.
    assert solver.placeable(0, vectors([0.0, 0], [1.5, 0])).tolist() == [True, False]
    assert solver.pick_place(0, Region.of_goal(scene.goal)) is None


def test_what_one_query_computes_later_ones_reuse():
    """The grasps of an object are drawn once, so answers to equal questions are equal."""
    solver = solver_at_start(room(wall(0.4, 0.8, 0.2, 1.2), objects=(body("obj", -0.5, 0.3),)))
    region = Region.around(np.array([1.0, 1.0]), 0.0)
    first, again = solver.pick_place(0, region), solver.pick_place(0, region)
    assert first is not None
    assert again is not None
    np.testing.assert_array_equal(first.carry, again.carry)


def test_contacts_are_where_carries_end():
    """The places where contact stops a carry can be reached, and from each of them some way is barred."""
    scene = room(wall(0, 1.5, 2, 1), objects=(body("obj", 0, 0),), agent=(-1, 0), goal=(1, 1))
    solver = solver_at_start(scene)
    contacts = solver.contacts(0)
    assert len(contacts) > 0
    for place in contacts[:10]:
        step = solver.pick_place(0, Region.around(place, 0.0))
        assert step is not None
        assert violations(scene, step) <= {ViolationKind.GOAL_MISSED}
