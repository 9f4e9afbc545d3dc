from dataclasses import replace
from itertools import islice
from typing import Any

import numpy as np
import pytest

from converter.animate_plan import FIRST_REST_S, LAST_REST_S, REST_S, plan_frames
from converter.plan import Plan, Segment
from converter.raster import Image, paint
from converter.render_scene import room_drawing, scene_drawing
from converter.scene import Scene
from converter.shape import FloatArray
from converter.theme import PAPER, Color
from pcg.errors import InputError

BLACK_OUTLINES = replace(PAPER, outline=(0.0, 0.0, 0.0))


def centre(scene: Scene, image: Image, color: Color) -> FloatArray:
    """(2,) [m]: centre of the pixels of `color`, in the world."""
    drawing = room_drawing(scene, PAPER)
    rows, columns = np.nonzero((image == np.rint(np.array(color) * 255)).all(axis=-1))
    pixel = (drawing.upper[0] - drawing.lower[0]) / image.shape[1]
    return np.array([drawing.lower[0] + (columns.mean() + 0.5) * pixel, drawing.upper[1] - (rows.mean() + 0.5) * pixel])


def frames_of(scene: Scene, plan: Plan, segment: Segment, **options: Any) -> list[Image]:
    """The frames of one segment, rests included."""
    return list(plan_frames(scene, replace(plan, segments=(segment,)), **options))


def test_frames_begin_and_end_at_rest(small_room: Scene, small_plan: Plan):
    """The first frame is the picture of the scene; the last has the goal-object in the goal and the agent back."""
    frames = list(plan_frames(small_room, small_plan, width_px=240))
    assert np.array_equal(frames[0], paint(scene_drawing(small_room), 240))
    at_goal = np.array([-1.0, 1.5, 0.1])
    moved = replace(small_room, objects=(replace(small_room.objects[0], position=at_goal), small_room.objects[1]))
    assert np.array_equal(frames[-1], paint(scene_drawing(moved), 240))


def test_number_of_frames_follows_from_length_speed_and_rests(small_room: Scene, small_plan: Plan):
    """Four metres at 2 m/s and 10 frames a second are 20 frames, and the rests come on top."""
    drive = Segment("move", None, np.array([[0.0, -1.0], [-2.0, -1.0], [0.0, -1.0]]))
    frames = frames_of(small_room, small_plan, drive, fps=10, speed=2.0, width_px=60)
    assert len(frames) == 20 + round(10 * (FIRST_REST_S + REST_S + LAST_REST_S))


def test_agent_moves_at_constant_speed(small_room: Scene, small_plan: Plan):
    """From frame to frame the disc moves by speed / fps, also around corners of the path."""
    drive = Segment("move", None, np.array([[0.0, -1.0], [0.0, -1.5], [-1.0, -1.5]]))
    frames = frames_of(small_room, small_plan, drive, fps=20, speed=1.0, width_px=400)
    moving = frames[round(20 * FIRST_REST_S) - 1 :][:31]
    path = [centre(small_room, frame, PAPER.agent) for frame in moving]
    expected = [[0.0, -1.0 - 0.05 * i] for i in range(10)] + [[-0.05 * i, -1.5] for i in range(21)]
    assert np.allclose(path, expected, atol=0.005)


def test_carried_object_keeps_its_offset(small_room: Scene, small_plan: Plan):
    """While it is carried the object moves with the agent, and no other object moves."""
    carry = Segment("carry", "obj", np.array([[-1.0, -0.4], [0.5, -0.9]]))
    frames = frames_of(small_room, small_plan, carry, width_px=400)[round(20 * FIRST_REST_S) :]
    offsets = [
        centre(small_room, frame, PAPER.goal_object) - centre(small_room, frame, PAPER.agent) for frame in frames
    ]
    assert np.allclose(offsets, [0.0, 0.4], atol=0.01)
    resting = [frame[60:180, 180:220] for frame in frames]
    assert all(np.array_equal(patch, resting[0]) for patch in resting)


def test_what_is_held_has_a_strong_outline(small_room: Scene, small_plan: Plan):
    """During a carry more pixels are dark than before and after it."""
    carry = Segment("carry", "obj", np.array([[-1.0, -0.4], [0.5, -0.9]]))
    frames = frames_of(small_room, small_plan, carry, theme=BLACK_OUTLINES)
    dark = [(frame == 0).all(axis=-1).sum() for frame in (frames[0], frames[20], frames[-1])]
    assert dark[1] > 1.3 * max(dark[0], dark[2])


def test_plan_without_motion_is_the_scene_at_rest(small_room: Scene, small_plan: Plan):
    """A failed attempt gives frames that all show the start."""
    frames = list(plan_frames(small_room, replace(small_plan, segments=()), width_px=100))
    assert len(frames) == round(20 * (FIRST_REST_S + LAST_REST_S))
    assert all(np.array_equal(frame, paint(scene_drawing(small_room), 100)) for frame in frames)


def test_segment_without_length_is_shown(small_room: Scene, small_plan: Plan):
    """A regrasp in place takes a frame and a rest."""
    regrasp = Segment("carry", "obj", np.array([[-1.0, -0.4]]))
    frames = frames_of(small_room, small_plan, regrasp, width_px=60)
    assert len(frames) == 1 + round(20 * (FIRST_REST_S + REST_S + LAST_REST_S))


def test_frames_are_the_same_each_time(small_room: Scene, small_plan: Plan):
    """Nothing about the frames depends on chance."""
    first, second = (list(islice(plan_frames(small_room, small_plan, width_px=100), 50)) for _ in range(2))
    assert np.array_equal(first, second)


@pytest.mark.parametrize(("fps", "speed"), [(0, 1.0), (-5, 1.0), (20, 0.0), (20, -1.0), (20, np.nan), (20, np.inf)])
def test_impossible_timing_is_refused(small_room: Scene, small_plan: Plan, fps: int, speed: float):
    """Speed and frame rate have to be positive; the error comes at once, not with the first frame."""
    with pytest.raises(InputError, match="both must be positive"):
        plan_frames(small_room, small_plan, fps=fps, speed=speed)


def test_endless_animations_are_refused(small_room: Scene, small_plan: Plan):
    """A path of a thousand kilometres is an error that says how many frames are allowed."""
    drive = Segment("move", None, np.array([[0.0, 0.0], [1e6, 0.0]]))
    with pytest.raises(InputError, match=r"20000006 frames for 1e\+06 m at 1 m/s; at most 3000 are allowed"):
        plan_frames(small_room, replace(small_plan, segments=(drive,)))
