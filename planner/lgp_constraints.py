"""The constraints and costs of switch configurations and trajectories, one a function, in CasADi.

Everything that moves here only translates, so each constraint is about the signed distance of one point to polygons
that are parameters: with x the reference point of the moving body relative to the other one's,

    clearance_k(x) = s_k(x) - rho_k,

where s_k is the signed distance to polygon k of a configuration-space obstacle and rho_k its radius
(`planner.configuration_space`). Polygons are packed into vectors of parameters whose length depends on their number
only: polygons with fewer vertices than the largest of their set repeat their last one.

The functions return plain distances and differences in metres; weights and scales belong to the problems.
"""

from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from converter.plan import TOUCH_SLACK
from converter.shape import FloatArray
from planner.configuration_space import ObstacleSet

FAR = 1e3
"""Stands for the distance to an edge without length [m]."""

MARGIN = 1e-6
"""Asked of every clearance beyond its bound [m], so that what the optimiser leaves violated is still free."""

TOUCH_GAP = TOUCH_SLACK / 2
"""Gap of a touching grasp [m], the middle of what a plan may have beside the tolerance."""


@dataclass(frozen=True)
class PolygonBlock:
    """How many polygons a set has, and how many vertices the largest of them."""

    polygons: int
    vertices: int

    @classmethod
    def of(cls, obstacles: ObstacleSet) -> "PolygonBlock":
        """The structure of an obstacle set."""
        return cls(len(obstacles), int(np.diff(obstacles.first).max(initial=1)))

    @property
    def size(self) -> int:
        """Numbers that describe such a set: vertices and radii."""
        return self.polygons * (2 * self.vertices + 1)

    def pack(self, obstacles: ObstacleSet) -> FloatArray:
        """The (size,) parameters of an obstacle set: all vertices, padded, then all radii."""
        counts = np.diff(obstacles.first)
        rows = obstacles.first[:-1, None] + np.minimum(np.arange(self.vertices), counts[:, None] - 1)
        return np.concatenate([obstacles.vertices[rows].ravel(), obstacles.rho])


@lru_cache(maxsize=32)
def signed_distance(vertices: int) -> ca.Function:
    """(point (2,), polygon (2, vertices)) -> signed distance [m], negative inside the counter-clockwise polygon."""
    point, polygon = ca.SX.sym("point", 2), ca.SX.sym("polygon", 2, vertices)
    inside, outside = ca.SX(-FAR), ca.SX(FAR**2)
    for i in range(vertices):
        a, b = polygon[:, i], polygon[:, (i + 1) % vertices]
        edge, offset = b - a, point - a
        squared = ca.sumsqr(edge)
        degenerate = squared < 1e-18
        safe = ca.if_else(degenerate, 1.0, squared)
        height = (edge[1] * offset[0] - edge[0] * offset[1]) / ca.sqrt(safe)
        t = ca.fmin(1, ca.fmax(0, ca.dot(offset, edge) / safe))
        inside = ca.fmax(inside, ca.if_else(degenerate, -FAR, height))
        outside = ca.fmin(outside, ca.sumsqr(offset - t * edge))
    # With one or two vertices there is no inside: the largest height is -FAR, or at least 0 but for rounding.
    is_inside = ca.logic_and(inside < -1e-12, inside > -FAR)
    # The small summand keeps the derivative finite on the outline.
    distance = ca.if_else(is_inside, inside, ca.sqrt(outside + 1e-20))
    # Polygons are parameters: nothing is differentiated by them.
    return ca.Function("signed_distance", [point, polygon], [distance], {"is_diff_in": [True, False]})


def clearances(points: ca.MX, block: PolygonBlock, packed: ca.MX) -> ca.MX:
    """(n * polygons,) signed distances of `points` (2, n) less the radii: all polygons of the first point first."""
    n = points.shape[1]
    if block.polygons == 0 or n == 0:
        return ca.MX(0, 1)
    n_coordinates = 2 * block.vertices * block.polygons
    polygons = ca.reshape(packed[:n_coordinates], 2, block.vertices * block.polygons)
    each = ca.kron(points, ca.DM.ones(1, block.polygons))
    distances = signed_distance(block.vertices).map(n * block.polygons)(each, ca.repmat(polygons, 1, n))
    return distances.T - ca.repmat(packed[n_coordinates:], n, 1)


def touch_gap(point: ca.MX, block: PolygonBlock, packed: ca.MX) -> ca.MX:
    """Gap between the agent and an object of several parts: 0 where it touches the nearest of them.

    Args:
        point: (2,) agent centre relative to the object's position.
        block: Structure of the object's cores.
        packed: Their parameters, with the radii at which the agent touches them.
    """
    return ca.mmin(clearances(point, block, packed))


def inside(points: ca.MX, lower: ca.MX, upper: ca.MX) -> ca.MX:
    """(4 n,) margins of `points` (2, n) in the rectangle from `lower` to `upper` (2,): not negative inside."""
    n = points.shape[1]
    return ca.vertcat(ca.vec(points - ca.repmat(lower, 1, n)), ca.vec(ca.repmat(upper, 1, n) - points))


def velocities(path: ca.MX, start: ca.MX) -> ca.MX:
    """(2 n,) steps between consecutive points of `path` (2, n), the first one from `start` (2,)."""
    return ca.vec(path - ca.horzcat(start, path[:, :-1]))


def accelerations(path: ca.MX, start: ca.MX) -> ca.MX:
    """(2 n,) second differences of `path` (2, n); before it the point rests at `start` (2,)."""
    steps = ca.reshape(velocities(path, start), 2, path.shape[1])
    return ca.vec(steps - ca.horzcat(ca.DM.zeros(2, 1), steps[:, :-1]))


def homing(points: ca.MX, home: ca.MX) -> ca.MX:
    """(2 n,) differences of `points` (2, n) from `home` (2,)."""
    return ca.vec(points - ca.repmat(home, 1, points.shape[1]))
