import dataclasses

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from converter.convert import ConversionSettings, convert_level
from converter.preset import CLEAR, PRESETS, PUBLISHED, preset_named, with_preset, with_tolerance
from converter.scene import Body, Scene
from converter.shape import Part
from pcg.errors import InputError
from pcg.level import Level

NAMES = st.sampled_from(list(PRESETS))
SHAPES = st.tuples(st.integers(1, 12), st.integers(1, 12)).filter(lambda shape: shape[0] * shape[1] > 3)


def level(shape: tuple[int, int]) -> Level:
    """A level of this shape with a wall, if it is large enough."""
    tiles = np.zeros(shape, dtype=np.uint8)
    tiles.flat[:4] = [2, 3, 4, 1]
    return Level(tiles, goal_crate=tuple(divmod(1, shape[1])))


def walls_of(scene: Scene) -> dict[str, Body]:
    """Walls by name."""
    return {wall.name: wall for wall in scene.walls}


def inner_faces(scene: Scene) -> list[float]:
    """Where the inner faces of the right, back, left and front wall are [m]."""
    walls = walls_of(scene)
    faces = []
    for name, axis, side in (("right", 1, 1), ("back", 0, -1), ("left", 1, -1), ("front", 0, 1)):
        wall = walls[f"outwall_{name}"]
        (part,) = wall.parts
        faces.append(wall.position[axis] + side * (abs(part.core[:, axis]).max() + part.edge_radius))
    return faces


@given(SHAPES, NAMES, NAMES)
def test_a_preset_is_a_preset_wherever_the_scene_comes_from(shape: tuple[int, int], first: str, second: str):
    """Converting with a preset, and changing to it afterwards, give the same geometry, for rooms of any size."""
    direct = convert_level(level(shape), ConversionSettings(preset=second))
    changed = with_preset(convert_level(level(shape), ConversionSettings(preset=first)), second)
    assert changed.geometry_hash == direct.geometry_hash
    assert changed.preset == second


@given(SHAPES)
def test_inner_faces_of_the_outer_walls(shape: tuple[int, int]):
    """At the border of the grid in `clear`, 5 cm further in in `published`; the outer faces bound the floor in both."""
    half = 0.2 * np.array(shape)
    for name, overhang in (("clear", 0.0), ("published", 0.05)):
        scene = convert_level(level(shape), ConversionSettings(preset=name))
        y, x = half - overhang
        np.testing.assert_allclose(inner_faces(scene), [-y, x, y, -x], rtol=0, atol=1e-12)
        right = walls_of(scene)["outwall_right"]
        assert right.position[1] - np.ptp(right.cores[0], axis=0)[1] / 2 - right.parts[0].edge_radius == pytest.approx(
            scene.bounds[0, 1]
        )


def test_the_published_outer_walls_of_ten_by_ten_cells():
    """Boxes of 4.1 x 0.1 m centred 2 m from the middle, as in the authors' files."""
    walls = walls_of(convert_level(level((10, 10)), ConversionSettings(preset="published")))
    expected = {"right": (0, -2), "back": (2, 0), "left": (0, 2), "front": (-2, 0)}
    for name, (x, y) in expected.items():
        wall = walls[f"outwall_{name}"]
        np.testing.assert_allclose(wall.position, [x, y, 0.2], atol=1e-12)
        assert wall.parts[0].box_size == pytest.approx((4.1, 0.1) if x == 0 else (0.1, 4.1))
        assert wall.parts[0].edge_radius == 0.04


@settings(max_examples=40)
@given(st.from_type(Scene), NAMES)
def test_a_preset_is_idempotent_and_changes_nothing_else(scene: Scene, name: str):
    """Applied again it changes nothing; places, names, heights, goal, bounds and source stay."""
    once = with_preset(scene, name)
    assert with_preset(once, name).geometry_hash == once.geometry_hash
    assert (once.agent.radius, once.tolerance) == (PRESETS[name].agent_radius, PRESETS[name].tolerance)
    assert (once.name, once.source, once.goal, once.bounds.tolist()) == (
        scene.name,
        scene.source,
        scene.goal,
        scene.bounds.tolist(),
    )
    for changed, body in zip((*once.walls, *once.objects), (*scene.walls, *scene.objects), strict=True):
        np.testing.assert_array_equal(changed.position, body.position)
        assert (changed.name, changed.height, changed.yaw, changed.color) == (
            body.name,
            body.height,
            body.yaw,
            body.color,
        )


def with_walls(*walls: Body) -> Scene:
    """A scene with these walls and no preset."""
    return dataclasses.replace(convert_level(level((4, 4))), walls=walls, preset=None)


def wall(name: str, part: Part, y: float = -1.0) -> Body:
    """A wall of height 0.4 m."""
    return Body(name, np.array([0.0, y, 0.2]), 0.4, (part,))


def test_edge_radii_follow_the_names_of_walls():
    """Outer walls, wall cells and other walls have their own radii."""
    box = Part.box((1.0, 0.4))
    scene = with_preset(with_walls(wall("outwall_x", box), wall("block_1_1", box), wall("a", box)), "published")
    assert [body.parts[0].edge_radius for body in scene.walls] == [0.04, 0.01, 0.02]
    assert {body.parts[0].edge_radius for body in scene.objects} == {0.02}


def test_what_is_too_thin_or_round_keeps_its_shape():
    """A wall of 3 cm cannot have edges of 2 cm, and a pillar stays a pillar."""
    thin, pillar = wall("thin", Part.box((1.0, 0.03), 0.01)), wall("pillar", Part(np.zeros((1, 2)), 0.3))
    scene = with_preset(with_walls(thin, pillar), "published")
    assert [body.geometry for body in scene.walls] == [thin.geometry, pillar.geometry]
    sharp, still_round = with_preset(scene, "clear").walls
    assert sharp.parts[0].edge_radius == 0
    assert still_round.geometry == pillar.geometry


def test_outer_walls_of_an_unnamed_geometry_are_at_the_border():
    """Without a preset the inner faces are where they are: `clear` leaves them, `published` moves them in by 5 cm."""
    scene = with_walls(wall("outwall_right", Part.box((2.0, 0.3)), y=-1.15))
    for name, face in (("clear", -1.0), ("published", -0.95)):
        (changed,) = with_preset(scene, name).walls
        size = changed.parts[0].box_size
        assert size is not None
        assert changed.position[1] + size[1] / 2 == pytest.approx(face)
        assert changed.position[1] - size[1] / 2 == pytest.approx(-1.3)


def test_a_thin_outer_wall_moves_as_a_whole():
    """The inner face goes where the preset wants it, even if the wall is no thicker than the way there."""
    scene = dataclasses.replace(with_walls(wall("outwall_left", Part.box((2.0, 0.04)), y=0.97)), preset="published")
    (changed,) = with_preset(scene, "clear").walls
    assert changed.position[1] - 0.02 == pytest.approx(1.0)
    assert changed.parts[0].box_size == pytest.approx((2.0, 0.04))


def test_a_corridor_of_one_cell_has_the_stated_clearance():
    """12.5 mm on each side in `clear`, none in `published`."""
    assert 0.4 / 2 - CLEAR.agent_radius == pytest.approx(0.0125)
    assert 0.4 / 2 - PUBLISHED.agent_radius == 0


def filled(scene: Scene) -> shapely.Geometry:
    """What the blocks of a scene fill."""
    blocks = [wall for wall in scene.walls if wall.name.startswith("block_")]
    return shapely.union_all(
        [
            shapely.buffer(shapely.Polygon(core + wall.position[:2]), part.edge_radius, quad_segs=64)
            for wall in blocks
            for core, part in zip(wall.cores, wall.parts, strict=True)
        ]
    )


def test_merged_walls_differ_from_blocks_by_notches_only():
    """Rounded as one, walls fill the notches between rounded blocks, where the agent sinks in by less than the tolerance."""
    is_wall = np.array([[1, 1, 1, 0], [1, 1, 0, 0], [0, 0, 0, 1]], dtype=np.bool_)
    cells = Level.of(is_wall, players=[(2, 0)], crates=[(2, 1)], targets=[(2, 2)])
    merged = with_preset(convert_level(cells, ConversionSettings(merge_walls=True)), "published")
    blocks = convert_level(cells, ConversionSettings(preset="published"))
    assert sum(len(wall.parts) for wall in merged.walls) < sum(len(wall.parts) for wall in blocks.walls)
    whole, pieces = filled(merged), filled(blocks)
    assert whole.area > pieces.area
    assert whole.buffer(1e-6).contains(pieces)
    reach = PUBLISHED.agent_radius
    near = pieces.buffer(reach + PUBLISHED.tolerance, quad_segs=256)
    assert near.contains(whole.buffer(reach, quad_segs=256))


def test_an_unknown_preset_is_refused():
    """The message lists the presets."""
    with pytest.raises(InputError, match="'loose' is none of clear, published"):
        preset_named("loose")


def test_the_tolerance_can_be_changed_alone():
    """The preset keeps its name; a negative tolerance is refused."""
    scene = convert_level(level((3, 3)))
    assert (with_tolerance(scene, 0.01).tolerance, with_tolerance(scene, 0.01).preset) == (0.01, "clear")
    for tolerance in (-1e-3, float("nan")):
        with pytest.raises(InputError, match="tolerance"):
            with_tolerance(scene, tolerance)
