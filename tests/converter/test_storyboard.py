"""Storyboards."""

from dataclasses import replace

import numpy as np
import pytest

from converter.drawing import Drawing, Inset, Label, Line, Shape
from converter.plan import Plan, Segment
from converter.raster import paint
from converter.scene import Scene
from converter.storyboard import storyboard_drawing
from converter.theme import PAPER
from pcg.errors import InputError


def frames(drawing: Drawing) -> list[Drawing]:
    """The pictures of a storyboard."""
    return [item.drawing for item in drawing.items if isinstance(item, Inset)]


def dots(frame: Drawing) -> list[list[float]]:
    """Centres of the grey dots of a frame."""
    return [s.parts[0].core[0].tolist() for s in frame.items if isinstance(s, Shape) and s.fill == PAPER.subgoal]


def agent(frame: Drawing) -> list[float]:
    """Where a frame shows the agent."""
    (shape,) = [item for item in frame.items if isinstance(item, Shape) and item.fill == PAPER.agent]
    return shape.parts[0].core[0].tolist()


def test_a_frame_for_each_grasp_and_one_for_the_end(small_room: Scene, small_plan: Plan):
    """The agent is where it grasps, at last where the plan ends; each frame says what is carried."""
    drawing = storyboard_drawing(small_room, small_plan)
    assert [item.text for item in drawing.items if isinstance(item, Label)] == [
        "1: carries obj",
        "2: carries obj",
        "end",
    ]
    assert [agent(frame) for frame in frames(drawing)] == [[-1.0, -0.4], [-1.0, 0.4], [0.0, -1.0]]


def test_every_frame_marks_all_subgoals(small_room: Scene, small_plan: Plan):
    """Grey dots where the object is put down; the next one once more, with a ring, at the end of its way."""
    first, second, end = frames(storyboard_drawing(small_room, small_plan))
    places = np.array([[-1.2, 0.8], [-1.0, 1.5]])
    assert np.allclose(dots(first), [*places, places[0]])
    assert np.allclose(dots(second), [*places, places[1]])
    assert np.allclose(dots(end), places)
    ways = [[item.points[-1] for item in f.items if isinstance(item, Line)][-1] for f in (first, second)]
    assert np.allclose(ways, places)


@pytest.mark.parametrize("count", [0, 200])
def test_what_cannot_be_shown_is_refused(small_room: Scene, small_plan: Plan, count: int):
    """No carry, or more than a page can hold."""
    regrasp = Segment("carry", "obj", np.array([[-1.0, -0.4]]))
    with pytest.raises(InputError, match=f"{count} pick-places; a storyboard shows 1 to 199"):
        storyboard_drawing(small_room, replace(small_plan, segments=(regrasp,) * count))


def test_a_storyboard_is_the_same_each_time(small_room: Scene, small_plan: Plan):
    """As an image."""
    first, second = (paint(storyboard_drawing(small_room, small_plan), 400) for _ in range(2))
    assert np.array_equal(first, second)
