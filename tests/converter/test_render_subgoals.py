"""Pictures of subgoals."""

import numpy as np
import pytest

from converter.raster import Image, paint
from converter.render_scene import scene_drawing
from converter.render_subgoals import MARGIN, score_color, subgoals_drawing
from converter.scene import Scene
from converter.theme import PAPER, mixed

CANDIDATES = np.array([[1.6, 1.6], [1.6, -1.6], [-1.6, -1.6]])
SCORES = np.array([0.0, 5.0, 15.0])
NONE = np.array([], dtype=np.int64)


def pixel(image: Image, scene: Scene, position: np.ndarray, panel: int) -> list[int]:
    """The colour at a place of the left (0) or right (1) panel."""
    room = scene_drawing(scene)
    size = room.upper - room.lower
    width = image.shape[1] // 2
    step = size[0] / width
    column, row = (position[0] - room.lower[0]) / step, (room.upper[1] + MARGIN * room.unit - position[1]) / step
    return image[int(row), int(column) + panel * width].tolist()


def test_dots_have_the_colours_of_their_scores_before_and_after(small_room: Scene):
    """On the left all candidates, on the right those that passed; what did not pass shows the floor there."""
    image = paint(subgoals_drawing(small_room, CANDIDATES, SCORES, np.array([1, 2]), np.array([2])), 1200)
    floor = [round(255 * channel) for channel in PAPER.floor]
    for i, (position, score) in enumerate(zip(CANDIDATES, SCORES, strict=True)):
        color = [round(255 * channel) for channel in score_color(score, SCORES)]
        np.testing.assert_allclose(pixel(image, small_room, position, 0), color, atol=1)
        np.testing.assert_allclose(pixel(image, small_room, position, 1), floor if i == 0 else color, atol=1)


def test_drawn_subgoals_are_ringed(small_room: Scene):
    """The ring's pale ground shows beside the dot of a drawn candidate, and beside no other one."""
    passed = np.array([1, 2])
    beside = np.array([6.9 * scene_drawing(small_room).unit, 0.0])
    image = paint(subgoals_drawing(small_room, CANDIDATES, SCORES, passed, np.array([2])), 1200)
    ringed, plain = (pixel(image, small_room, CANDIDATES[i] + beside, 1) for i in (2, 1))
    assert ringed == [255, 255, 255]
    assert plain == [round(255 * channel) for channel in PAPER.floor]


def test_colours_grow_darker_with_the_score():
    """They can be told apart in grey; if all scores are equal there is one colour."""
    brightness = [sum(score_color(score, SCORES)) for score in SCORES]
    assert brightness[0] > brightness[1] > brightness[2]
    assert score_color(5.0, np.array([5.0, 5.0])) == score_color(15.0, SCORES)
    assert score_color(7.5, SCORES) == pytest.approx(mixed(score_color(0, SCORES), score_color(15, SCORES), 0.5))


def test_nothing_to_show_is_a_picture_of_the_scene(small_room: Scene):
    """An object that can go nowhere has no dots; headings and size stay."""
    with_dots = paint(subgoals_drawing(small_room, CANDIDATES, SCORES, np.array([1]), NONE), 1200)
    without = paint(subgoals_drawing(small_room, np.empty((0, 2)), np.empty(0), NONE, NONE), 1200)
    assert with_dots.shape == without.shape
    assert without.std() > 0
