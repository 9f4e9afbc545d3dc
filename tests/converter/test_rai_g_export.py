import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings

from converter.formats import read_scene, write_scene
from converter.formats.rai_g import SHARP
from converter.formats.rai_g_export import rai_g_text
from converter.preset import with_preset
from converter.scene import Body, Goal, Scene
from converter.shape import FloatArray, Part, rotation
from pcg.errors import InputError

ROOT = Path(__file__).parents[2]
PUBLISHED = ROOT.parent / "shared" / "scenes"
PUZZLES = sorted((ROOT / "data" / "puzzles").glob("*.yaml"))
AUTHORS = sorted(path for path in PUBLISHED.glob("*/*.g") if not path.stem.startswith("base"))


def round_trip(scene: Scene, folder: Path) -> Scene:
    """The scene after writing and reading."""
    write_scene(folder / "scene.g", scene)
    return read_scene(folder / "scene.g")


def solids(bodies: tuple[Body, ...]) -> list[tuple[float, ...]]:
    """What bodies fill: of each part its height interval, edge radius and vertices in the world, in a fixed order."""
    found = []
    for body in bodies:
        for part in body.parts:
            corners: FloatArray = part.core @ rotation(body.yaw) + body.position[:2]
            keys = corners.round(6)
            corners = corners[np.lexsort((keys[:, 1], keys[:, 0]))]
            radius = part.edge_radius if part.edge_radius >= SHARP else 0.0
            found.append((*body.bottom_top, radius, *corners.ravel()))
    return sorted(found, key=lambda solid: (len(solid), *np.round(solid, 6)))


def assert_same(first: Scene, second: Scene) -> None:
    """The two scenes are geometrically equal to nanometres; walls may be divided."""
    for left, right in (
        (solids(first.walls), solids(second.walls)),
        *((solids((a,)), solids((b,))) for a, b in zip(first.objects, second.objects, strict=True)),
    ):
        assert [len(solid) for solid in left] == [len(solid) for solid in right]
        for one, other in zip(left, right, strict=True):
            np.testing.assert_allclose(one, other, rtol=0, atol=2e-9)
    for one, other in (
        (first.bounds, second.bounds),
        (first.agent.position, second.agent.position),
        (first.goal.position, second.goal.position),
        (first.goal.size, second.goal.size),
        ([first.agent.radius, first.agent.height], [second.agent.radius, second.agent.height]),
        ([body.position for body in first.objects], [body.position for body in second.objects]),
    ):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-9)
    goals = [scene.object_names.index(scene.goal.object) for scene in (first, second)]
    assert goals[0] == goals[1]
    assert (first.tolerance, first.preset) == (pytest.approx(second.tolerance, abs=1e-12), second.preset)


@pytest.mark.parametrize("preset", ["published", "clear"])
@pytest.mark.parametrize("path", PUZZLES, ids=lambda path: path.stem)
def test_the_puzzles_come_back_as_they_were(tmp_path: Path, path: Path, preset: str):
    """To the nanometre, with names, tolerance and preset, so that their plans stay valid."""
    scene = with_preset(read_scene(path), preset)
    made = round_trip(scene, tmp_path)
    assert made.geometry_hash == scene.geometry_hash
    assert made.preset == preset
    assert [wall.name for wall in made.walls] == [wall.name for wall in scene.walls]


@pytest.mark.skipif(not AUTHORS, reason="the authors' scenes are not beside the checkout")
@pytest.mark.parametrize("path", AUTHORS, ids=lambda path: path.stem)
def test_the_authors_files_come_back_as_they_were(tmp_path: Path, path: Path):
    """What was read from a file of the engine and written again is the same scene."""
    scene = read_scene(path)
    made = round_trip(scene, tmp_path)
    assert made.geometry_hash == scene.geometry_hash
    assert [body.color for body in made.objects] == [body.color for body in scene.objects]


@settings(max_examples=40, suppress_health_check=[HealthCheck.filter_too_much, HealthCheck.too_slow])
@given(scene=...)
def test_any_scene_comes_back_or_is_refused(tmp_path_factory: pytest.TempPathFactory, scene: Scene):
    """Discs, capsules, polygons and boxes in any direction; what is lower than its edges are round is refused."""
    bodies = (*scene.walls, *scene.objects)
    # Between no radius and one of a micrometre the file cannot tell.
    assume(all(part.edge_radius == 0 or part.edge_radius > 2 * SHARP for body in bodies for part in body.parts))
    too_round = [
        body.name
        for body in bodies
        for part in body.parts
        if len(part.core) > 1 and body.height <= 2 * (part.edge_radius + SHARP)
    ]
    folder = tmp_path_factory.getbasetemp()
    if too_round:
        with pytest.raises(InputError, match=re.escape(f"{too_round[0]}: height")):
            round_trip(scene, folder)
    else:
        assert_same(scene, round_trip(scene, folder))


def with_walls(scene: Scene, *parts: Part, yaw: float = 0.0) -> Scene:
    """A scene with one wall of these parts, half a metre high."""
    return replace(scene, walls=(Body("wall", np.array([1.0, -1.0, 0.25]), 0.5, parts, yaw),))


def test_each_kind_of_part_has_its_shape(small_room: Scene):
    """Sharp and rounded boxes, discs, and polygons as swept cores."""
    triangle = np.array([[-0.2, 0.0], [0.2, 0.0], [0.0, 0.3]])
    for part, expected in (
        (Part.box((0.4, 0.2)), "shape:box, size:[0.4 0.2 0.5]"),
        (Part.box((0.4, 0.2), 0.02), "shape:ssBox, size:[0.4 0.2 0.5 0.02]"),
        (Part(np.zeros((1, 2)), 0.3), "shape:ssCylinder, size:[0.5 0.3 0.02]"),
        (Part(triangle, 0.05), "shape:ssCvx, core:[-0.2 0 -0.2 0.2 0 -0.2 0 0.3 -0.2 -0.2 0 0.2"),
    ):
        (line,) = [line for line in rai_g_text(with_walls(small_room, part)).splitlines() if line.startswith("wall")]
        assert expected in line


def test_parts_of_a_wall_become_walls_and_those_of_an_object_stay(tmp_path: Path, small_room: Scene):
    """Parts are frames below that of their body."""
    shape = (Part.box((0.4, 0.2)), Part(Part.box((0.2, 0.2)).core + np.array([0.1, 0.2])))
    scene = with_walls(small_room, *shape, yaw=0.3)
    objects = (replace(small_room.objects[0], parts=shape, yaw=-1.0), *small_room.objects[1:])
    made = round_trip(replace(scene, objects=objects), tmp_path)
    assert [wall.name for wall in made.walls] == ["wall_1", "wall_2"]
    assert [len(body.parts) for body in made.objects] == [2, 1]
    assert_same(replace(scene, objects=objects), made)


def test_names_that_mean_something_else_are_changed(tmp_path: Path, small_room: Scene):
    """An object may be called as a frame of the format, or hold brackets; the goal-object is found again."""
    objects = tuple(replace(body, name=name) for body, name in zip(small_room.objects, ["floor", "a{b}"], strict=True))
    scene = replace(small_room, objects=objects, goal=replace(small_room.goal, object="a{b}"))
    made = round_trip(scene, tmp_path)
    assert made.object_names == ["floor_2", "a_b_"]
    assert made.goal.object == "a_b_"
    assert_same(scene, made)


def test_bounds_need_not_be_about_the_origin(tmp_path: Path, small_room: Scene):
    """The floor is where the room is."""
    scene = replace(
        small_room,
        bounds=np.array([[-3.0, -2.0], [2.0, 9.0]]),
        goal=Goal("obj", np.array([1.5, 8.0]), np.array([0.3, 0.2])),
    )
    assert_same(scene, round_trip(scene, tmp_path))


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        (("tolerance:0.001", "tolerance:-1"), "line 3: floor: tolerance must be from 0 to 10000 m"),
        (("tolerance:0.001", "tolerance:loose"), "line 3: floor: tolerance needs 1 numbers, found 'loose'"),
        (("tolerance:0.001", "tolerance:0.001 preset:wide"), "line 3: floor: preset must be one of clear, published"),
        (("object:obj", "object:box"), "line 6: goal: object 'box' is none of the objects (obj, obstacle)"),
        (("core:[", "cores:["), "line 7: wall: core needs a list of points x y z"),
        (("core:[-0.2", "core:["), "line 7: wall: core needs a list of points x y z"),
        (
            ("core:[-0.2", "core:[-0.3"),
            "line 7: wall: the core must be an upright prism about the middle of its height",
        ),
    ],
)
def test_what_is_wrong_in_a_written_file_is_named(
    tmp_path: Path, small_room: Scene, changed: tuple[str, str], message: str
):
    """File, line and field."""
    triangle = Part(np.array([[-0.2, 0.0], [0.2, 0.0], [0.0, 0.3]]), 0.05)
    text = rai_g_text(with_walls(small_room, triangle))
    assert changed[0] in text
    (tmp_path / "room.g").write_text(text.replace(changed[0], changed[1], 1))
    with pytest.raises(InputError, match=re.escape(f"room.g, {message}")):
        read_scene(tmp_path / "room.g")
