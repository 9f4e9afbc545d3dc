"""Configuration-space obstacles: free exactly where the bodies themselves do not overlap, and their tangent corners."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from converter.scene import NUMERIC_SLACK, Agent, Body
from converter.shape import FloatArray, Part
from planner.configuration_space import (
    ConfigurationSpace,
    ObstacleSet,
    agent_obstacles,
    body_obstacles,
    circumscribed,
    sight_obstacles,
)
from planner.penetration import Prism, deepest_contacts
from tests.planner.plain_geometry import clearance, points, polygons
from tests.planner.scenes import body, vectors

BOUNDS = vectors([-3, -3], [3, 3])
tolerances = st.sampled_from([0.0, 1e-4, 1e-3])
quickly = settings(max_examples=60, deadline=None)


@st.composite
def bodies(draw: st.DrawFn, name: str) -> Body:
    """Bodies of one or two parts, sharp or rounded, turned by any angle."""
    parts = [draw_part(draw) for _ in range(draw(st.integers(1, 2)))]
    x, y = draw(points)
    return body(name, x, y, *parts, yaw=draw(st.sampled_from([0.0, 0.3, -2.0])))


def draw_part(draw: st.DrawFn) -> Part:
    """A polygon, a capsule or a disc."""
    core = draw(polygons())
    return Part(core, draw(st.sampled_from([0.0, 0.02, 0.2])) if len(core) > 2 else 0.05)


def depth(mover: Body, path: FloatArray, other: Body) -> float:
    """Deepest penetration along `path` by the verifier's geometry; 0 if there is none."""
    contact = deepest_contacts(Prism.of_body(mover), path, [Prism.of_body(other)], 0.0).get(other.name)
    return 0.0 if contact is None else contact.depth


@quickly
@given(bodies("moving"), bodies("other"), points, points, tolerances)
def test_bodies_are_free_where_they_do_not_penetrate(
    moving: Body, other: Body, start: FloatArray, end: FloatArray, tolerance: float
):
    """A straight motion is free exactly if the bodies penetrate by no more than the tolerance on the way."""
    found = depth(moving, np.array([start, end]), other)
    assume(abs(found - tolerance) > 2 * NUMERIC_SLACK)
    obstacles = body_obstacles(moving, other, tolerance).moved(other.position[:2])
    assert ConfigurationSpace(obstacles, BOUNDS).segment_free(start, end) == (found < tolerance)


@quickly
@given(bodies("other"), points, points, tolerances)
def test_the_agent_is_free_where_it_does_not_penetrate(
    other: Body, start: FloatArray, end: FloatArray, tolerance: float
):
    """The same for the disc, whose radius adds to the edge radius."""
    obstacles = agent_obstacles(Agent(np.zeros(2), 0.2), other, tolerance).moved(other.position[:2])
    pairs = zip(other.cores, other.parts, strict=True)
    found = max(0.2 + part.edge_radius - clearance(start, end, core + other.position[:2]) for core, part in pairs)
    assume(abs(found - tolerance) > 2 * NUMERIC_SLACK)
    assert ConfigurationSpace(obstacles, BOUNDS).segment_free(start, end) == (found < tolerance)


@pytest.mark.parametrize("tolerance", [0.0, 1e-3])
def test_touching_bodies_are_free(tolerance: float):
    """Sharp boxes may touch and overlap by the tolerance, but not by 1e-8 m more."""
    obstacles = body_obstacles(body("a", 0, 0), body("b", 0, 0), tolerance)
    space = ConfigurationSpace(obstacles, BOUNDS)
    limit = 0.2 - tolerance
    assert space.points_free(vectors([limit, 0], [-limit, 0.1], [limit, limit], [0.1, -limit])).all()
    assert not space.points_free(vectors([limit - 1e-8, 0], [-limit + 1e-8, 0.1], [0, -limit + 1e-8])).any()


@pytest.mark.parametrize(
    ("z", "height", "blocks_agent", "blocks_object"),
    [
        (0.1, 0.2, True, True),
        (0.3, 0.2, False, False),  # stands on the height of both
        (0.25, 0.2, True, True),  # hangs 5 cm into both
        (-0.1, 0.2, False, False),  # sunk into the floor
    ],
)
def test_height_intervals_have_to_overlap(z: float, height: float, *, blocks_agent: bool, blocks_object: bool):
    """Bodies above or below each other do not meet, and neither do those whose faces touch."""
    other = Body("other", np.array([0.0, 0.0, z]), height, (Part.box((1.0, 1.0)),))
    assert len(agent_obstacles(Agent(np.zeros(2), 0.2, 0.2), other, 0.0)) == blocks_agent
    assert len(body_obstacles(body("moving", 0, 0), other, 0.0)) == blocks_object


def test_a_bridge_stops_the_tall_object_only():
    """Under a wall that begins at 0.25 m the agent of 0.2 m passes and an object of 0.3 m does not."""
    bridge = Body("bridge", np.array([0.0, 0.0, 0.35]), 0.2, (Part.box((1.0, 1.0)),))
    tall = Body("tall", np.array([0.0, 0.0, 0.15]), 0.3, (Part.box((0.2, 0.2)),))
    assert len(agent_obstacles(Agent(np.zeros(2), 0.2, 0.2), bridge, 0.0)) == 0
    assert len(body_obstacles(tall, bridge, 0.0)) == 1


def test_sight_ignores_height_and_allows_touching():
    """A line along the edge of a body passes, and one through its rounded corner does not."""
    obstacles = sight_obstacles(body("box", 0, 0, Part.box((0.4, 0.4), 0.05)), 0.0)
    space = ConfigurationSpace(obstacles, BOUNDS)
    assert space.segment_free(*vectors([-1, 0.2], [1, 0.2]))
    assert not space.segment_free(*vectors([-1, 0.2 - 1e-8], [1, 0.2 - 1e-8]))
    # The corner's arc about (0.15, 0.15) leaves the diagonal 0.05 (sqrt 2 - 1) free.
    across = 0.3 + 0.05 * np.sqrt(2)
    assert space.segment_free(*vectors([across, 0], [0, across]))
    assert not space.segment_free(*vectors([across - 1e-7, 0], [0, across - 1e-7]))


@settings(deadline=None)
@given(polygons(), st.one_of(st.just(0.2 - NUMERIC_SLACK), st.floats(1e-4, 0.5)))
def test_corners_form_a_tight_polygon_around_rounded_obstacles(polygon: FloatArray, rho: float):
    """The corners' edges touch the inflated polygon from outside; each corner stands off by at most 2 % of the radius."""
    corners = circumscribed(polygon, rho)
    following = np.roll(corners, -1, axis=0)
    gaps = [clearance(a, b, polygon) - rho for a, b in zip(corners, following, strict=True)]
    assert np.array(gaps) == pytest.approx(NUMERIC_SLACK / 2, abs=NUMERIC_SLACK / 4)
    reaches = np.array([clearance(corner, corner, polygon) for corner in corners])
    assert (reaches <= 1.02 * (rho + NUMERIC_SLACK)).all()


@settings(deadline=None)
@given(polygons(3), st.floats(-2e-3, 0.0))
def test_corners_of_sharp_obstacles_are_their_vertices(polygon: FloatArray, rho: float):
    """Without a radius each vertex has one corner, half a slack outside both edges moved inward by the tolerance."""
    corners = circumscribed(polygon, rho)
    assert len(corners) == len(polygon)
    for before, corner, vertex, after in zip(
        np.roll(polygon, 1, axis=0), corners, polygon, np.roll(polygon, -1, axis=0), strict=True
    ):
        for tail, head in [(before, vertex), (vertex, after)]:
            edge = (head - tail) / np.hypot(*(head - tail))
            height = np.array([edge[1], -edge[0]]) @ (corner - vertex)
            assert height == pytest.approx(rho + NUMERIC_SLACK / 2, abs=NUMERIC_SLACK / 4)


@settings(deadline=None)
@given(polygons(), st.sampled_from([-1e-3, -1e-9, 0.02, 0.2]))
def test_tangents_meet_in_their_corner(polygon: FloatArray, rho: float):
    """Both lines through a corner touch the inflated polygon, from outside and half a slack away, and do not agree."""
    assume(rho > 0 or len(polygon) >= 3)
    obstacles = ObstacleSet.of([polygon], [rho]).moved(np.array([1.0, -2.0]))
    normals = obstacles.normals.reshape(-1, 2, 2)
    normals = normals / np.sqrt((normals**2).sum(axis=2))[:, :, None]
    heights = (normals[:, :, None] * (obstacles.vertices - obstacles.corners[:, None, None])).sum(axis=3).max(axis=2)
    np.testing.assert_allclose(heights, -rho - NUMERIC_SLACK / 2, atol=1e-12)
    turns = normals[:, 0, 0] * normals[:, 1, 1] - normals[:, 0, 1] * normals[:, 1, 0]
    assert (turns > 0).all()


def test_a_disc_has_corners_all_around():
    """A disc's corners are a regular polygon of 16 sides."""
    corners = circumscribed(np.array([[1.0, 2.0]]), 0.2)
    np.testing.assert_allclose(np.hypot(*(corners - [1, 2]).T), 0.2 / np.cos(np.pi / 16), rtol=1e-8)
    assert len(corners) == 16


def test_union_and_moved_keep_every_obstacle():
    """A union is met where a member is; moving the obstacles moves their boxes and corners along."""
    first = ObstacleSet.of([np.array([[0.0, 0.0]]), vectors([-1, -1], [-0.5, -1], [-0.5, 0])], [0.2, 0.0])
    second = ObstacleSet.of([vectors([1, 1], [2, 1])], [0.1])
    total = ObstacleSet.union([first, ObstacleSet.of([], []), second])
    assert (len(first), len(second), len(total)) == (2, 1, 3)
    draws = np.random.default_rng(0).uniform(-3, 3, (500, 2))
    both = [ConfigurationSpace(one, BOUNDS).points_free(draws) for one in (first, second)]
    np.testing.assert_array_equal(ConfigurationSpace(total, BOUNDS).points_free(draws), both[0] & both[1])
    by = np.array([0.5, -0.25])
    there = ConfigurationSpace(total.moved(by), BOUNDS + by)
    np.testing.assert_array_equal(there.points_free(draws + by), both[0] & both[1])
    np.testing.assert_array_equal(total.moved(by).corners, total.corners + by)


def test_union_of_nothing_is_empty():
    """A room without walls has no obstacles."""
    nothing = ObstacleSet.union([])
    assert len(nothing) == 0
    assert ConfigurationSpace(nothing, BOUNDS).segment_free(*vectors([-3, -3], [3, 3]))


@settings(deadline=None)
@given(st.lists(polygons(), min_size=1, max_size=5), points, points)
def test_near_keeps_what_a_box_can_meet(cores: list[FloatArray], one: FloatArray, other: FloatArray):
    """Within the box the nearby obstacles forbid what all of them forbid."""
    obstacles = ObstacleSet.of(cores, [0.1] * len(cores))
    box = np.array([np.minimum(one, other), np.maximum(one, other)])
    near = obstacles.near(box)
    assert len(near) <= len(obstacles)
    inside = np.random.default_rng(0).uniform(*box, (200, 2))
    every, some = (ConfigurationSpace(each, BOUNDS).points_free(inside) for each in (obstacles, near))
    np.testing.assert_array_equal(every, some)


def test_bounds_are_closed():
    """A point on the border of the bounds is free, one outside is not; a path needs all of its points inside."""
    space = ConfigurationSpace(ObstacleSet.of([], []), BOUNDS)
    assert space.points_free(vectors([3, 3], [-3, 0], [3 + 1e-6, 0], [0, -4])).tolist() == [True, True, False, False]
    assert space.path_free(vectors([0, 0], [3, 0], [3, 3]))
    assert not space.path_free(vectors([0, 0], [3.1, 0], [3, 3]))
    assert space.path_free(vectors([0, 0]))


def test_paths_are_free_if_every_piece_is():
    """A path around a wall is free, the one through it is not, though its way-points are."""
    space = ConfigurationSpace(ObstacleSet.of([vectors([-1, -1], [1, -1], [1, 1], [-1, 1])], [0.0]), BOUNDS)
    around = vectors([-2, 0], [-1, 1], [1, 1], [2, 0])
    assert space.path_free(around)
    assert not space.path_free(around[[0, 3]])
    assert space.segments_free(around[0], around[1:]).tolist() == [True, False, False]
    assert space.point_free(around[1])
    assert not space.point_free(np.zeros(2))


def test_free_corners_are_those_outside_other_obstacles():
    """Corners inside another obstacle of the set go, the obstacles stay."""
    squares = [vectors([0, 0], [1, 0], [1, 1], [0, 1]), vectors([0.5, 0.5], [2, 0.5], [2, 2], [0.5, 2])]
    obstacles = ObstacleSet.of(squares, [-NUMERIC_SLACK] * 2).with_free_corners()
    assert len(obstacles) == 2
    np.testing.assert_allclose(
        sorted(map(tuple, obstacles.corners)), [(0, 0), (0, 1), (0.5, 2), (1, 0), (2, 0.5), (2, 2)], atol=1e-8
    )
