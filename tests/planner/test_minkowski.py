"""Minkowski sums: the hull of all sums of vertices, with its area, order and minimal vertices."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from converter.shape import FloatArray, Part, rotation
from planner.minkowski import minkowski_sum
from tests.planner.plain_geometry import hull, polygons

EPSILON = 1e-12


def sums(p: FloatArray, q: FloatArray) -> FloatArray:
    """All sums of a vertex of one and a vertex of the other."""
    return np.asarray((p[:, np.newaxis] + q).reshape(-1, 2))


def area(polygon: FloatArray) -> float:
    """Signed area [m^2], positive if counter-clockwise."""
    x, y = polygon.T
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2)


def mixed_area(p: FloatArray, q: FloatArray) -> float:
    """Twice the mixed area: the heights of `q` over the edges of `p`, times their lengths."""
    edges = np.roll(p, -1, axis=0) - p
    outward = np.column_stack([edges[:, 1], -edges[:, 0]])
    return float((outward @ q.T).max(axis=1).sum())


@settings(deadline=None)
@given(polygons(), polygons())
def test_is_the_hull_of_all_sums(p: FloatArray, q: FloatArray):
    """The sum fills the hull of the sums of vertices, for points and segments too."""
    found, expected = hull(minkowski_sum(p, q)), hull(sums(p, q))
    assert shapely.hausdorff_distance(found, expected) < EPSILON


@settings(deadline=None)
@given(polygons(), polygons())
def test_vertices_are_counter_clockwise_corners(p: FloatArray, q: FloatArray):
    """No vertex repeats, the polygon turns left everywhere, and there are no more vertices than both have."""
    total = minkowski_sum(p, q)
    assert len(total) <= len(p) + len(q)
    assert len(np.unique(total, axis=0)) == len(total)
    if len(total) > 2:
        edges = np.roll(total, -1, axis=0) - total
        following = np.roll(edges, -1, axis=0)
        assert (edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0] > -EPSILON).all()
        assert area(total) > 0


@settings(deadline=None)
@given(polygons(3), polygons(3))
def test_area_is_that_of_both_and_the_mixed_one(p: FloatArray, q: FloatArray):
    """|P + Q| = |P| + |Q| + 2 V(P, Q), the mixed area counted from either side."""
    total = area(minkowski_sum(p, q))
    assert total == pytest.approx(area(p) + area(q) + mixed_area(p, q), abs=EPSILON)
    assert mixed_area(p, q) == pytest.approx(mixed_area(q, p), abs=EPSILON)


@settings(deadline=None)
@given(polygons(), polygons(), polygons())
def test_order_does_not_count(p: FloatArray, q: FloatArray, r: FloatArray):
    """The sum is commutative and associative."""
    assert shapely.hausdorff_distance(hull(minkowski_sum(p, q)), hull(minkowski_sum(q, p))) < EPSILON
    left, right = minkowski_sum(minkowski_sum(p, q), r), minkowski_sum(p, minkowski_sum(q, r))
    assert shapely.hausdorff_distance(hull(left), hull(right)) < EPSILON


@settings(deadline=None)
@given(st.floats(-10, 10), st.floats(-1e-15, 1e-15))
def test_parallel_edges_become_one(yaw: float, noise: float):
    """Two boxes at the same angle, up to rounding, sum to a box of four vertices, and two segments to one segment."""
    box, other = Part.box((0.4, 0.2)).core, Part.box((0.1, 0.6)).core
    total = minkowski_sum(box @ rotation(yaw), other @ rotation(yaw + noise))
    assert len(total) == 4
    assert shapely.hausdorff_distance(hull(total @ rotation(-yaw)), shapely.box(-0.25, -0.4, 0.25, 0.4)) < EPSILON
    segment = np.array([[-0.5, 0.0], [0.5, 0.0]])
    line = minkowski_sum(segment @ rotation(yaw), segment @ rotation(yaw + noise))
    assert len(line) == 2
    assert np.abs(line @ rotation(-yaw)) == pytest.approx(np.array([[1.0, 0.0], [1.0, 0.0]]), abs=EPSILON)


def test_square_and_triangle():
    """A worked case, whose edges come in the order of their directions."""
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    triangle = np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]])
    assert sorted(map(tuple, minkowski_sum(square, triangle))) == [(0, 0), (0, 3), (1, 3), (3, 0), (3, 1)]


def test_two_crossing_segments_make_a_parallelogram():
    """Bodies without area sum to one with area."""
    total = minkowski_sum(np.array([[0.0, 0.0], [2.0, 0.0]]), np.array([[0.0, 0.0], [1.0, 1.0]]))
    assert sorted(map(tuple, total)) == [(0, 0), (1, 1), (2, 0), (3, 1)]
    assert area(total) == 2


def test_adding_a_point_moves():
    """A point is the neutral element, moved to its place."""
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    point = np.array([[3.0, -2.0]])
    np.testing.assert_array_equal(minkowski_sum(square, point), square + point)
    np.testing.assert_array_equal(minkowski_sum(point, square), square + point)


@pytest.mark.parametrize("left", [0.0, -0.0])
@pytest.mark.parametrize("right", [0.0, -0.0])
def test_the_sign_of_zero_does_not_count(left: float, right: float):
    """An upper side at y = 0 runs to the left, whichever zeros its ends have."""
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, right], [-1.0, left]])
    triangle = np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]])
    assert sorted(map(tuple, minkowski_sum(square, triangle))) == [(-1, -1), (-1, 2), (1, 2), (3, -1), (3, 0)]
