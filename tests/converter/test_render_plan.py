from dataclasses import replace

import numpy as np
import pytest

from converter.drawing import Drawing, Label, Line
from converter.plan import Plan, Segment
from converter.raster import Image, paint
from converter.render_plan import Placement, placements, plan_drawing
from converter.render_scene import scene_drawing
from converter.replay import replay
from converter.scene import Scene
from converter.theme import PAPER, Color
from pcg.errors import InputError


def pixel_at(drawing: Drawing, image: Image, x: float, y: float) -> list[int]:
    """Colour of the pixel that shows the point (x, y) of the world."""
    scale = image.shape[1] / (drawing.upper[0] - drawing.lower[0])
    return image[int((drawing.upper[1] - y) * scale), int((x - drawing.lower[0]) * scale)].astype(int).tolist()


def levels(color: Color) -> list[int]:
    """A colour in 0..255."""
    return np.rint(np.array(color) * 255).astype(int).tolist()


def placed(scene: Scene, plan: Plan) -> list[Placement]:
    """The placements of a plan."""
    return placements([(scene.objects[s.carried], s) for s in replay(scene, plan) if s.carried is not None])


def labels(drawing: Drawing) -> list[str]:
    """The texts of a drawing."""
    return [item.text for item in drawing.items if isinstance(item, Label)]


def test_paths_have_the_colours_of_their_modes(small_room: Scene, small_plan: Plan):
    """A quarter along a carry the path is blue, along a drive grey."""
    drawing = plan_drawing(small_room, small_plan)
    image = paint(drawing, 1200)
    assert pixel_at(drawing, image, -1.05, -0.2) == levels(PAPER.goal_object)
    assert pixel_at(drawing, image, -0.25, -1.0) == levels(PAPER.move)


def test_every_segment_has_its_line(small_room: Scene, small_plan: Plan):
    """Each segment's path is drawn, carries wider than drives."""
    lines = [item for item in plan_drawing(small_room, small_plan).items if isinstance(item, Line)]
    for segment in small_plan.segments:
        (line,) = [line for line in lines if line.points is segment.path][-1:]
        assert line.color == (PAPER.move if segment.mode == "move" else PAPER.goal_object)
    carry, move = (min(line.width for line in lines if line.color == c) for c in (PAPER.goal_object, PAPER.move))
    assert carry > 2 * move


def test_placements_are_numbered_in_order(small_room: Scene, small_plan: Plan):
    """The first placement is 1, the one in the goal is 2."""
    found = placed(small_room, small_plan)
    assert [place.numbers for place in found] == [(1,), (2,)]
    assert np.allclose([place.position for place in found], [[-1.2, 0.8], [-1.0, 1.5]])
    assert labels(plan_drawing(small_room, small_plan)) == ["1", "2"]


def test_placements_are_translucent(small_room: Scene, small_plan: Plan):
    """Where an object is put down, its colour shows on the floor, between that of the floor and its own."""
    drawing = plan_drawing(small_room, small_plan)
    image = paint(drawing, 1200)
    ghost = np.array(pixel_at(drawing, image, -1.36, 0.64))
    floor, own = np.array(levels(PAPER.floor)), np.array(levels(PAPER.goal_object))
    assert np.allclose(ghost, floor + PAPER.ghost_opacity * (own - floor), atol=2)


def test_start_stays_solid(small_room: Scene, small_plan: Plan):
    """Objects and agent at the start look as in the picture of the scene."""
    drawing = plan_drawing(small_room, small_plan)
    image = paint(drawing, 600)
    assert pixel_at(drawing, image, -0.85, 0.1) == levels(PAPER.goal_object)
    assert pixel_at(drawing, image, 0.05, -1.1) == levels(PAPER.agent)


def test_repeated_placements_share_a_label(small_room: Scene, small_plan: Plan):
    """Regrasps in place are listed in one label, which says when it leaves some out."""
    regrasp = Segment("carry", "obj", np.array([[0.0, 0.0]]))
    once_more = replace(small_plan, segments=(regrasp, regrasp))
    assert labels(plan_drawing(small_room, once_more)) == ["1,2"]
    often = replace(small_plan, segments=(regrasp,) * 50)
    assert labels(plan_drawing(small_room, often)) == ["1,2,3…"]


def test_objects_placed_at_one_place_keep_their_own_labels(small_room: Scene, small_plan: Plan):
    """Two objects, one after the other at the same place, are two placements."""
    stacked = replace(
        small_plan,
        segments=(
            Segment("carry", "obj", np.array([[-1.0, 0.0], [0.5, 0.0]])),
            Segment("carry", "obj", np.array([[0.5, 0.0], [0.5, -1.0]])),
            Segment("carry", "obstacle", np.array([[0.0, 1.0], [0.5, 0.0]])),
        ),
    )
    assert [(place.body.name, place.numbers) for place in placed(small_room, stacked)] == [
        ("obj", (1,)),
        ("obj", (2,)),
        ("obstacle", (3,)),
    ]


def test_plan_without_motion_shows_the_scene(small_room: Scene, small_plan: Plan):
    """A planning attempt that failed gives the picture of the scene."""
    assert np.array_equal(
        paint(plan_drawing(small_room, replace(small_plan, segments=())), 600), paint(scene_drawing(small_room), 600)
    )


def test_plan_for_another_scene_is_refused(small_room: Scene, small_plan: Plan):
    """A segment with an unknown object is an error that names it."""
    foreign = replace(small_plan, segments=(Segment("carry", "crate", np.zeros((1, 2))),))
    with pytest.raises(InputError, match="no object 'crate'"):
        plan_drawing(small_room, foreign)


def test_arrows_point_ahead(small_room: Scene, small_plan: Plan):
    """The wide end of the arrow head on a drive to the right is left of its tip."""
    drive = replace(small_plan, segments=(Segment("move", None, np.array([[-1.5, -1.5], [1.5, -1.5]])),))
    image = paint(plan_drawing(small_room, drive), 1200)
    grey = (np.abs(image.astype(int) - levels(PAPER.move)) <= 2).all(axis=-1)
    thickness = grey[1000:].sum(axis=0)
    (wide,) = np.flatnonzero(thickness == thickness.max())[:1]
    after, before = thickness[wide + 15], thickness[wide - 15]
    assert thickness.max() > 2 * before
    assert after < thickness.max() - 4
    assert np.flatnonzero(thickness > 1.5 * before).min() >= wide - 3


def test_paths_far_outside_are_cut(small_room: Scene, small_plan: Plan):
    """A path to the largest coordinates that a plan file may have leaves the picture, which stays as it was."""
    away = replace(small_plan, segments=(Segment("move", None, np.array([[0.0, 2.05], [1e4, 1e4], [-1e4, 1e4]])),))
    assert (paint(plan_drawing(small_room, away), 600) != paint(scene_drawing(small_room), 600)).any(
        axis=-1
    ).sum() < 200
