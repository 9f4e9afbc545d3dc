"""The programs of a skeleton: sizes and violations by hand, derivatives, and that each bound relaxes the next one."""

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from converter.shape import FloatArray, Part
from planner.lgp import Program, moved_before, path_program, pose_program, sequence_program
from planner.lgp_scene import LgpStructure, pack
from planner.lgp_weights import Weights
from planner.logic import Action, Domain, Skeleton, Surface
from planner.problem import Problem
from tests.planner.scenes import body, room, vectors, wall
from tests.planner.skeletons import skeletons

WEIGHTS = Weights()
STEPS = 3
PUT_AWAY = (Action(1), Action(1, Surface.FLOOR))
DIRECT = (Action(0), Action(0, Surface.GOAL))
SKELETONS = list(skeletons(Domain(2, 0), 4))


def problem_with(wall_at: tuple[float, float] = (0.0, 1.0)) -> Problem:
    """A goal-object at (1, 0), another at (-1, 0), one wall; the agent starts at the origin."""
    l_shape = (Part.box((0.3, 0.1)), Part(vectors([-0.15, 0], [-0.05, 0], [-0.15, 0.3]), 0.02))
    objects = (body("obj", 1.0, 0.0), body("other", -1.0, 0.0, *l_shape))
    return Problem(room(wall(*wall_at, 0.4, 0.2, 0.03), objects=objects, tolerance=1e-3))


def pose_of(problem: Problem, skeleton: Skeleton) -> Program:
    """The pose program of a skeleton."""
    return pose_program(LgpStructure.of(problem), moved_before(skeleton), skeleton[-1], WEIGHTS)


def programs_of(problem: Problem, skeleton: Skeleton) -> dict[str, Program]:
    """All three bounds."""
    structure = LgpStructure.of(problem)
    return {
        "pose": pose_of(problem, skeleton),
        "sequence": sequence_program(structure, skeleton, WEIGHTS),
        "path": path_program(structure, skeleton, WEIGHTS, STEPS),
    }


def values(program: Program, problem: Problem, x: FloatArray) -> list[FloatArray]:
    """Residuals, equalities and inequalities at `x`."""
    parts = [program.residuals, program.equalities, program.inequalities]
    return [np.array(v).ravel() for v in ca.Function("f", [program.x, program.p], parts)(x, pack(problem))]


def violation(program: Program, problem: Problem, x: FloatArray) -> float:
    """Sum of scaled violations."""
    _, equalities, inequalities = values(program, problem, x)
    return float(np.abs(equalities).sum() + np.maximum(-inequalities, 0).sum())


def positions_at_end(problem: Problem, skeleton: Skeleton, switches: FloatArray) -> FloatArray:
    """Object positions after the last action, followed step by step."""
    objects, grasp = problem.initial.objects.copy(), np.zeros(2)
    for action, agent in zip(skeleton, switches, strict=True):
        if action.is_pick:
            grasp = objects[action.index] - agent
        objects[action.index] = agent + grasp
    return objects


@pytest.mark.parametrize("skeleton", SKELETONS, ids=str)
@pytest.mark.parametrize("bound", ["pose", "sequence", "path"])
def test_derivatives_agree_with_finite_differences(skeleton: Skeleton, bound: str):
    """The Jacobians of costs and constraints are those of central differences."""
    problem = problem_with()
    program = programs_of(problem, skeleton)[bound]
    value = ca.vertcat(program.residuals, program.equalities, program.inequalities)
    f = ca.Function("f", [program.x, program.p], [value])
    jacobian = ca.Function("j", [program.x, program.p], [ca.jacobian(value, program.x)])
    n, p, h = program.x.numel(), pack(problem), 1e-6
    x = np.random.default_rng(len(skeleton)).uniform(-1.5, 1.5, n)
    differences = [np.array(f(x + h * e, p) - f(x - h * e, p)).ravel() / (2 * h) for e in np.eye(n)]
    np.testing.assert_allclose(np.array(jacobian(x, p)), np.column_stack(differences), atol=1e-5)


@pytest.mark.parametrize(
    ("skeleton", "pose", "sequence"),
    [(DIRECT[:1], 2, 2), (DIRECT, 4, 4), (PUT_AWAY + DIRECT[:1], 4, 6), (PUT_AWAY + DIRECT, 6, 8)],
    ids=str,
)
def test_variables_are_agent_positions_and_in_the_pose_what_was_moved(skeleton: Skeleton, pose: int, sequence: int):
    """Two numbers for each configuration; the pose has one, and the objects that were grasped before are free."""
    programs = programs_of(problem_with(), skeleton)
    assert programs["pose"].x.shape == (pose, 1)
    assert programs["sequence"].x.shape == (sequence, 1)
    assert programs["path"].x.shape == (STEPS * sequence, 1)


def test_a_touching_grasp_and_a_carry_into_the_goal_violate_nothing():
    """The agent touches the sharp box of side 0.2 at 0.3 m from its centre and carries it by (0.5, 1.5)."""
    problem = problem_with((0.0, -1.0))
    program = sequence_program(LgpStructure.of(problem), DIRECT, WEIGHTS)
    assert violation(program, problem, np.array([0.7, 0, 1.2, 1.5])) == pytest.approx(0, abs=1e-3)


@pytest.mark.parametrize(
    ("x", "expected"),
    [
        ([0.6, 0.0, 1.1, 1.5], WEIGHTS.touch * 0.1),
        ([0.7, 0.0, 1.0, 1.5], WEIGHTS.placement * 0.025),
        ([0.7, 0.0, 1.2, 1.7], WEIGHTS.placement * 0.025),
    ],
    ids=["a gap of 10 cm", "2.5 cm short of the goal", "2.5 cm beyond the goal"],
)
def test_violations_by_hand(x: list[float], expected: float):
    """What a grasp or a placement is off by counts times its scale."""
    problem = problem_with((0.0, -1.0))
    program = sequence_program(LgpStructure.of(problem), DIRECT, WEIGHTS)
    assert violation(program, problem, np.array(x)) == pytest.approx(expected, abs=1e-3)


def test_penetrations_count_for_the_agent_and_for_what_it_holds():
    """A wall of height 0.2 at (1.2, 0.75): first the agent is in it by 5 cm at the placement, then the object."""
    problem = Problem(room(wall(1.2, 0.75, 0.4, 0.2), objects=(body("obj", 1.0, 0.0),), goal=(1.5, 1.0)))
    program = sequence_program(LgpStructure.of(problem), DIRECT, WEIGHTS)
    assert violation(program, problem, np.array([0.7, 0, 1.2, 1.0])) == pytest.approx(10 * 0.05, abs=1e-3)
    problem = Problem(room(wall(1.5, 0.75, 0.4, 0.2), objects=(body("obj", 1.0, 0.0),), goal=(1.5, 0.9)))
    program = sequence_program(LgpStructure.of(problem), DIRECT, WEIGHTS)
    assert violation(program, problem, np.array([1.0, 0.3, 1.5, 1.2])) == pytest.approx(10 * 0.05, abs=1e-3)


def test_collisions_are_costs_in_the_pose():
    """A placement inside of another object violates nothing there, but costs its squared scaled depths."""
    problem = Problem(room(objects=(body("obj", 1.0, 0.0), body("other", 1.5, 1.5))))
    program = pose_of(problem, DIRECT)
    x = np.array([1.5, 1.0, 1.5, 1.35])
    assert violation(program, problem, x) == 0
    residuals, _, _ = values(program, problem, x)
    from_start = np.array([1.5, 1.0, 0.5, 1.35])
    expected = (2 * 0.01**2 * from_start**2).sum() + (10 * 0.05) ** 2
    assert (residuals**2).sum() == pytest.approx(expected, rel=1e-3)


@settings(max_examples=30, deadline=None)
@given(st.sampled_from(SKELETONS), st.integers(0, 2**32 - 1))
def test_each_bound_relaxes_the_next(skeleton: Skeleton, seed: int):
    """At no path is the violation of its switches larger than its own, nor that of its last switch."""
    rng = np.random.default_rng(seed)
    problem = problem_with(tuple(rng.uniform([-0.5, 0.6], [0.5, 1.5])))
    programs = programs_of(problem, skeleton)
    path = rng.uniform(-2.2, 2.2, (len(skeleton) * STEPS, 2))
    switches = path[STEPS - 1 :: STEPS]
    ends = positions_at_end(problem, skeleton, switches)[list(moved_before(skeleton))]
    of_path = violation(programs["path"], problem, path.ravel())
    of_sequence = violation(programs["sequence"], problem, switches.ravel())
    of_pose = violation(programs["pose"], problem, np.concatenate([switches[-1], ends.ravel()]))
    assert of_pose <= of_sequence + 1e-9
    assert of_sequence <= of_path + 1e-9


def test_structure_is_shared_by_scenes_that_differ_in_numbers_only():
    """One program serves both; with another wall the structure is another one."""
    one, moved = problem_with((0.0, 1.0)), problem_with((0.3, -1.0))
    assert LgpStructure.of(one) == LgpStructure.of(moved)
    assert LgpStructure.of(Problem(room(wall(0, 1, 0.4, 0.2), wall(0, -1, 0.4, 0.2)))) != LgpStructure.of(one)
    assert len(pack(one)) == len(pack(moved)) == programs_of(one, DIRECT)["path"].p.numel()
