from dataclasses import replace

import numpy as np
import pytest

from converter.raster import Image, paint
from converter.render_scene import object_color, room_drawing, scene_drawing
from converter.scene import Body, Scene
from converter.shape import Part
from converter.theme import PAPER, Color


def image_of(scene: Scene, width_px: int = 600) -> Image:
    """The picture of a scene."""
    return paint(scene_drawing(scene), width_px)


def pixel_at(scene: Scene, image: Image, x: float, y: float) -> list[int]:
    """Colour of the pixel that shows the point (x, y) of the world."""
    drawing = room_drawing(scene, PAPER)
    scale = image.shape[1] / (drawing.upper[0] - drawing.lower[0])
    return image[int((drawing.upper[1] - y) * scale), int((x - drawing.lower[0]) * scale)].tolist()


def levels(color: Color) -> list[int]:
    """A colour in 0..255."""
    return np.rint(np.array(color) * 255).astype(int).tolist()


def mirrored_body(body: Body) -> Body:
    """The body with left and right exchanged."""
    parts = tuple(Part(part.core[::-1] * [-1.0, 1.0], part.edge_radius) for part in body.parts)
    return replace(body, position=body.position * [-1.0, 1.0, 1.0], parts=parts, yaw=-body.yaw)


def mirrored(scene: Scene) -> Scene:
    """The scene with left and right exchanged; its bounds must be symmetric."""
    return replace(
        scene,
        agent=replace(scene.agent, position=scene.agent.position * [-1.0, 1.0]),
        walls=tuple(map(mirrored_body, scene.walls)),
        objects=tuple(map(mirrored_body, scene.objects)),
        goal=replace(scene.goal, position=scene.goal.position * [-1.0, 1.0]),
    )


@pytest.fixture
def varied_room(small_room: Scene):
    """The small room with a turned wall, an L-shaped object and a rounded triangle."""
    corner = (Part.box((0.6, 0.2)), Part(np.array([[-0.3, -0.1], [-0.1, -0.1], [-0.1, 0.5], [-0.3, 0.5]])))
    triangle = (Part(np.array([[0.0, 0.2], [-0.2, -0.1], [0.2, -0.1]]), 0.05),)
    beam = Body("beam", np.array([-0.5, -1.5, 0.1]), 0.2, (Part.box((1.0, 0.1), 0.02),), yaw=0.3)
    return replace(
        small_room,
        walls=(*small_room.walls, beam),
        objects=(
            *small_room.objects,
            Body("corner", np.array([0.3, 0.2, 0.1]), 0.2, corner, yaw=0.4),
            Body("triangle", np.array([1.5, 1.0, 0.1]), 0.2, triangle, color=(1.0, 0.0, 1.0)),
        ),
    )


def test_everything_has_its_colour(small_room: Scene):
    """Walls are brown, the agent yellow, the goal red, the goal-object blue, obstacles white, the rest floor."""
    image = image_of(small_room)
    assert pixel_at(small_room, image, 1.0, 0.9) == levels(PAPER.wall)
    assert pixel_at(small_room, image, 0.0, -1.0) == levels(PAPER.agent)
    assert pixel_at(small_room, image, -1.0, 1.5) == levels(PAPER.goal)
    assert pixel_at(small_room, image, -1.0, 0.0) == levels(PAPER.goal_object)
    assert pixel_at(small_room, image, 0.0, 1.0) == [255, 255, 255]
    assert pixel_at(small_room, image, 1.5, -1.5) == levels(PAPER.floor)


def test_agent_covers_its_area(small_room: Scene):
    """The agent's disc has its radius in pixels."""
    image = image_of(small_room, 800)
    drawing = room_drawing(small_room, PAPER)
    radius_px = 0.2 * 800 / (drawing.upper[0] - drawing.lower[0])
    yellow = (image == levels(PAPER.agent)).all(axis=-1).sum()
    # Pixels that the circle crosses are mixed: about half a pixel along the circumference is missing.
    assert np.pi * (radius_px - 1) ** 2 < yellow <= np.pi * radius_px**2


def test_rounded_edges_are_round(small_room: Scene):
    """Just inside the corner of a box of 0.4 m rounded by 0.15 m there is floor, in a sharp one the box."""
    for edge_radius, color in ((0.15, PAPER.floor), (0.0, PAPER.goal_object)):
        box = Body("obj", np.array([-1.0, 0.0, 0.1]), 0.2, (Part.box((0.4, 0.4), edge_radius),))
        image = image_of(replace(small_room, objects=(box,)))
        assert pixel_at(small_room, image, -1.0 + 0.18, 0.18) == levels(color)
        assert pixel_at(small_room, image, -1.0 + 0.18, 0.0) == levels(PAPER.goal_object)


def test_bodies_turn_counter_clockwise(small_room: Scene):
    """A beam along x, turned by 45 degrees, goes from the lower left to the upper right."""
    beam = Body("obj", np.array([0.0, 0.0, 0.1]), 0.2, (Part.box((1.0, 0.2)),), yaw=np.pi / 4)
    image = image_of(replace(small_room, objects=(beam,)))
    assert pixel_at(small_room, image, 0.3, 0.3) == levels(PAPER.goal_object)
    assert pixel_at(small_room, image, -0.3, 0.3) == levels(PAPER.floor)


def test_compound_bodies_keep_their_notch(varied_room: Scene):
    """Both arms of an L-shape are drawn in one colour, and what lies between them is floor."""
    upright = tuple(replace(body, yaw=0.0) for body in varied_room.objects)
    scene = replace(varied_room, objects=upright)
    image = image_of(scene)
    color = levels(object_color(scene, scene.object("corner"), PAPER))
    assert [pixel_at(scene, image, 0.3 + x, 0.2 + y) for x, y in ((0.2, 0.0), (-0.2, 0.4))] == [color, color]
    assert pixel_at(scene, image, 0.3 + 0.1, 0.2 + 0.3) == levels(PAPER.floor)


def test_own_colours_go_before_the_themes(varied_room: Scene):
    """A body that brings a colour keeps it."""
    assert pixel_at(varied_room, image_of(varied_room), 1.5, 1.0) == [255, 0, 255]


def test_mirrored_scene_gives_mirrored_image(varied_room: Scene):
    """Exchanging left and right in the scene exchanges them in the picture."""
    image, other = image_of(varied_room, 300), image_of(mirrored(varied_room), 300)
    assert np.abs(image[:, ::-1].astype(int) - other).max() <= 1
    assert (image[:, ::-1] != image).any()


def test_many_obstacles_reuse_colours(small_room: Scene):
    """There are as many obstacles as one likes, each with a colour."""
    obstacles = tuple(
        Body(f"o{i}", np.array([-1.5 + 0.3 * i, -1.7, 0.1]), 0.2, (Part.box((0.2, 0.2)),)) for i in range(9)
    )
    scene = replace(small_room, objects=(small_room.goal_object, *obstacles))
    colors = [object_color(scene, body, PAPER) for body in obstacles]
    count = len(PAPER.obstacles)
    assert colors == [PAPER.obstacles[i % count] for i in range(9)]


def test_picture_contains_every_body(small_room: Scene):
    """Bodies beyond the bounds widen the picture."""
    outer = Body("outwall_back", np.array([2.5, 0.0, 0.1]), 0.2, (Part.box((0.2, 4.0)),))
    drawing = scene_drawing(replace(small_room, walls=(outer,)))
    assert drawing.upper[0] >= 2.6
    assert drawing.lower[0] <= -2.0


def test_look_does_not_depend_on_the_scale_of_the_world(small_room: Scene):
    """Doubling the width of the image doubles every line: averaged down it is the same picture."""
    small, large = image_of(small_room, 200), image_of(small_room, 400)
    averaged = large.reshape(200, 2, 200, 2, 3).mean(axis=(1, 3))
    assert np.abs(averaged - small).mean() < 0.5


def test_thousands_of_walls_are_painted(small_room: Scene):
    """Each where it is."""
    walls = tuple(
        Body(f"w{i}", np.array([-1.9 + 0.05 * (i % 77), -1.9 + 0.05 * (i // 77), 0.1]), 0.2, (Part.box((0.02, 0.02)),))
        for i in range(3000)
    )
    image = image_of(replace(small_room, walls=walls))
    for wall in (walls[0], walls[1234], walls[-1]):
        x, y = wall.position[:2]
        assert pixel_at(small_room, image, x, y) == levels(PAPER.wall)
