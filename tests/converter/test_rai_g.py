import re
from pathlib import Path

import numpy as np
import pytest
import shapely

from converter.formats import read_scene
from converter.scene import Body, Scene
from pcg.errors import InputError

PUBLISHED = Path(__file__).parents[3] / "shared" / "scenes"
needs_published = pytest.mark.skipif(not PUBLISHED.is_dir(), reason="the authors' scenes are not beside the checkout")

ROOM = """
world { X:[0 0 .5] }
floor (world) { shape:box size:[4 6 .2] Q:[0 0 -.1] contact:1 }
start (world) { Q:[1 1 .1] }
ego (start) { shape:ssCylinder size:[.2 .15 .02] Q:[.5 -.5 0] joint:transXY contact:1 }
goal (floor) { shape:ssBox size:[.3 .2 .1 .005] Q:[-1 -1 .1] }
"""
BOX = "obj (floor) { shape:ssBox size:[.4 .2 .2 .02] Q:[0 1 .2] joint:rigid contact:1 color:[0 0 1 .5] }\n"


def scene(folder: Path, text: str) -> Scene:
    """The scene of a file with this text."""
    path = folder / "room.g"
    path.write_text(text)
    return read_scene(path)


def test_frames_become_a_scene(tmp_path: Path):
    """Heights count from the top of the floor, poses along the chain of parents, sizes from outside."""
    wall = "wall (floor) { type:ssBox size:[1 .1 .4 .02] Q:<t(0 -1 .25) d(90 0 0 1)> contact:1 }\n"
    made = scene(tmp_path, ROOM + BOX + wall)
    np.testing.assert_array_equal(made.bounds, [[-2, -3], [2, 3]])
    np.testing.assert_array_equal(made.agent.position, [1.5, 0.5])
    assert (made.agent.radius, made.agent.height) == (0.15, 0.2)
    np.testing.assert_array_equal(made.goal.position, [-1, -1])
    np.testing.assert_array_equal(made.goal.size, [0.3, 0.2])
    (obj,), (wall_body,) = made.objects, made.walls
    np.testing.assert_array_equal(obj.position, [0, 1, 0.1])
    assert obj.parts[0].box_size == pytest.approx((0.4, 0.2))
    assert obj.color == (0, 0, 1)
    np.testing.assert_allclose(wall_body.bottom_top, (-0.05, 0.35))
    np.testing.assert_allclose(wall_body.cores[0].max(axis=0), [0.03, 0.48])
    assert (made.name, made.preset, made.tolerance) == ("room", "published", 1e-3)
    assert made.source == {"file": "room.g", "format": "rai"}


def test_shapes_without_contact_are_no_walls(tmp_path: Path):
    """Markers, cameras, frames without shape and the goal's pictures do not collide."""
    markers = """
    goal_visible (floor) { shape:ssBox size:[9 9 9 .1] contact:1 }
    a (floor) { shape:ssBox size:[9 9 9 .1] }
    b (floor) { shape:mesh size:[9 9 9 .1] contact:0 }
    c (floor) { shape:camera size:[] contact:1 Q:<d(90 1 0 0)> }
    d (floor) { contact:1 }
    """
    assert scene(tmp_path, ROOM + BOX + markers).walls == ()


def test_shapes_below_an_object_are_its_parts(tmp_path: Path):
    """An L-shape is a frame with a joint and a shape, and another shape below it; the only object is the goal-object."""
    arm = "arm (l) { shape:ssBox size:[.2 .2 .2 0] Q:[0 .2 0] contact:1 }\n"
    made = scene(tmp_path, ROOM + BOX.replace("obj", "l").replace("[0 1 .2]", "<t(0 1 .2) d(90 0 0 1)>") + arm)
    (body,) = made.objects
    assert made.goal.object == body.name == "l"
    assert len(body.parts) == 2
    np.testing.assert_allclose(body.cores[1].mean(axis=0), [-0.2, 0], atol=1e-9)


def test_a_cylinder_without_joint_is_a_round_wall(tmp_path: Path):
    """`ssCylinder size [h r s]`: height first, then the radius."""
    (pillar,) = scene(
        tmp_path, ROOM + BOX + "p (floor) { shape:ssCylinder size:[.5 .3 .1] contact:1 Q:[0 0 .35] }"
    ).walls
    assert (pillar.height, pillar.parts[0].edge_radius, pillar.parts[0].core.tolist()) == (0.5, 0.3, [[0, 0]])
    np.testing.assert_allclose(pillar.bottom_top, (0, 0.5))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (BOX, "room.g: no frame called 'floor'"),
        (ROOM.replace("goal (", "target (") + BOX, "room.g: no frame called 'goal'"),
        (ROOM, "room.g, line 6: goal: no goal-object"),
        (ROOM + BOX.replace("obj", "a") + BOX.replace("obj", "b"), "none of the objects (a, b) is called obj"),
        (ROOM.replace("transXY", "none") + BOX, "room.g: one shape below a frame with joint:transXY wanted"),
        (ROOM + BOX.replace("ssBox", "torus"), "room.g, line 7: obj: shape 'torus'; allowed are ssBox, box"),
        (ROOM + BOX.replace("size:[.4", "size:[.01"), "room.g, line 7: obj: size 0.01 x 0.2 is smaller than two edge"),
        (ROOM + BOX.replace("size:[.4", "size:[-1"), "room.g, line 7: obj: size -1.0 x 0.2 must be positive"),
        (ROOM + BOX.replace("size:[.4 ", "size:["), "room.g, line 7: obj: size needs 4 numbers"),
        (ROOM + BOX.replace("[.4 .2 .2 .02]", "[.4 .2 0 .02]"), "room.g, line 7: obj: sizes must be positive"),
        (ROOM + BOX.replace("(floor)", "(table)"), "room.g, line 7: obj: no frame called 'table', its parent"),
        (ROOM + BOX.replace("(floor)", "(a)") + "a (obj) {}", "room.g, line 7: obj: its parents form a circle"),
        (ROOM + BOX.replace("rigid", "free"), "room.g, line 7: obj: joint 'free'; allowed are rigid and transXY"),
        (ROOM + BOX.replace("[0 1 .2]", "[2e4 1 .2]"), "room.g, line 7: obj: farther than 10000 m"),
        (ROOM + BOX.replace("[0 1 .2]", "<d(90 1 0 0)>"), "room.g, line 7: obj: the rotation tilts the frame"),
        (
            ROOM.replace("shape:ssCylinder size:[.2", "shape:box size:[.2") + BOX,
            "the agent must be an upright cylinder",
        ),
        (ROOM.replace("Q:[1 1 .1]", "Q:[1 1 -1]") + BOX, "room.g, line 5: ego: the agent is below the floor"),
        (ROOM.replace("Q:[-1 -1 .1]", "Q:<d(30 0 0 1)>") + BOX, "room.g, line 6: goal: must be a box that is aligned"),
        (ROOM + BOX + "x (obj) {shape:box size:[1 1 1] contact:1}", "room.g, line 8: x: the parts of obj differ in"),
    ],
)
def test_what_cannot_be_imported_is_named(tmp_path: Path, text: str, message: str):
    """Every refusal names the file, and the line wherever there is one."""
    with pytest.raises(InputError, match=re.escape(message)):
        scene(tmp_path, text)


def gap(made: Scene, body: Body) -> float:
    """Distance [m] from the agent to a body of one part, by shapely; negative when they overlap by less than radii."""
    core = shapely.Polygon(body.cores[0] + body.position[:2])
    return core.distance(shapely.Point(made.agent.position)) - body.parts[0].edge_radius - made.agent.radius


# Facts about the published scenes: blocks, the agent's cell (column from the left, row from the bottom) and the blocks
# that it touches at the start.
GENERATED = {
    "a11-6": (16, (7, 7), {"block_6_7"}),
    "a15-20": (13, (2, 9), set()),
    "a19-20": (10, (5, 5), {"block_4_5"}),
    "a23-6": (17, (4, 5), {"block_3_5", "block_4_4", "block_5_5"}),
    "a3-92": (11, (3, 6), {"block_2_6"}),
    "a35-2": (18, (7, 8), {"block_7_7", "block_7_9"}),
}


@needs_published
@pytest.mark.parametrize("name", GENERATED)
def test_the_generated_scenes(name: str):
    """Walls, cells and initial contacts of the published generated scenes."""
    made = read_scene(PUBLISHED / "pcg" / f"{name}.g")
    blocks, (column, row), touched = GENERATED[name]
    walls = {wall.name: wall for wall in made.walls if wall.name.startswith("block_")}
    assert len(made.walls) == blocks + 4
    assert len(walls) == blocks
    for wall in walls.values():
        cell = np.array([int(number) for number in wall.name.split("_")[1:]])
        np.testing.assert_array_equal(np.round(wall.position[:2] - (cell - 5.5) * 0.4, 12), 0)
        np.testing.assert_allclose(wall.bottom_top, (-0.05, 0.35), atol=1e-12)
        assert wall.parts[0].box_size == pytest.approx((0.4, 0.4))
        assert wall.parts[0].edge_radius == 0.01
    np.testing.assert_allclose(made.agent.position, (np.array([column, row]) - 5.5) * 0.4, atol=1e-12)
    gaps = {body.name: gap(made, body) for body in (*made.walls, *made.objects)}
    assert {other for other, distance in gaps.items() if distance < made.tolerance} == touched
    assert min(gaps.values()) > -1e-9
    assert [(body.name, body.height, body.bottom_top[0]) for body in made.objects] == [
        ("obj", 0.2, 0.0),
        ("obj1", 0.2, 0.0),
    ]
    assert made.goal.size.tolist() == [0.35, 0.35]


@needs_published
def test_the_outer_walls_of_the_published_scenes():
    """Inner faces 1.95 m from the middle, edges rounded by 4 cm, standing on the floor."""
    made = read_scene(PUBLISHED / "pcg" / "a11-6.g")
    outer = {wall.name: wall for wall in made.walls if wall.name.startswith("outwall_")}
    assert set(outer) == {"outwall_right", "outwall_back", "outwall_left", "outwall_front"}
    assert outer["outwall_right"].position.tolist() == [0, -2, 0.2]
    assert outer["outwall_right"].parts[0].box_size == pytest.approx((4.1, 0.1))
    assert outer["outwall_right"].bottom_top == (0, 0.4)
    assert {wall.parts[0].edge_radius for wall in outer.values()} == {0.04}
