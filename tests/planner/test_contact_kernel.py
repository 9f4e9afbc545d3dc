"""Crossings of a contact curve with the lines and circles of obstacles: pieces whose answers are known in closed form."""

import numpy as np
import pytest

from converter.shape import FloatArray, rotation
from planner.contact_kernel import crossings
from tests.planner.scenes import vectors

REACH = 0.5
UPWARD = np.array([[2.0, 0.5, -1.0, 0.0, REACH], [4.0, 0.5, 1.0, 0.0, REACH]])
"""The agent moves up from (1, -1) to (1, 1) along an edge to its left, from arc length 2 on."""
TURN = np.array([[1.0, 3.0, 4.0, 0.0, REACH], [1.0 + 2 * np.pi * REACH, 3.0, 4.0, 2 * np.pi, REACH]])
"""The agent goes once around the point (3, 4), counter-clockwise from the right, from arc length 1 on."""


@pytest.fixture(params=[0.0, 0.7, 2.5])
def yaw(request: pytest.FixtureRequest) -> float:
    """The angle [rad] by which curve and obstacles are turned about the origin; it changes no length."""
    return float(request.param)


def met(knots: FloatArray, *polygons: FloatArray, rho: float, yaw: float) -> list[float]:
    """The crossings in order."""
    turned = np.column_stack([knots[:, 0], knots[:, 1:3] @ rotation(yaw), knots[:, 3] + yaw, knots[:, 4]])
    first = np.cumsum([0, *map(len, polygons)])
    return sorted(crossings(turned, np.vstack(polygons) @ rotation(yaw), first, np.full(len(polygons), rho)).tolist())


def test_a_straight_piece_enters_and_leaves_a_disc(yaw: float):
    """The agent at (1, y) is 0.5 away from the point (1.3, 0.2) where y is 0.2 +- 0.4; from arcs it misses nothing."""
    assert met(UPWARD, vectors([1.3, 0.2]), rho=0.5, yaw=yaw) == pytest.approx([2.8, 3.6])
    assert met(UPWARD, vectors([0.7, 0.2]), rho=0.5, yaw=yaw) == pytest.approx([2.8, 3.6])
    # Only the end of the chord lies on the piece.
    assert met(UPWARD, vectors([1.3, -1.2]), rho=0.5, yaw=yaw) == pytest.approx([2.2])


def test_a_straight_piece_meets_the_offset_edges(yaw: float):
    """A box with rho is met at the lines of its upper and lower side; the two other sides are parallel."""
    box = vectors([-9, -0.3], [9, -0.3], [9, 0.4], [-9, 0.4])
    # Ends of the box are far from the piece, which still passes the four circles about its corners, at their heights.
    heights = [2.7, 2.7, 2.7, 2.7, 3.4, 3.4, 3.4, 3.4]
    assert met(UPWARD, box, rho=0.0, yaw=yaw) == pytest.approx([2.7, 3.4])
    assert met(UPWARD, box, rho=-0.1, yaw=yaw) == pytest.approx([2.8, 3.3])
    assert met(UPWARD, box, rho=0.25, yaw=yaw) == pytest.approx([2.45, *heights, 3.65])


def test_a_straight_piece_meets_a_sloping_edge(yaw: float):
    """The side from (2, 0) to (0, 1) is the line y = 1 - x / 2: at x = 1 it is met at 0.5, the base at 0."""
    triangle = vectors([0, 0], [2, 0], [0, 1])
    assert met(UPWARD, triangle, rho=0.0, yaw=yaw) == pytest.approx([3.0, 3.5])
    # Moved outward by sqrt(5) / 10 the line is at y = 0.75.
    found = met(UPWARD, triangle, rho=-np.sqrt(5) / 10, yaw=yaw)
    assert found == pytest.approx([3 + np.sqrt(5) / 10, 3.25])


def test_an_arc_enters_and_leaves_a_disc(yaw: float):
    """Around (3, 4) with radius 0.5 the point 0.6 to the right is 0.5 away at angles whose cosine is 0.6."""
    half = np.arccos(0.6)
    expected = [1 + REACH * half, 1 + REACH * (2 * np.pi - half)]
    assert met(TURN, vectors([3.6, 4]), rho=0.5, yaw=yaw) == pytest.approx(expected)
    above = [1 + REACH * (np.pi / 2 - half), 1 + REACH * (np.pi / 2 + half)]
    assert met(TURN, vectors([3, 4.6]), rho=0.5, yaw=yaw) == pytest.approx(above)
    assert met(TURN, vectors([3, 5.1]), rho=0.5, yaw=yaw) == []


def test_an_arc_meets_the_offset_edges(yaw: float):
    """The upper side of a box is met where the sine of the angle is 0.5, without the radius and with it."""
    low, high = np.pi / 6, np.pi * 5 / 6
    expected = pytest.approx([1 + REACH * low, 1 + REACH * high])
    for top, rho in ((4.25, 0.0), (4.35, -0.1)):
        box = vectors([-9, -9], [9, -9], [9, top], [-9, top])
        assert met(TURN, box, rho=rho, yaw=yaw) == expected
    assert met(TURN, vectors([-9, -9], [9, -9], [9, 4.15], [-9, 4.15]), rho=0.1, yaw=yaw) == expected


def test_an_arc_about_the_centre_of_a_disc_meets_nothing(yaw: float):
    """Concentric circles do not cross."""
    assert met(TURN, vectors([3, 4]), rho=0.2, yaw=yaw) == []


def test_crossings_of_all_pieces_and_obstacles_are_found(yaw: float):
    """Of a curve of two parts, side by side, each is tried against every obstacle."""
    knots = np.vstack([UPWARD, UPWARD + np.array([2, 2, 0, 0, 0])])
    found = met(knots, vectors([1.0, 0.0]), vectors([3.0, 0.5]), rho=0.25, yaw=yaw)
    # Besides, each part passes the other one's post at its height.
    assert found == pytest.approx([2.75, 3.25, 3.5, 3.5, 5.0, 5.0, 5.25, 5.75])


def test_an_arc_meets_every_line_and_circle_twice(yaw: float):
    """A box about the centre of the arc, 0.6 wide: its sides moved out lie at 0.45, its corners 0.3 sqrt(2) away."""
    box = vectors([2.7, 3.7], [3.3, 3.7], [3.3, 4.3], [2.7, 4.3])
    at_side = np.arccos(0.45 / REACH)
    at_corner = np.arccos((REACH**2 + 0.18 - 0.15**2) / (2 * REACH * np.sqrt(0.18)))
    angles = [k * np.pi / 4 + sign * (at_corner if k % 2 else at_side) for k in range(8) for sign in (-1, 1)]
    expected = sorted(1 + REACH * (angle % (2 * np.pi)) for angle in angles)
    assert met(TURN, box, rho=0.15, yaw=yaw) == pytest.approx(expected)


def test_the_place_of_a_curve_does_not_count(yaw: float):
    """Far from the origin, where coordinates exceed arc lengths, the same is met."""
    far = np.array([0.0, 20.0, 30.0, 0.0, 0.0])
    assert met(UPWARD + far, vectors([21.3, 30.2]), rho=0.5, yaw=yaw) == pytest.approx([2.8, 3.6])
    half = np.arccos(0.6)
    expected = [1 + REACH * half, 1 + REACH * (2 * np.pi - half)]
    assert met(TURN + far, vectors([23.6, 34.0]), rho=0.5, yaw=yaw) == pytest.approx(expected)
