"""Sampled subproblems: budgets, counters, and stopping."""

from collections import Counter
from collections.abc import Callable

import numpy as np

from converter.scene import Scene
from planner.pick_place import Region
from planner.pick_place_sampled import SampledPickPlace
from planner.problem import Problem
from planner.settings import settings_for
from planner.subproblems import subproblem_solvers
from tests.planner.scenes import body, room, vectors, violations, wall

BEHIND_A_WALL = room(wall(0, -0.5, 0.2, 3), objects=(body("obj", -1, -0.5),), agent=(-1.5, -1.5), goal=(1.5, -1.5))
CLOSED = room(wall(0, 0, 0.2, 4), objects=(body("obj", -1, -0.5),), agent=(-1.5, -1.5), goal=(1.5, -1.5))


def never() -> bool:
    """Does not stop."""
    return False


def solver_at_start(
    scene: Scene, should_stop: Callable[[], bool] = never, **changes: int
) -> tuple[SampledPickPlace, Counter[str]]:
    """The sampled solver at the start, and its counters."""
    problem, counters = Problem(scene), Counter[str]()
    settings = settings_for("faithful", **changes)
    solver = subproblem_solvers(problem, settings, np.random.default_rng(0), counters, should_stop)(problem.initial)
    assert isinstance(solver, SampledPickPlace)
    return solver, counters


def test_work_is_counted():
    """One program a grasp until the motions succeed, and the iterations of RRT-Connect add up."""
    solver, counters = solver_at_start(BEHIND_A_WALL)
    step = solver.pick_place(0, Region.of_goal(BEHIND_A_WALL.goal))
    assert step is not None
    assert violations(BEHIND_A_WALL, step) == set()
    assert 1 <= counters["nlp_calls"] <= 12
    assert counters["rrt_calls"] >= 2
    assert counters["rrt_iterations"] >= counters["rrt_calls"]


def test_paths_are_shortened():
    """With shortcuts the carry is no longer than without, from the same motion."""
    lengths = []
    for rounds in (0, 100):
        solver, _ = solver_at_start(BEHIND_A_WALL, shortcut_rounds=rounds)
        step = solver.pick_place(0, Region.of_goal(BEHIND_A_WALL.goal))
        assert step is not None
        lengths.append(float(np.hypot(*np.diff(step.carry, axis=0).T).sum()))
    assert lengths[1] < lengths[0]


def test_motions_are_sought_for_a_few_switch_configurations_only():
    """Where the goal is cut off each attempt spends its iterations, and no more attempts are made than allowed."""
    solver, counters = solver_at_start(CLOSED, motion_attempts=3, motion_iterations=100)
    assert solver.pick_place(0, Region.of_goal(CLOSED.goal)) is None
    assert (counters["rrt_calls"], counters["rrt_iterations"]) == (3, 300)
    assert counters["subproblems_solved"] == 0


def test_reaching_has_its_own_budget():
    """The question whether an object can be reached spends its own number of iterations."""
    pen = [wall(-1, 0.6, 1.8, 0.2), wall(-1, -1.6, 1.8, 0.2), wall(-1.9, -0.5, 0.2, 2.2), wall(-0.1, -0.5, 0.2, 2.2)]
    scene = room(*pen, objects=(body("obj", -1, -0.5),), agent=(1.5, 1.5))
    solver, counters = solver_at_start(scene, reach_iterations=70)
    assert not solver.reachable(0)
    assert counters["rrt_iterations"] == 70


def test_every_position_may_be_placeable():
    """Nothing is known about a carry before it is sought."""
    solver, _ = solver_at_start(CLOSED)
    assert solver.placeable(0, vectors([1, 1], [0, 0])).tolist() == [True, True]


def test_a_stopped_subproblem_has_no_answer():
    """Asked to stop, it begins no further program."""
    solver, counters = solver_at_start(BEHIND_A_WALL, should_stop=lambda: True)
    assert solver.pick_place(0, Region.of_goal(BEHIND_A_WALL.goal)) is None
    assert counters["nlp_calls"] == 0
