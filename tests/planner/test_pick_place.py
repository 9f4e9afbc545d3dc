"""Regions, solved subproblems, and what both solvers of subproblems have to keep."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from converter.scene import Scene
from converter.shape import FloatArray, Part
from planner.pick_place import PickPlace, PickPlaceSolver, Region
from planner.problem import Problem
from planner.settings import settings_for
from planner.subproblems import subproblem_solvers
from planner.verify import ViolationKind
from tests.planner.plain_geometry import disc_penetration, points
from tests.planner.scenes import RADIUS, body, room, vectors, violations, wall

both_solvers = pytest.mark.parametrize("preset", ["fast", "faithful"])
L_SHAPE = (Part.box((0.5, 0.2)), Part(Part.box((0.2, 0.4)).core + np.array([0.15, 0.3]), 0.0))


@given(points, st.floats(0, 1), hnp.arrays(float, (5, 2), elements=st.floats(-2, 2)), st.integers(1, 9))
def test_samples_lie_in_the_region(centre: FloatArray, size: float, others: FloatArray, n: int):
    """The centre first, then uniform positions; `contains` knows them, and others by their coordinates."""
    region = Region.around(centre, size)
    samples = region.sample(n, np.random.default_rng(0))
    assert samples.shape == (n, 2)
    np.testing.assert_allclose(samples[0], centre, atol=1e-12)
    assert region.contains(samples).all()
    inside = (np.abs(others - region.centre) <= size / 2 - 1e-9).all(axis=1)
    outside = (np.abs(others - region.centre) > size / 2 + 1e-9).any(axis=1)
    assert region.contains(others)[inside].all()
    assert not region.contains(others)[outside].any()


def test_the_region_of_a_goal_is_its_rectangle():
    """Every sample satisfies the goal, and the corners are samples' limits."""
    goal = room(goal=(1.0, 0.5), goal_size=(0.4, 0.2)).goal
    region = Region.of_goal(goal)
    np.testing.assert_allclose([region.lower, region.upper], [[0.8, 0.4], [1.2, 0.6]])
    samples = region.sample(200, np.random.default_rng(0))
    assert all(goal.contains(one) for one in samples)
    assert (np.ptp(samples, axis=0) > [0.35, 0.17]).all()


def test_a_step_moves_agent_and_object():
    """Afterwards the object is at the placement and the agent where it released it; a regrasp moves the agent only."""
    problem = Problem(room(objects=(body("obj", 1, 0), body("other", -1, 0))))
    carry = PickPlace(0, vectors([0, 0], [0.7, 0]), vectors([0.7, 0], [0.7, 1]), np.array([1.0, 1.0]))
    after = carry.applied_to(problem.initial)
    np.testing.assert_array_equal(after.agent, [0.7, 1])
    np.testing.assert_array_equal(after.objects, [[1, 1], [-1, 0]])
    regrasp = PickPlace(1, vectors([0.7, 1], [-0.7, 0]), vectors([-0.7, 0]), np.array([-1.0, 0.0]))
    assert (carry.is_regrasp, regrasp.is_regrasp) == (False, True)
    np.testing.assert_array_equal(regrasp.applied_to(after).agent, [-0.7, 0])
    np.testing.assert_array_equal(regrasp.applied_to(after).objects, after.objects)


def solver_at_start(scene: Scene, preset: str, seed: int = 0) -> tuple[PickPlaceSolver, Counter[str]]:
    """A solver of subproblems at the start, and its counters."""
    problem, counters = Problem(scene), Counter[str]()
    rng = np.random.default_rng(seed)
    make = subproblem_solvers(problem, settings_for(preset), rng, counters, lambda: False)
    return make(problem.initial), counters


CLUTTERED = room(
    wall(0.4, 0.8, 0.2, 1.2, 0.02),
    wall(-0.6, -0.6, 1.2, 0.2),
    objects=(body("obj", -0.5, 0.3), body("other", 0.4, -0.6, *L_SHAPE, yaw=0.4)),
    agent=(-1.5, -1.5),
    goal=(1.4, 1.2),
    tolerance=1e-4,
)


@both_solvers
@pytest.mark.parametrize("seed", range(4))
def test_carries_into_the_goal_are_valid_plans(preset: str, seed: int):
    """Among walls and objects the step brings the goal-object into the goal, by the independent verifier's measure."""
    solver, counters = solver_at_start(CLUTTERED, preset, seed)
    step = solver.pick_place(0, Region.of_goal(CLUTTERED.goal))
    assert step is not None
    assert violations(CLUTTERED, step) == set()
    assert (counters["subproblems_tried"], counters["subproblems_solved"]) == (1, 1)


@both_solvers
@pytest.mark.parametrize("seed", range(4))
def test_compound_objects_are_carried_into_small_regions(preset: str, seed: int):
    """An L-shape is put where asked; the plan misses nothing but the goal, which is another object's."""
    solver, _ = solver_at_start(CLUTTERED, preset, seed)
    region = Region.around(np.array([-1.4, 1.4]), 0.1)
    step = solver.pick_place(1, region)
    assert step is not None
    assert region.contains(step.placement[np.newaxis])[0]
    assert violations(CLUTTERED, step) == {ViolationKind.GOAL_MISSED}


@both_solvers
@pytest.mark.parametrize("index", [0, 1])
def test_regrasps_leave_the_object(preset: str, index: int):
    """The agent drives to a place where it touches the object, and nothing else happens."""
    solver, _ = solver_at_start(CLUTTERED, preset)
    step = solver.regrasp(index)
    assert step is not None
    assert step.is_regrasp
    np.testing.assert_array_equal(step.placement, CLUTTERED.objects[index].position[:2])
    np.testing.assert_array_equal(step.approach[0], CLUTTERED.agent.position)
    np.testing.assert_array_equal(step.carry[-1], step.approach[-1])
    depth = disc_penetration(step.approach, RADIUS, [*CLUTTERED.walls, *CLUTTERED.objects])
    assert depth <= CLUTTERED.tolerance + 1e-9
    assert abs(disc_penetration(step.carry, RADIUS, [CLUTTERED.objects[index]])) < 1e-9


PEN = (wall(-1, 0.5, 1.2, 0.2), wall(-1, -0.5, 1.2, 0.2), wall(-1.5, 0, 0.2, 1.2), wall(-0.5, 0, 0.2, 1.2))


@both_solvers
def test_enclosed_objects_cannot_be_reached(preset: str):
    """In a closed pen there is neither a grasp nor a regrasp nor a carry; the other object is not affected."""
    scene = room(*PEN, objects=(body("obj", -1, 0), body("other", 1, 0)))
    problem, counters = Problem(scene), Counter[str]()
    settings = settings_for(preset, reach_iterations=200, motion_iterations=200)
    make = subproblem_solvers(problem, settings, np.random.default_rng(0), counters, lambda: False)
    solver = make(problem.initial)
    assert not solver.reachable(0)
    assert solver.regrasp(0) is None
    assert solver.pick_place(0, Region.of_goal(scene.goal)) is None
    assert solver.reachable(1)
    assert (counters["unreachable"], counters["reachable"], counters["subproblems_solved"]) == (1, 1, 0)


@both_solvers
def test_regions_that_are_full_are_not_served(preset: str):
    """Into a wall nothing can be placed."""
    scene = room(wall(0, 1, 1, 0.6), objects=(body("obj", 1, 0),), goal=(0.0, 1.0), goal_size=(0.3, 0.3))
    solver, _ = solver_at_start(scene, preset)
    assert solver.reachable(0)
    assert solver.pick_place(0, Region.of_goal(scene.goal)) is None


@both_solvers
def test_same_seed_gives_the_same_step(preset: str):
    """All randomness comes from the generator."""
    first, again = (
        solver_at_start(CLUTTERED, preset, 5)[0].pick_place(0, Region.of_goal(CLUTTERED.goal)) for _ in "ab"
    )
    assert first is not None
    assert again is not None
    np.testing.assert_array_equal(first.approach, again.approach)
    np.testing.assert_array_equal(first.carry, again.carry)
    np.testing.assert_array_equal(first.placement, again.placement)


@both_solvers
def test_an_object_already_in_the_region_may_be_moved_within(preset: str):
    """Nothing forbids a carry from the region into itself."""
    scene = room(objects=(body("obj", 1.0, 1.0),), goal=(1.0, 1.0))
    solver, _ = solver_at_start(scene, preset)
    step = solver.pick_place(0, Region.of_goal(scene.goal))
    assert step is not None
    assert violations(scene, step) == set()
