"""Solving the bounds: feasible ones to the last digit, infeasible ones with the least violation."""

import numpy as np
import pytest

from planner.lgp import moved_before
from planner.lgp_motion import waypoints
from planner.lgp_scene import LgpStructure, pack
from planner.lgp_solver import BoundSolution, path_solver, pose_solver, sequence_solver
from planner.lgp_weights import Weights
from planner.logic import Action, Skeleton, Surface
from planner.problem import Problem
from tests.planner.scenes import body, room, wall

WEIGHTS = Weights()
STEPS = 5
ITERATIONS = 100
DIRECT = (Action(0), Action(0, Surface.GOAL))
SKELETONS = [DIRECT, (Action(1), Action(1, Surface.FLOOR), *DIRECT)]


def solved_sequence(problem: Problem, skeleton: Skeleton, seed: int) -> BoundSolution:
    """The sequence bound from the start that MBTS takes."""
    start = np.tile(problem.initial.agent, len(skeleton))
    start += np.random.default_rng(seed).normal(0, 0.01, len(start))
    return sequence_solver(LgpStructure.of(problem), skeleton, WEIGHTS, ITERATIONS).solve(start, pack(problem))


@pytest.mark.parametrize("skeleton", SKELETONS, ids=["direct", "obstacle first"])
@pytest.mark.parametrize("seed", range(3))
def test_a_solution_of_each_bound_satisfies_the_cheaper_ones(skeleton: Skeleton, seed: int):
    """In small random scenes: the switches of a feasible path are a feasible sequence, the last one a free pose."""
    rng = np.random.default_rng(seed)
    others = (body("obj", *rng.uniform(0.6, 1.2, 2)), body("other", *rng.uniform(-1.2, -0.6, 2)))
    problem = Problem(room(wall(*rng.uniform([-0.2, 0.8], [0.2, 1.2]), 0.3, 0.2), objects=others, agent=(0, -0.5)))
    structure, p = LgpStructure.of(problem), pack(problem)
    of_sequence = solved_sequence(problem, skeleton, seed)
    start = waypoints(problem.initial.agent, of_sequence.x.reshape(-1, 2), STEPS)
    of_path = path_solver(structure, skeleton, WEIGHTS, STEPS, ITERATIONS).solve(start.ravel(), p)
    assert max(of_sequence.violation, of_path.violation) < 1e-6

    switches = of_path.x.reshape(-1, 2)[STEPS - 1 :: STEPS]
    cost, equalities, inequalities = sequence_solver(structure, skeleton, WEIGHTS, ITERATIONS).evaluate(
        switches.ravel(), p
    )
    assert np.abs(equalities).max() < 1e-6
    assert inequalities.min() > -1e-6
    assert cost >= of_sequence.cost - 1e-6

    objects = problem.initial.objects.copy()
    for k in range(1, len(skeleton), 2):
        objects[skeleton[k].index] += switches[k] - switches[k - 1]
    moved = moved_before(skeleton)
    pose = pose_solver(structure, moved, skeleton[-1], WEIGHTS, ITERATIONS)
    cost, equalities, inequalities = pose.evaluate(np.concatenate([switches[-1], *objects[list(moved)]]), p)
    assert inequalities.min() > -1e-6
    moves = np.concatenate([switches[-1:] - problem.initial.agent, (objects - problem.initial.objects)[list(moved)]])
    assert cost == pytest.approx(2 * 0.01**2 * (moves**2).sum(), abs=1e-6), "free of collisions"


def test_infeasible_bounds_have_the_least_violation():
    """The goal begins 10 cm further out than the agent, inside the room, can hold the object: 10 * 0.1."""
    scene = room(objects=(body("obj", 1.0, 0.0),), goal=(2.5, 0.0), goal_size=(0.2, 2.0))
    solution = solved_sequence(Problem(scene), DIRECT, 0)
    assert solution.violation == pytest.approx(10 * (2.4 - 0.3 - 2.0), abs=1e-3)


def test_solutions_do_not_depend_on_what_was_solved_before():
    """A cached solver gives the same answer again, to the last bit, with another scene in between."""
    problem = Problem(room(wall(0, 1, 0.3, 0.2)))
    other = Problem(room(wall(0.5, 0.8, 0.3, 0.4), agent=(0.3, 0.1)))
    first = solved_sequence(problem, DIRECT, 1)
    assert not np.array_equal(solved_sequence(other, DIRECT, 1).x, first.x)
    np.testing.assert_array_equal(solved_sequence(problem, DIRECT, 1).x, first.x)


def test_solvers_are_built_once_for_each_structure():
    """Scenes of one structure share a solver; another skeleton has its own."""
    structure = LgpStructure.of(Problem(room(wall(0, 1, 0.3, 0.2))))
    same = LgpStructure.of(Problem(room(wall(1, 0, 0.5, 0.4))))
    solver = sequence_solver(structure, DIRECT, WEIGHTS, ITERATIONS)
    assert sequence_solver(same, DIRECT, WEIGHTS, ITERATIONS) is solver
    assert sequence_solver(structure, DIRECT[:1], WEIGHTS, ITERATIONS) is not solver
