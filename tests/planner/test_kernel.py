"""The kernel: agreement with plain twins, exact touching, symmetries, thin and degenerate cores."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from converter.shape import FloatArray
from planner.configuration_space import ObstacleSet
from planner.kernel import joined, points_free, points_free_within, segment_free, segment_hits_polygon, segments_free
from tests.planner.plain_geometry import clearance, meets_interior, points, polygons

BAND = 1e-9
radii = st.one_of(st.sampled_from([-1e-3, -1e-9, 0.2 - 1e-9, 0.22]), st.floats(-0.1, 0.5))
integer_points = st.tuples(st.integers(-6, 6), st.integers(-6, 6)).map(lambda p: np.array(p, dtype=float))
exactly = settings(max_examples=300, deadline=None)


def hits(a: FloatArray, b: FloatArray, polygon: FloatArray, rho: float) -> bool:
    """The kernel's answer for two points; the rows before and after the polygon's are none of its own."""
    vertices = np.vstack([[0.0, 0.0], polygon, [0.1, 0.0]])
    return bool(segment_hits_polygon(a[0], a[1], b[0], b[1], vertices, 1, len(polygon) + 1, rho))


@exactly
@given(points, points, polygons(), radii)
def test_agrees_with_the_plain_distance(a: FloatArray, b: FloatArray, polygon: FloatArray, rho: float):
    """Outside the slack a segment hits exactly if its least signed distance is below the radius."""
    distance = clearance(a, b, polygon)
    assume(abs(distance - rho) > BAND)
    assert hits(a, b, polygon, rho) == (distance < rho)


@exactly
@given(points, points, polygons())
def test_is_exact_to_the_numeric_slack(a: FloatArray, b: FloatArray, polygon: FloatArray):
    """With a radius of its own distance a segment is free with the slack below it and hits with the slack above."""
    distance = clearance(a, b, polygon)
    # With one or two vertices there is no inside, so nothing is nearer than 0.
    assert not hits(a, b, polygon, distance - BAND)
    assert hits(a, b, polygon, distance + BAND)


@exactly
@given(integer_points, integer_points, st.lists(integer_points, min_size=3, max_size=8))
def test_touching_is_free_without_any_slack(a: FloatArray, b: FloatArray, cloud: list[FloatArray]):
    """With small integers the test for radius 0 is that of exact rational arithmetic, touching included."""
    polygon = convex_hull(cloud)
    assume(len(polygon) >= 3)
    assert hits(a, b, polygon, 0.0) == meets_interior(a, b, polygon)


def convex_hull(cloud: list[FloatArray]) -> FloatArray:
    """Counter-clockwise corners of the hull of integer points, without straight angles (Andrew 1979)."""
    ordered = sorted({(float(x), float(y)) for x, y in cloud})

    def chain(places: list[tuple[float, float]]) -> list[tuple[float, float]]:
        kept: list[tuple[float, float]] = []
        for x, y in places:
            while len(kept) > 1 and (kept[-1][0] - kept[-2][0]) * (y - kept[-2][1]) <= (kept[-1][1] - kept[-2][1]) * (
                x - kept[-2][0]
            ):
                kept.pop()
            kept.append((x, y))
        return kept[:-1]

    return np.array(chain(ordered) + chain(ordered[::-1])).reshape(-1, 2)


@settings(deadline=None)
@given(points, points, polygons(), radii)
def test_turning_mirroring_and_reversing_change_nothing(a: FloatArray, b: FloatArray, polygon: FloatArray, rho: float):
    """A quarter turn, a mirror image, the way back and another first vertex give the same answer."""
    assume(abs(clearance(a, b, polygon) - rho) > BAND)
    answer = hits(a, b, polygon, rho)
    quarter, mirror = np.array([[0.0, 1.0], [-1.0, 0.0]]), np.array([1.0, -1.0])
    assert hits(a @ quarter, b @ quarter, polygon @ quarter, rho) == answer
    assert hits(a * mirror, b * mirror, (polygon * mirror)[::-1], rho) == answer
    assert hits(b, a, polygon, rho) == answer
    assert hits(a, b, np.roll(polygon, 1, axis=0), rho) == answer


@settings(deadline=None)
@given(points, points, st.integers(0, 1000).map(lambda k: k / 1000), polygons(), radii)
def test_a_segment_hits_if_one_of_its_pieces_does(
    a: FloatArray, b: FloatArray, t: float, polygon: FloatArray, rho: float
):
    """Cutting a motion in two never changes whether it is free."""
    middle = a + t * (b - a)
    assume(all(abs(clearance(*ends, polygon) - rho) > BAND for ends in [(a, b), (a, middle), (middle, b)]))
    assert hits(a, b, polygon, rho) == (hits(a, middle, polygon, rho) or hits(middle, b, polygon, rho))


@settings(deadline=None)
@given(st.lists(st.tuples(polygons(), radii), max_size=4), st.lists(st.tuples(points, points), min_size=1, max_size=4))
def test_sets_are_met_where_a_member_is(
    members: list[tuple[FloatArray, float]], motions: list[tuple[FloatArray, FloatArray]]
):
    """Boxes around the obstacles spare work only; a point is a segment without length; arrays repeat the one test."""
    obstacles = ObstacleSet.of([polygon for polygon, _ in members], [rho for _, rho in members])
    starts, ends = (np.array(column) for column in zip(*motions, strict=True))
    expected = [not any(hits(a, b, polygon, rho) for polygon, rho in members) for a, b in motions]
    assert segments_free(starts, ends, *obstacles.arrays).tolist() == expected
    assert [segment_free(*a, *b, *obstacles.arrays) for a, b in motions] == expected
    at_rest = [not any(hits(a, a, polygon, rho) for polygon, rho in members) for a in starts]
    assert points_free(starts, *obstacles.arrays).tolist() == at_rest


SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


@pytest.mark.parametrize(
    ("a", "b", "rho", "expected"),
    [
        ((-2, 1), (2, 1), 0.0, False),  # slides along an edge
        ((-2, 0), (0, 2), 0.0, False),  # touches a corner
        ((-2, 0.5), (-1, 0.5), 0.0, False),  # ends on an edge
        ((-2, 0.5), (-0.999, 0.5), 0.0, True),
        ((0, 0), (0.5, 0), 0.0, True),  # lies inside
        ((0, 0), (0.5, 0), -1.0, False),  # the shrunk square is empty
        ((0, 0), (0, 0), -0.999, True),
        ((0.5, -2), (0.5, 2), -0.5, False),  # slides along the shrunk square
        ((0.4999, -2), (0.4999, 2), -0.5, True),
        ((-3, 1.5), (3, 1.5), 0.5, False),  # slides along the inflated square
        ((-3, 1.4999), (3, 1.4999), 0.5, True),
        ((0.25, 1.5), (0.25, 3), 0.5, False),  # starts on the inflated square
        ((0.25, 3), (0.25, 1.5), 0.5, False),  # ends on it
        ((0.25, 3), (0.25, 1.4999), 0.5, True),
        ((-3, 0), (3, 0), 0.5, True),  # crosses, with both ends and all corners far away
        ((1.3, 1.4), (1.3, 1.4), 0.5 - 1e-9, False),  # on the arc around a corner: 0.3, 0.4, 0.5
        ((1.29, 1.4), (1.29, 1.4), 0.5 - 1e-9, True),
        ((0, 0), (0, 0.1), 0.5, True),  # deep inside
    ],
)
def test_square(a: tuple[float, float], b: tuple[float, float], rho: float, expected: bool):  # noqa: FBT001  # a case
    """Sliding along and touching are free, crossing and lying inside are not, by shrunk and inflated squares."""
    assert hits(np.array(a, dtype=float), np.array(b, dtype=float), SQUARE, rho) == expected


@pytest.mark.parametrize("core", [[[0.0, 0.0]], [[0.0, -1.0], [0.0, 1.0]]])
@pytest.mark.parametrize("rho", [-0.1, 0.0])
def test_cores_without_area_vanish_without_radius(core: list[list[float]], rho: float):
    """A point and a segment have no interior: only their inflation stops anything."""
    crossing = np.array([-1.0, 0.0]), np.array([1.0, 0.0])
    assert not hits(*crossing, np.array(core), rho)
    assert hits(*crossing, np.array(core), 1e-9)


@settings(deadline=None)
@given(points, points, points, points)
def test_a_segment_has_no_interior_from_whatever_side(a: FloatArray, b: FloatArray, p: FloatArray, q: FloatArray):
    """Rounding finds no time inside a segment that is crossed at any angle."""
    assert not hits(a, b, np.array([p, q]), 0.0)


@pytest.mark.parametrize("width", [0.0, 5e-324, 1e-17, 1e-16, 1e-12])
@pytest.mark.parametrize("shift", [0.0, 1.0, -2.7])
def test_thin_cores_are_no_holes(width: float, shift: float):
    """A core thinner than rounding errors, whose vertices may merge, still stops what crosses its middle."""
    core = np.array([[shift - width, -1.0], [shift + width, -1.0], [shift + width, 1.0], [shift - width, 1.0]])
    assert hits(np.array([shift - 1, 0.1]), np.array([shift + 1, 0.3]), core, 0.2)
    assert hits(np.array([shift, 0.1]), np.array([shift, 0.3]), core, 0.2)
    assert not hits(np.array([shift + 0.2 + 1e-9, -2]), np.array([shift + 0.2 + 1e-9, 2]), core, 0.2)


@pytest.mark.parametrize("rho", [-0.1, 0.0, 0.1])
def test_merged_vertices_leave_the_polygon_whole(rho: float):
    """A vertex that rounding has put twice opens no way through the polygon."""
    doubled = SQUARE[[0, 1, 1, 2, 3, 3]]
    assert hits(np.array([-3.0, 0.2]), np.array([3.0, 0.1]), doubled, rho)
    assert hits(np.array([0.1, 0.2]), np.array([0.1, 0.2]), doubled, rho)
    assert not hits(np.array([-3.0, 1.2]), np.array([3.0, 1.2]), doubled, rho)


def test_all_vertices_in_one_place_are_a_point():
    """A polygon that has shrunk to a point by rounding is a disc, and nothing without a radius."""
    core = np.zeros((4, 2))
    assert not hits(np.array([1.0, 0.0]), np.array([1.0, 0.0]), core, 0.5)
    assert hits(np.array([0.4, 0.0]), np.array([0.4, 0.0]), core, 0.5)
    assert not hits(np.array([-1.0, 0.0]), np.array([1.0, 0.0]), core, 0.0)


@pytest.mark.parametrize("rho", [0.0, 1e-20, 1e-12, 1e-9])
def test_tiny_radii_make_no_hole_at_a_vertex(rho: float):
    """A segment that enters through a vertex is stopped, also if rounding puts that on neither side of the line."""
    triangle = np.array([[0.25, 0.5], [-0.125, 0.9330127], [-0.125, 0.0669873]])
    assert hits(np.array([0.4995, 0.5]), np.array([0.0, 0.5]), triangle, rho)


def test_bounds_are_closed():
    """A place on the border of the bounds is within them, one beyond any of the four sides is not."""
    bounds = np.array([[-2.0, -3.0], [4.0, 5.0]])
    border = np.array([[-2.0, 0.0], [4.0, 0.0], [0.0, -3.0], [0.0, 5.0]])
    beyond = border + 1e-12 * np.sign(border)
    for obstacles, free in ((ObstacleSet.of([], []), True), (ObstacleSet.of([8 * SQUARE], [0.0]), False)):
        assert points_free_within(border, bounds, *obstacles.arrays).tolist() == [free] * 4
        assert points_free_within(beyond, bounds, *obstacles.arrays).tolist() == [False] * 4


@pytest.mark.parametrize("x", [-5.0, 5.0])
@pytest.mark.parametrize("y", [-7.0, 7.0])
def test_obstacles_in_every_quadrant_are_met(x: float, y: float):
    """Wherever an obstacle lies, what crosses it is not free, and what passes any of its sides is."""
    centre, offsets = np.array([x, y]), np.array([[-2.0, 0.0], [2.0, 0.0], [0.0, -2.0], [0.0, 2.0]])
    arrays = ObstacleSet.of([SQUARE + centre], [0.5]).arrays
    middle, around = np.tile(centre, (4, 1)), offsets + centre
    beside = around + offsets[:, ::-1]
    assert segments_free(around, middle, *arrays).tolist() == [False] * 4
    assert segments_free(middle, around, *arrays).tolist() == [False] * 4
    assert segments_free(around, beside, *arrays).tolist() == [True] * 4
    assert points_free(np.vstack([middle[:1], around]), *arrays).tolist() == [False, *[True] * 4]


def test_joined_sets_are_their_members_moved():
    """A set joined with another one, translated, has the arrays of all members where they are then."""
    triangle, by = np.array([[0.0, 3.0], [2.0, 3.0], [0.0, 4.0]]), np.array([10.0, -20.0])
    two, three = [triangle, SQUARE], [SQUARE, triangle, SQUARE[:1]]
    found = joined(*ObstacleSet.of(two, [0.5, 0.0]).arrays, *ObstacleSet.of(three, [-0.1, 0.2, 0.3]).arrays, by)
    expected = ObstacleSet.of([*two, *(polygon + by for polygon in three)], [0.5, 0.0, -0.1, 0.2, 0.3])
    for array, wanted in zip(found, expected.arrays, strict=True):
        np.testing.assert_allclose(array, wanted, atol=1e-14)
