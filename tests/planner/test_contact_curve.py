"""Contact curves: exact touch, exact length, and every free stretch found."""

from collections.abc import Sequence

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from converter.scene import NUMERIC_SLACK, Agent, Body
from converter.shape import FloatArray, Part, rotation
from planner.configuration_space import ObstacleSet, agent_obstacles
from planner.contact_curve import END_MARGIN, ContactCurve
from planner.kernel import points_free
from tests.planner.plain_geometry import hull, points, polygons
from tests.planner.scenes import RADIUS, body, turned, vectors, wall

NOTHING = ObstacleSet.of([], [])
CROSS = (Part.box((0.6, 0.2), 0.02), Part.box((0.2, 0.6), 0.02))
L_SHAPE = (Part.box((0.6, 0.2), 0.02), Part(Part.box((0.2, 0.6), 0.02).core + np.array([0.2, 0.2]), 0.02))


def gaps(obj: Body, grasps: FloatArray) -> FloatArray:
    """Distance (n,) [m] between an agent at each of `grasps` (n, 2) and the object; negative where they overlap."""
    centres = shapely.points(grasps)
    to_parts = [
        shapely.distance(centres, hull(core)) - part.edge_radius - RADIUS
        for core, part in zip(obj.cores, obj.parts, strict=True)
    ]
    return np.min(to_parts, axis=0)


def round_or_sharp(core: FloatArray, edge_radius: float) -> Part:
    """The part; points and segments need a radius."""
    return Part(core, edge_radius if len(core) > 2 else edge_radius + 0.01)


def agent_obstacles_of(walls: Sequence[Body], tolerance: float = 0.0) -> ObstacleSet:
    """What `walls` forbid to the agent."""
    agent = Agent(np.zeros(2), RADIUS)
    return ObstacleSet.union([agent_obstacles(agent, one, tolerance).moved(one.position[:2]) for one in walls])


def free_grasps(curve: ContactCurve, obstacles: ObstacleSet, n: int = 400) -> FloatArray:
    """Places (k, 2) all along the free stretches."""
    stretches = curve.free_stretches(obstacles)
    shares = np.linspace(0.0, 1.0, max(2, n // max(1, len(stretches))))[1:-1]
    return curve.at((stretches[:, :1] + shares * (stretches[:, 1:] - stretches[:, :1])).ravel())


@settings(deadline=None)
@given(polygons(), st.sampled_from([0.0, 0.02, 0.1]), st.floats(-3, 3), points)
def test_every_place_on_the_curve_touches(core: FloatArray, edge_radius: float, yaw: float, position: FloatArray):
    """The gap is 0 all along the curve of a convex body, which is as long as the outline grown by the radii."""
    part = round_or_sharp(core, edge_radius)
    obj = body("obj", *position, part, yaw=yaw)
    curve = ContactCurve(obj, RADIUS)
    places = curve.at(np.linspace(0, curve.length, 200))
    assert np.abs(gaps(obj, places)).max() < 1e-12
    perimeter = float(np.hypot(*(np.roll(core, -1, axis=0) - core).T).sum())
    assert curve.length == pytest.approx(perimeter + 2 * np.pi * (RADIUS + part.edge_radius), abs=1e-12)
    assert np.hypot(*(places[0] - places[-1])) < 1e-12


@settings(deadline=None)
@given(polygons(3), st.floats(-3, 3))
def test_arc_length_is_distance_along_the_curve(core: FloatArray, yaw: float):
    """Small steps in the parameter are steps of that length in the plane, counter-clockwise around the object."""
    curve = ContactCurve(body("obj", 0, 0, Part(core), yaw=yaw), RADIUS)
    places = curve.at(np.linspace(0, curve.length, 4000))
    steps = np.hypot(*np.diff(places, axis=0).T)
    assert steps.sum() == pytest.approx(curve.length, rel=1e-5)
    assert steps.max() <= curve.length / 3999 + 1e-12
    x, y = places.T
    assert (x[:-1] * y[1:] - x[1:] * y[:-1]).sum() > 0


@settings(deadline=None)
@given(st.lists(st.integers(-9, 9), min_size=1, max_size=3, unique=True), st.floats(-3, 3))
def test_straight_angles_leave_the_curve_whole(along: list[int], yaw: float):
    """Vertices in the middle of an edge change nothing, at any angle."""
    middle = [[x / 100, -0.1] for x in sorted(along)]
    obj = body("obj", 0, 0, Part(vectors([-0.1, -0.1], *middle, [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1])), yaw=yaw)
    curve = ContactCurve(obj, RADIUS)
    assert np.abs(gaps(obj, curve.at(np.linspace(0, curve.length, 500)))).max() < 1e-12
    free = curve.free_stretches(NOTHING)
    assert (free[:, 1] - free[:, 0]).sum() == pytest.approx(0.8 + 2 * np.pi * RADIUS, abs=1e-9)


@pytest.mark.parametrize("parts", [CROSS, L_SHAPE])
@pytest.mark.parametrize("yaw", [0.0, 0.3, 2.0])
def test_compound_bodies_are_touched_from_outside_only(parts: tuple[Part, ...], yaw: float):
    """On the free stretches of an L-shape and a cross the gap is 0, all around."""
    obj = body("obj", 0.3, -0.2, *parts, yaw=yaw)
    grasps = free_grasps(ContactCurve(obj, RADIUS), NOTHING)
    assert np.abs(gaps(obj, grasps)).max() < 2 * NUMERIC_SLACK
    angles = np.sort(np.arctan2(*grasps.T))
    assert np.diff(angles, append=angles[0] + 2 * np.pi).max() < np.deg2rad(10)


@pytest.mark.parametrize("yaw", [0.0, 0.3, 2.0])
def test_length_of_a_compound_body(yaw: float):
    """The free stretches of a cross are as long as the outline of its parts grown by the radius."""
    obj = body("obj", 0, 0, *CROSS, yaw=yaw)
    stretches = ContactCurve(obj, RADIUS).free_stretches(NOTHING)
    grown = shapely.union_all([hull(core).buffer(RADIUS + 0.02, quad_segs=4000) for core in obj.cores])
    assert (stretches[:, 1] - stretches[:, 0]).sum() == pytest.approx(grown.length, rel=1e-6)


@settings(deadline=None, max_examples=60)
@given(
    polygons(),
    st.sampled_from([0.0, 0.02]),
    st.lists(st.tuples(polygons(), st.sampled_from([0.0, 0.05])), min_size=1, max_size=4),
    st.sampled_from([0.0, 1e-3]),
)
def test_free_stretches_are_exactly_the_free_places(
    core: FloatArray, edge_radius: float, others: list[tuple[FloatArray, float]], tolerance: float
):
    """Between the ends of the stretches all places are free, outside of them none is."""
    obj = body("obj", 0, 0, round_or_sharp(core, edge_radius))
    walls = [body(f"wall {i}", 0, 0, round_or_sharp(*part)) for i, part in enumerate(others)]
    obstacles = agent_obstacles_of(walls, tolerance)
    curve = ContactCurve(obj, RADIUS)
    stretches = curve.free_stretches(obstacles)
    lengths = np.linspace(0, curve.length, 1001)
    assume(len(stretches) == 0 or np.abs(lengths[:, np.newaxis] - stretches.ravel()).min() > 1e-7)
    inside = ((lengths[:, np.newaxis] > stretches[:, 0]) & (lengths[:, np.newaxis] < stretches[:, 1])).any(axis=1)
    np.testing.assert_array_equal(inside, points_free(curve.at(lengths), *obstacles.arrays))


@pytest.mark.parametrize("yaw", [0.0, 0.3, np.pi / 2, 2.5])
@pytest.mark.parametrize("edge_radius", [0.0, 0.05])
def test_a_single_grasp_in_a_passage_without_clearance_is_found(yaw: float, edge_radius: float):
    """In a corridor as wide as the agent, with tolerance 0, the object can be grasped from its two ends only."""
    obj = turned(body("obj", 0, 0, Part.box((0.3, 0.2), edge_radius)), yaw)
    sides = [turned(wall(0, sign * (RADIUS + 5), 10, 10), yaw) for sign in (1, -1)]
    obstacles = agent_obstacles_of(sides)
    grasps = ContactCurve(obj, RADIUS).sample_free(12, obstacles, np.random.default_rng(0)) @ rotation(-yaw)
    assert set(np.sign(grasps[:, 0])) == {-1, 1}
    np.testing.assert_allclose(np.abs(grasps), np.tile([0.35, 0.0], (len(grasps), 1)), atol=1e-8)


def test_samples_are_spread_over_the_free_stretches():
    """In the open each of equal stretches holds one grasp, besides the two ends; with walls all grasps are free."""
    obj = body("obj", 0, 0)
    curve = ContactCurve(obj, RADIUS)
    n = 16
    grasps = curve.sample_free(n + 2, NOTHING, np.random.default_rng(0))
    grid = np.linspace(0, curve.length, 20_001)
    nearest = [int(np.hypot(*(curve.at(grid) - grasp).T).argmin()) for grasp in grasps]
    stretches = np.floor(grid[nearest] / curve.length * n).astype(int)
    assert set(range(n)) <= set(stretches)
    assert len(grasps) == n + 2
    assert list(stretches) != sorted(stretches)
    obstacles = agent_obstacles_of([wall(0.4, 0, 0.2, 2), wall(0, -0.31, 0.2, 0.2)])
    free = curve.sample_free(n, obstacles, np.random.default_rng(0))
    assert len(free) >= n
    assert points_free(free, *obstacles.arrays).all()
    assert np.abs(gaps(obj, free)).max() < 1e-12


def test_no_stretch_is_left_out():
    """Of many short free stretches each gives a grasp, even if there are more of them than grasps asked for."""
    posts = [
        body(f"post {i}", 0.9 * np.cos(i), 0.9 * np.sin(i), Part(np.zeros((1, 2)), 0.4))
        for i in np.arange(6) * np.pi / 3
    ]
    curve = ContactCurve(body("obj", 0, 0, Part(np.zeros((1, 2)), 0.15)), RADIUS)
    obstacles = agent_obstacles_of(posts)
    stretches = curve.free_stretches(obstacles)
    grasps = curve.sample_free(2, obstacles, np.random.default_rng(0))
    places = [curve.at(np.linspace(*stretch, 50)) for stretch in stretches]
    assert len(stretches) >= 6
    assert all(min(np.hypot(*(grasp - place).T).min() for grasp in grasps) < 0.01 for place in places)


def test_both_ends_of_a_stretch_are_among_the_samples():
    """In a nook the agent grasps where it touches the one wall and where it touches the other."""
    obstacles = agent_obstacles_of([wall(-0.6, 0, 0.2, 4), wall(0, 0.5, 4, 0.2)])
    curve = ContactCurve(body("obj", -0.4, 0.3), RADIUS)
    moved = obstacles.moved(np.array([0.4, -0.3]))
    ends = curve.at(curve.free_stretches(moved).ravel())
    grasps = curve.sample_free(6, moved, np.random.default_rng(0))
    assert len(ends) == 2
    assert all(np.hypot(*(grasps - end).T).min() < 2 * END_MARGIN for end in ends)


def test_an_enclosed_object_has_no_grasp():
    """Where every place on the curve is blocked there is nothing to sample."""
    pen = agent_obstacles_of([wall(0.2, 0, 0.2, 1), wall(-0.2, 0, 0.2, 1), wall(0, 0.2, 1, 0.2), wall(0, -0.2, 1, 0.2)])
    curve = ContactCurve(body("obj", 0, 0), RADIUS)
    assert curve.free_stretches(pen).shape == (0, 2)
    assert curve.sample_free(12, pen, np.random.default_rng(0)).shape == (0, 2)
