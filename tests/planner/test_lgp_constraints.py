"""Constraints and costs one by one: values by hand, and derivatives against finite differences."""

from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest

from converter.shape import FloatArray
from planner.configuration_space import ObstacleSet
from planner.lgp_constraints import (
    PolygonBlock,
    accelerations,
    clearances,
    homing,
    inside,
    signed_distance,
    touch_gap,
    velocities,
)
from tests.planner import plain_geometry
from tests.planner.scenes import vectors

SQUARE = vectors([-1, -1], [1, -1], [1, 1], [-1, 1])
TRIANGLE = vectors([3, 0], [4, 0], [3, 1])
OBSTACLES = ObstacleSet.of([SQUARE, TRIANGLE], [0.2, 0.1])
BLOCK = PolygonBlock.of(OBSTACLES)
PACKED = ca.DM(BLOCK.pack(OBSTACLES))

Constraint = Callable[[ca.MX], ca.MX]

CONSTRAINTS: dict[str, Constraint] = {
    "clearances": lambda points: clearances(points, BLOCK, PACKED),
    "touch_gap": lambda points: touch_gap(points[:, 0], BLOCK, PACKED),
    "inside": lambda points: inside(points, ca.MX([-1, -2]), ca.MX([3, 4])),
    "velocities": lambda points: velocities(points, ca.MX([1, 2])),
    "accelerations": lambda points: accelerations(points, ca.MX([1, 2])),
    "homing": lambda points: homing(points, ca.MX([1, 2])),
}


def at(constraint: Constraint, points: FloatArray) -> FloatArray:
    """The values of a constraint at `points` (n, 2)."""
    x = ca.MX.sym("x", 2, len(points))
    return np.array(ca.Function("f", [x], [constraint(x)])(points.T)).ravel()


@pytest.mark.parametrize("name", CONSTRAINTS)
@pytest.mark.parametrize("seed", range(5))
def test_derivatives_agree_with_finite_differences(name: str, seed: int):
    """The Jacobian is that of central differences, at random points inside and outside of the polygons."""
    points = np.random.default_rng(seed).uniform(-2, 4.5, 6)
    x = ca.MX.sym("x", 6)
    value = CONSTRAINTS[name](ca.reshape(x, 2, 3))
    f, jacobian = ca.Function("f", [x], [value]), ca.Function("j", [x], [ca.jacobian(value, x)])
    h = 1e-6
    differences = [np.array(f(points + h * e) - f(points - h * e)).ravel() / (2 * h) for e in np.eye(6)]
    np.testing.assert_allclose(np.array(jacobian(points)), np.column_stack(differences), atol=1e-7)


@pytest.mark.parametrize("vertices", [1, 2, 3, 6])
def test_signed_distance_agrees_with_its_plain_twin(vertices: int):
    """For points, segments and polygons, inside and outside."""
    rng = np.random.default_rng(vertices)
    angles = np.arange(vertices) * 2 * np.pi / max(vertices, 1)
    polygon = np.column_stack([np.cos(angles), np.sin(angles)]) * [1.5, 0.8]
    for point in rng.uniform(-2, 2, (40, 2)):
        found = float(signed_distance(vertices)(point, polygon.T))
        assert found == pytest.approx(plain_geometry.clearance(point, point, polygon), abs=1e-9)


def test_clearances_by_hand():
    """All polygons of the first point, then of the second; the triangle's padding with a fourth vertex is harmless."""
    found = at(CONSTRAINTS["clearances"], vectors([2.5, 0], [0, 0.5]))
    np.testing.assert_allclose(found, [1.5 - 0.2, 0.5 - 0.1, -0.5 - 0.2, 3 - 0.1], atol=1e-9)


def test_clearances_of_nothing_are_none():
    """No points or no polygons give no constraints."""
    nothing = ObstacleSet.of([], [])
    assert clearances(ca.MX(2, 3), PolygonBlock.of(nothing), ca.MX(0, 1)).shape == (0, 1)
    assert clearances(ca.MX(2, 0), BLOCK, PACKED).shape == (0, 1)


def test_touch_gap_is_that_of_the_nearest_part():
    """An object of two parts is touched at either, and the gap is negative where the agent overlaps one of them."""
    gaps = [at(CONSTRAINTS["touch_gap"], vectors(point))[0] for point in ([1.2, 0], [2.9, 0.5], [0.9, 0], [2, 0])]
    np.testing.assert_allclose(gaps, [0, 0, -0.3, 0.8], atol=1e-9)


def test_inside_by_hand():
    """Margins to the lower corner, point by point, then to the upper one; a point outside has a negative one."""
    found = at(CONSTRAINTS["inside"], vectors([0, 0], [4, 1]))
    np.testing.assert_allclose(found, [1, 2, 5, 3, 3, 4, -1, 3])


def test_differences_along_a_path_by_hand():
    """Velocities start at the start, accelerations at rest there; uniform motion then has none."""
    path = vectors([2, 2], [3, 2], [4, 3])
    np.testing.assert_allclose(at(CONSTRAINTS["velocities"], path), [1, 0, 1, 0, 1, 1])
    np.testing.assert_allclose(at(CONSTRAINTS["accelerations"], path), [1, 0, 0, 0, 0, 1])
    np.testing.assert_allclose(at(CONSTRAINTS["homing"], path), [1, 0, 2, 0, 3, 1])
