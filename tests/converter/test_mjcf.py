from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
import shapely
from hypothesis import given, settings

from converter.convert import ConversionSettings, convert_level
from converter.formats import read_scene, write_scene
from converter.formats.mjcf import FLOOR, GOAL, GRASP_PREFIX, Movable, body_names, mjcf_text
from converter.outline import MAX_ERROR
from converter.preset import with_preset
from converter.scene import AGENT, Agent, Body, Goal, Scene
from converter.shape import Part, rotation
from pcg.level import Level

ROOT = Path(__file__).parents[2]
PUZZLES = sorted((ROOT / "data" / "puzzles").glob("*.yaml"))
PUBLISHED = ROOT.parent / "shared" / "scenes" / "pcg"
SINGLE_PRECISION = 1e-6
"""MuJoCo keeps vertices of meshes in single precision [m]."""


def loaded(scene: Scene, movable: Movable = Movable.FREE) -> tuple[Any, Any]:
    """Model and data of a scene, with all poses computed."""
    model = mujoco.MjModel.from_xml_string(mjcf_text(scene, movable))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def footprint(model: Any, data: Any, geom: int) -> tuple[shapely.Geometry, float, float]:
    """Outline in the plane and height interval of a geom in the world, from MuJoCo's own numbers."""
    turn, place, size = data.geom_xmat[geom].reshape(3, 3), data.geom_xpos[geom], model.geom_size[geom]
    kind = model.geom_type[geom]
    if kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        return shapely.Point(place[:2]).buffer(size[0], quad_segs=400), place[2] - size[1], place[2] + size[1]
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
        points = signs * size
    else:
        mesh = model.geom_dataid[geom]
        first = model.mesh_vertadr[mesh]
        points = model.mesh_vert[first : first + model.mesh_vertnum[mesh]].astype(float)
    points = points @ turn.T + place
    return shapely.convex_hull(shapely.MultiPoint(points[:, :2])), points[:, 2].min(), points[:, 2].max()


def exact(body: Body, part: Part) -> shapely.Geometry:
    """The outline of a part of a body in the world."""
    core = part.core @ rotation(body.yaw) + body.position[:2]
    hull = shapely.convex_hull(shapely.MultiPoint(core))
    return hull.buffer(part.edge_radius, quad_segs=400) if part.edge_radius > SINGLE_PRECISION else hull


def assert_same_geometry(scene: Scene, model: Any, data: Any) -> None:
    """Every part of every body is where it belongs, as large as it is, and of the right height."""
    names = body_names(scene)
    for name, body in zip((*names.walls, *names.objects), (*scene.walls, *scene.objects), strict=True):
        index = model.body(name).id
        first = model.body_geomadr[index]
        assert model.body_geomnum[index] == len(body.parts)
        for k, part in enumerate(body.parts):
            outline, bottom, top = footprint(model, data, first + k)
            np.testing.assert_allclose((bottom, top), body.bottom_top, atol=SINGLE_PRECISION)
            assert shapely.hausdorff_distance(outline, exact(body, part)) <= MAX_ERROR + 5 * SINGLE_PRECISION
    outline, bottom, top = footprint(model, data, model.geom(AGENT).id)
    np.testing.assert_allclose(outline.centroid.coords[0], scene.agent.position, atol=1e-9)
    np.testing.assert_allclose((bottom, top), (0, scene.agent.height), atol=1e-9)
    assert model.geom(AGENT).size[0] == pytest.approx(scene.agent.radius, abs=1e-9)


@pytest.mark.parametrize("preset", ["published", "clear"])
@pytest.mark.parametrize("path", PUZZLES, ids=lambda path: path.stem)
def test_the_puzzles_load_with_their_geometry(path: Path, preset: str):
    """Outlines within 0.1 mm, heights, places."""
    scene = with_preset(read_scene(path), preset)
    assert_same_geometry(scene, *loaded(scene))


@pytest.mark.skipif(not PUBLISHED.is_dir(), reason="the authors' scenes are not beside the checkout")
@pytest.mark.parametrize("name", ["a11-6", "a15-20", "a19-20", "a23-6", "a3-92", "a35-2"])
def test_the_published_scenes_load_with_their_geometry(name: str):
    """As the puzzles; one mesh serves all blocks of the same shape."""
    scene = read_scene(PUBLISHED / f"{name}.g")
    model, data = loaded(scene)
    assert_same_geometry(scene, model, data)
    assert model.nmesh == 4


def drawn_level(rng: np.random.Generator) -> Level:
    """A 10 x 10 level with a player, two crates and a target on different cells, solvable or not."""
    is_wall = rng.random((10, 10)) < rng.uniform(0.05, 0.4)
    cells = rng.permutation(np.argwhere(~is_wall))[:4].tolist()
    player, first, second, target = (tuple(cell) for cell in cells)
    return Level.of(is_wall, players=[player], crates=[first, second], targets=[target], goal_crate=first)


@pytest.mark.slow
def test_converted_levels_load():
    """360 random levels, in the two geometries by turns: each model has its scene's bodies."""
    rng = np.random.default_rng(6)
    for preset in ("clear", "published") * 180:
        scene = convert_level(drawn_level(rng), ConversionSettings(preset=preset))
        model = mujoco.MjModel.from_xml_string(mjcf_text(scene))
        assert model.nbody == 2 + len(scene.walls) + len(scene.objects)
        assert model.neq == len(scene.objects)


@settings(max_examples=25)
@given(scene=...)
def test_any_scene_loads_with_its_geometry(scene: Scene):
    """Polygons, several parts, any yaw, any printable names."""
    assert_same_geometry(scene, *loaded(scene))


def test_a_model_that_is_stepped_stays_as_it_is(small_room: Scene):
    """Nothing moves by itself: the servos hold the agent at its start, friction holds the objects."""
    model, data = loaded(small_room)
    for _ in range(500):
        mujoco.mj_step(model, data)
    np.testing.assert_allclose(data.body(AGENT).xpos[:2], small_room.agent.position, atol=1e-9)
    for body in small_room.objects:
        np.testing.assert_allclose(data.body(body.name).xpos, body.position, atol=5e-4)


def test_the_agent_has_two_slide_joints_within_the_bounds(small_room: Scene):
    """Joint positions are displacements from the start; their range is the room's; four servos."""
    scene = replace(small_room, agent=Agent(np.array([0.5, -1.0]), 0.2))
    model, _ = loaded(scene)
    kinds = [model.joint(f"{AGENT}_{axis}").type[0] for axis in "xy"]
    assert kinds == [mujoco.mjtJoint.mjJNT_SLIDE] * 2
    np.testing.assert_allclose(model.joint("agent_x").range, [-2.5, 1.5])
    np.testing.assert_allclose(model.joint("agent_y").range, [-1.0, 3.0])
    assert [model.actuator(i).name for i in range(model.nu)] == [
        "agent_position_x",
        "agent_position_y",
        "agent_velocity_x",
        "agent_velocity_y",
    ]


def test_the_goal_is_a_site_on_the_floor(small_room: Scene):
    """Its half sizes are those of the goal rectangle."""
    model, data = loaded(small_room)
    np.testing.assert_allclose(data.site(GOAL).xpos, [-1.0, 1.5, 0.0])
    np.testing.assert_allclose(model.site(GOAL).size[:2], [0.25, 0.2])


def test_free_objects_have_welds_and_mocap_objects_have_none(small_room: Scene):
    """A weld per free object, off at first; a mocap body per object otherwise."""
    model, data = loaded(small_room)
    assert [model.equality(i).name for i in range(model.neq)] == [GRASP_PREFIX + "obj", GRASP_PREFIX + "obstacle"]
    assert not data.eq_active.any()
    model, _ = loaded(small_room, Movable.MOCAP)
    assert (model.neq, model.nmocap, model.nq) == (0, 2, 2)


def test_shapes_become_the_simplest_geoms():
    """A disc is a cylinder, a sharp box in any direction a box, everything else a mesh."""
    turned = Part(Part.box((0.4, 0.2)).core @ rotation(0.5) + np.array([0.3, 0.0]))
    parts = (Part(np.array([[0.1, 0.0]]), 0.1), turned, Part.box((0.2, 0.2), 0.02))
    scene = Scene(
        name="shapes",
        bounds=np.array([[-2.0, -2.0], [2.0, 2.0]]),
        tolerance=0.0,
        agent=Agent(np.zeros(2), 0.2),
        walls=(Body("wall", np.array([1.0, 1.0, 0.3]), 0.6, parts, 0.7),),
        objects=(Body("obj", np.array([-1.0, 0.0, 0.1]), 0.2, (Part.box((0.2, 0.2)),)),),
        goal=Goal("obj", np.zeros(2), np.ones(2)),
    )
    model, data = loaded(scene)
    first = int(model.body_geomadr[model.body("wall").id])
    kinds = [mujoco.mjtGeom.mjGEOM_CYLINDER, mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_MESH]
    assert model.geom_type[first : first + 3].tolist() == kinds
    assert_same_geometry(scene, model, data)


def test_names_that_mean_something_else_are_changed(small_room: Scene):
    """A body may be called as the world, the agent's joints or, but for the case, the agent, or like markup."""
    bodies = [
        Body(name, np.array([x, 0.0, 0.1]), 0.2, (Part.box((0.2, 0.2)),))
        for x, name in enumerate(["Agent", "world", "a<b&'\"", "agent_x"])
    ]
    goal = replace(small_room.goal, object="world")
    scene = replace(small_room, walls=bodies[:1], objects=bodies[1:], goal=goal)
    names = body_names(scene)
    assert names.walls == ("Agent_2",)
    assert names.objects == ("world_2", "a_b_", "agent_x_2")
    model, _ = loaded(scene)
    assert {model.body(i).name for i in range(model.nbody)} == {"world", AGENT, *names.walls, *names.objects}


def test_touching_is_measured_exactly():
    """A disc 0.3 mm inside of a box is 0.3 mm inside for the engine."""
    scene = Scene(
        name="touch",
        bounds=np.array([[-2.0, -2.0], [2.0, 2.0]]),
        tolerance=0.0,
        agent=Agent(np.array([0.1, 0.03]), 0.2),
        walls=(),
        objects=(Body("obj", np.array([0.1 + 0.2 + 0.1 - 3e-4, 0.0, 0.1]), 0.2, (Part.box((0.2, 0.2)),)),),
        goal=Goal("obj", np.zeros(2), np.ones(2)),
    )
    model, data = loaded(scene)
    depths = [-c.dist for c in data.contact if model.geom(FLOOR).id not in c.geom]
    assert max(depths) == pytest.approx(3e-4, abs=2e-6)


def test_the_same_scene_gives_the_same_file(tmp_path: Path, small_room: Scene):
    """Byte for byte, and equal to the text."""
    for name in ("a.xml", "b.xml"):
        write_scene(tmp_path / name, small_room)
    assert (tmp_path / "a.xml").read_bytes() == (tmp_path / "b.xml").read_bytes()
    assert (tmp_path / "a.xml").read_text() == mjcf_text(small_room)


def test_numbers_are_written_without_noise(small_room: Scene):
    """0.1 + 0.2 is written 0.3."""
    scene = replace(small_room, agent=Agent(np.array([0.1 + 0.2, -1.0]), 0.2))
    assert 'pos="0.3 -1 0.1"' in mjcf_text(scene)
