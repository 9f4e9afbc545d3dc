import dataclasses

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from converter.convert import convert_level
from converter.occlusion import body_blocks, occluded
from converter.scene import Agent, Body, Goal, Scene
from converter.shape import Part
from pcg.level import Level
from pcg.metrics import occluded as level_occluded


def scene(*others: Body, tall: bool = True) -> Scene:
    """Agent at (-1, 0), goal-object at (1, 0), and other bodies; these are walls if `tall`, else objects."""
    goal_object = Body("obj", np.array([1.0, 0.0, 0.1]), 0.2, (Part.box((0.2, 0.2)),))
    return Scene(
        name="test",
        bounds=np.array([[-2.0, -2.0], [2.0, 2.0]]),
        tolerance=0.0,
        agent=Agent(np.array([-1.0, 0.0]), 0.2),
        walls=others if tall else (),
        objects=(goal_object,) if tall else (goal_object, *others),
        goal=Goal("obj", np.zeros(2), np.ones(2)),
    )


def box(y: float, edge_radius: float = 0.0, z: float = 0.1) -> Body:
    """A box of 0.4 m with its middle at (0, y)."""
    return Body("box", np.array([0.0, y, z]), 0.2, (Part.box((0.4, 0.4), edge_radius),))


@pytest.mark.parametrize("tall", [True, False])
@pytest.mark.parametrize(
    ("y", "expected"), [(0.0, True), (0.199, True), (-0.199, True), (0.2, False), (-0.2, False), (0.3, False)]
)
def test_a_body_hides_what_its_interior_covers(y: float, expected: bool, tall: bool):  # noqa: FBT001  # pytest passes by name
    """Walls and other objects block; a line that only touches an edge is free."""
    assert occluded(scene(box(y), tall=tall)) is expected


def test_rounded_corners_hide_less():
    """A square that stands on its corner no longer reaches the line when the corner is rounded."""
    reach = 0.2 * np.sqrt(2)
    for edge_radius, expected in ((0.0, True), (0.1, False)):
        turned = dataclasses.replace(box(reach - 0.01, edge_radius), yaw=np.pi / 4)
        assert occluded(scene(turned)) is expected


def test_what_hangs_above_hides_nothing():
    """A beam above agent and object is not in the way."""
    assert not occluded(scene(box(0.0, z=0.3)))


@given(st.from_type(Body), *[st.floats(-4, 4)] * 4)
def test_agrees_with_shapely(body: Body, x1: float, y1: float, x2: float, y2: float):
    """The exact test agrees with buffered polygons wherever those can tell."""
    body = body.at(np.zeros(2))
    segment = shapely.LineString([(x1, y1), (x2, y2)])
    margins = [
        shapely.distance(shapely.convex_hull(shapely.MultiPoint(core)), segment) - part.edge_radius
        for core, part in zip(body.cores, body.parts, strict=True)
    ]
    depths = [
        shapely.intersection(shapely.convex_hull(shapely.MultiPoint(core)).buffer(part.edge_radius), segment).length
        for core, part in zip(body.cores, body.parts, strict=True)
    ]
    assume(min(margins) > 1e-6 or max(depths) > 1e-2)
    assert body_blocks(body, np.array([x1, y1]), np.array([x2, y2])) == (min(margins) <= 1e-6)


@given(st.integers(0, 2**32 - 1))
def test_levels_and_their_scenes_agree(seed: int):
    """With sharp edges and the default sizes the test on cells and the test on footprints are the same."""
    generator = np.random.default_rng(seed)
    tiles = (generator.random((6, 7)) < 0.15).astype(np.uint8)
    cells = generator.permutation(42)[:5]
    tiles.flat[cells] = [2, 3, 3, 3, 4]
    goal_crate = (int(cells[1]) // 7, int(cells[1]) % 7)
    level = Level(tiles, goal_crate=goal_crate)
    assert occluded(convert_level(level)) is level_occluded(level, goal_crate)
