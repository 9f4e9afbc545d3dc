"""Plans from the agent positions of a skeleton, by hand."""

import numpy as np

from planner.lgp_motion import after, phases, segments_of, subgoals_of, waypoints
from planner.logic import Action, Surface
from planner.problem import Problem
from tests.planner.scenes import body, room, vectors

SKELETON = (Action(1), Action(1, Surface.FLOOR), Action(0), Action(0, Surface.GOAL))
SWITCHES = vectors([-0.7, 0], [-0.7, 1], [0.7, 0], [1.2, 1.5])
PROBLEM = Problem(room(objects=(body("obj", 1.0, 0.0), body("other", -1.0, 0.0))))


def test_waypoints_lie_on_straight_lines_and_end_in_the_switches():
    """With two steps a phase every second way-point is a switch, the others lie in the middle."""
    found = waypoints(np.array([1.0, 0.0]), vectors([3, 0], [3, 2]), 2)
    np.testing.assert_array_equal(found, [[2, 0], [3, 0], [3, 1], [3, 2]])


def test_phases_share_their_ends():
    """The first phase begins at the start, each other one at the switch before it."""
    first, second = phases(np.zeros(2), vectors([1, 0], [2, 0], [2, 1], [2, 2]), 2)
    np.testing.assert_array_equal(first, [[0, 0], [1, 0], [2, 0]])
    np.testing.assert_array_equal(second, [[2, 0], [2, 1], [2, 2]])


def test_placements_move_objects_as_the_agent_moved():
    """After two pick-and-places both objects are where the carries brought them, and the agent at the last switch."""
    configuration = PROBLEM.initial
    for k in range(4):
        configuration = after(configuration, SKELETON, SWITCHES, k)
    np.testing.assert_allclose(configuration.objects, [[1.5, 1.5], [-1, 1]])
    np.testing.assert_allclose(configuration.agent, [1.2, 1.5])


def test_segments_alternate_and_subgoals_are_the_placements():
    """Before a pick the agent moves, before a placement it carries; subgoals come in the order of the carries."""
    motions = phases(PROBLEM.initial.agent, SWITCHES, 4)
    segments = segments_of(PROBLEM, SKELETON, motions)
    assert [(s.mode, s.object) for s in segments] == [
        ("move", None),
        ("carry", "other"),
        ("move", None),
        ("carry", "obj"),
    ]
    subgoals = subgoals_of(PROBLEM, SKELETON, SWITCHES)
    assert [s.object for s in subgoals] == ["other", "obj"]
    np.testing.assert_allclose([s.position for s in subgoals], [[-1, 1], [1.5, 1.5]])
