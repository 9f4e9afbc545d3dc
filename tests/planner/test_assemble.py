"""From subproblems to segments: alternating modes, joined approaches, continuous motion."""

from itertools import pairwise

import numpy as np
import pytest

from planner.assemble import segments_of, subgoals_of
from planner.pick_place import PickPlace
from tests.planner.scenes import body, room, vectors

SCENE = room(objects=(body("obj", 1, 0), body("other", -1, 0)))
PICK = PickPlace(0, vectors([0, 0], [0, 1], [0.7, 0]), vectors([0.7, 0], [0.7, 1]), np.array([1.0, 1.0]))
REGRASP = PickPlace(0, vectors([0.7, 1], [1, 1.3]), vectors([1, 1.3]), np.array([1.0, 1.0]))
FROM_THERE = PickPlace(1, vectors([1, 1.3], [-0.7, 0]), vectors([-0.7, 0], [0, 0], [0, 1]), np.array([-0.3, 1.0]))
AT_ONCE = PickPlace(0, vectors([0.7, 1], [0.7, 1]), vectors([0.7, 1], [0.2, 1]), np.array([0.5, 1.0]))


def test_a_pick_place_is_a_move_and_a_carry():
    """The approach becomes a move, the carry names its object."""
    move, carry = segments_of(SCENE, [PICK])
    assert (move.mode, move.object, carry.mode, carry.object) == ("move", None, "carry", "obj")
    np.testing.assert_array_equal(move.path, PICK.approach)
    np.testing.assert_array_equal(carry.path, PICK.carry)
    (subgoal,) = subgoals_of(SCENE, [PICK])
    assert subgoal.object == "obj"
    np.testing.assert_array_equal(subgoal.position, [1, 1])


def test_a_regrasp_joins_the_next_approach():
    """Driving to another grasp and on to another object is one move without repeated points, and no subgoal."""
    segments = segments_of(SCENE, [PICK, REGRASP, FROM_THERE])
    assert [segment.object for segment in segments] == [None, "obj", None, "other"]
    np.testing.assert_array_equal(segments[2].path, vectors([0.7, 1], [1, 1.3], [-0.7, 0]))
    assert [subgoal.object for subgoal in subgoals_of(SCENE, [PICK, REGRASP, FROM_THERE])] == ["obj", "other"]


def test_regrasps_at_the_start_and_in_a_row_are_one_move():
    """Approaches add up until a carry follows."""
    start = PickPlace(0, vectors([0, 0], [0.7, 1]), vectors([0.7, 1]), np.array([1.0, 0.0]))
    segments = segments_of(SCENE, [start, REGRASP, FROM_THERE])
    assert [segment.object for segment in segments] == [None, "other"]
    np.testing.assert_array_equal(segments[0].path, vectors([0, 0], [0.7, 1], [1, 1.3], [-0.7, 0]))


def test_an_approach_without_motion_makes_no_segment():
    """An agent that is already there grasps at once: two carries follow each other."""
    segments = segments_of(SCENE, [PICK, AT_ONCE])
    assert [segment.mode for segment in segments] == ["move", "carry", "carry"]


@pytest.mark.parametrize("steps", [[], [REGRASP]])
def test_without_a_carry_there_is_nothing(steps: list[PickPlace]):
    """No steps, or a regrasp at the end, move nothing."""
    assert segments_of(SCENE, steps) == ()
    assert subgoals_of(SCENE, steps) == ()


def test_segments_share_their_ends():
    """Each segment begins exactly where the one before ended."""
    segments = segments_of(SCENE, [PICK, REGRASP, FROM_THERE])
    for before, after in pairwise(segments):
        np.testing.assert_array_equal(before.path[-1], after.path[0])
