from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from converter.plan import Plan, Segment
from converter.replay import points_along, replay, start_positions
from converter.scene import Scene
from converter.shape import FloatArray
from pcg.errors import InputError

COORDINATES = st.floats(-5, 5)
PATHS = st.integers(1, 6).flatmap(lambda n: arrays(np.float64, (n, 2), elements=COORDINATES))


def test_objects_follow_the_agent_only_while_carried(small_room: Scene, small_plan: Plan):
    """Each segment begins with the objects where the one before left them."""
    steps = replay(small_room, small_plan)
    goal_object = [step.positions[0].tolist() for step in steps]
    expected = [[-1.0, 0.0], [-1.0, 0.0], [-1.2, 0.8], [-1.2, 0.8], [-1.0, 1.5]]
    assert np.allclose(goal_object, expected)
    assert all(np.array_equal(step.positions[1], [0.0, 1.0]) for step in steps)


def test_offset_is_from_agent_to_object(small_room: Scene, small_plan: Plan):
    """A carry holds the object where it was relative to the agent at the grasp; a move holds nothing."""
    steps = replay(small_room, small_plan)
    assert [step.carried for step in steps] == [None, 0, None, 0, None]
    assert np.allclose(steps[1].offset, [0.0, 0.4])
    assert np.allclose(steps[3].offset, [-0.2, 0.4])
    assert np.array_equal(steps[0].offset, [0.0, 0.0])


def test_jumps_between_segments_are_believed(small_room: Scene, small_plan: Plan):
    """An agent that appears elsewhere grasps from there: objects do not move by themselves."""
    jumping = replace(small_plan, segments=(Segment("carry", "obstacle", np.array([[2.0, 2.0], [1.0, 2.0]])),))
    (step,) = replay(small_room, jumping)
    assert np.allclose(step.offset, [-2.0, -1.0])
    assert np.allclose(step.end_positions, [[-1.0, 0.0], [-1.0, 1.0]])


def test_no_segments_no_steps(small_room: Scene, small_plan: Plan):
    """A plan without motion replays to nothing."""
    assert replay(small_room, replace(small_plan, segments=())) == []


def test_start_positions_are_those_of_the_scene(small_room: Scene):
    """Before any motion objects are where the scene has them, in its order."""
    assert np.array_equal(start_positions(small_room), [[-1.0, 0.0], [0.0, 1.0]])


def test_unknown_object_is_named(small_room: Scene, small_plan: Plan):
    """A plan for another scene is refused with the segment and the objects that there are."""
    foreign = replace(small_plan, segments=(Segment("carry", "crate", np.zeros((1, 2))),))
    with pytest.raises(InputError, match=r"segments\[0\].object: no object 'crate'; there are \['obj', 'obstacle'\]"):
        replay(small_room, foreign)


@given(PATHS, st.lists(st.floats(0, 1), min_size=1, max_size=5))
def test_points_along_lie_at_their_distance(path: FloatArray, shares: list[float]):
    """Going to a point along the polyline and on to its end is as long as the polyline."""
    lengths = np.hypot(*np.diff(path, axis=0).T)
    for share in shares:
        (point,) = points_along(path, np.array([share * lengths.sum()]))
        detours = np.hypot(*(path - point).T)
        on_some_edge = np.isclose(detours[:-1] + detours[1:], lengths, atol=1e-9)
        assert on_some_edge.any() or np.allclose(path[0], point)
        reached = [lengths[:i].sum() + detours[i] for i in np.flatnonzero(on_some_edge)]
        assert not reached or np.isclose(reached, share * lengths.sum(), atol=1e-6).any()


@given(PATHS)
def test_points_along_ends(path: FloatArray):
    """Distance 0 is the start; the length, and anything beyond, the end."""
    length = np.hypot(*np.diff(path, axis=0).T).sum()
    assert np.allclose(points_along(path, np.array([0.0, length + 1.0])), path[[0, -1]])
