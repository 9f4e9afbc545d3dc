"""The one hot geometric test: a segment against convex polygons inflated by a radius.

An obstacle of configuration space is the open set {x : s(x) < rho}, where s is the signed distance to a convex core
polygon (negative inside) and rho the sum of the radii of the two bodies less the tolerance. With rho > 0 that is the
core inflated by a disc; with rho < 0 (sharp-edged bodies and a tolerance) the core shrunk by |rho|. Both are decided
in closed form, so no motion is ever checked by sampling points along it:

- rho <= 0: the segment a + t (b - a) is clipped by the half-planes n_i . x < c_i + rho (Cyrus and Beck 1978); it hits
  if an open interval of t is left.
- rho > 0: it hits if a vertex of one comes closer than rho to an edge of the other, or if it crosses the core's interior
  or one of its edges: a core as thin as rounding errors has no interior left.

Layout of an obstacle set of K polygons with M vertices in all, float64, world frame, [m]:
`vertices (M, 2)` counter-clockwise; `first (K + 1,)` int64, polygon k owns rows first[k] to first[k + 1] - 1;
`rho (K,)`; `boxes (K, 4)` x_min, y_min, x_max, y_max of the inflated polygon.
"""

import math

import numpy as np
import numpy.typing as npt
from numba import njit

from converter.shape import FloatArray

IntArray = npt.NDArray[np.int64]
BoolArray = npt.NDArray[np.bool_]


@njit(cache=True)
def _crosses_core(
    ax: float, ay: float, bx: float, by: float, vertices: FloatArray, begin: int, end: int, rho: float
) -> bool:
    """Whether the segment meets the interior of a polygon with its edges moved outward by `rho` (<= 0)."""
    has_interior = False
    enter, leave = 0.0, 1.0
    dx, dy = bx - ax, by - ay
    for i in range(begin, end):
        j = i + 1 if i + 1 < end else begin
        px, py, qx, qy = vertices[i, 0], vertices[i, 1], vertices[j, 0], vertices[j, 1]
        nx, ny = qy - py, px - qx
        if nx == 0.0 and ny == 0.0:
            # Rounding has merged two vertices of a moved polygon.
            continue
        has_interior = end - begin > 2
        slack = nx * (px - ax) + ny * (py - ay)
        if rho != 0.0:
            slack += rho * math.sqrt(nx * nx + ny * ny)
        speed = nx * dx + ny * dy
        if speed == 0.0:
            if slack <= 0.0:
                return False
        elif speed > 0.0:
            leave = min(leave, slack / speed)
        else:
            enter = max(enter, slack / speed)
        if enter >= leave:
            return False
    return has_interior


@njit(cache=True)
def _squared_distance(px: float, py: float, ax: float, ay: float, dx: float, dy: float, dd: float) -> float:
    """Squared distance of the point p to the segment a + t d, t in [0, 1], where dd = d . d."""
    ex, ey = px - ax, py - ay
    if dd > 0.0:
        t = min(1.0, max(0.0, (ex * dx + ey * dy) / dd))
        ex -= t * dx
        ey -= t * dy
    return ex * ex + ey * ey


@njit(cache=True)
def _segments_cross(ax: float, ay: float, bx: float, by: float, px: float, py: float, qx: float, qy: float) -> bool:
    """Whether the segments a b and p q cross in a point that is an end of neither."""
    of_p = (bx - ax) * (py - ay) - (by - ay) * (px - ax)
    of_q = (bx - ax) * (qy - ay) - (by - ay) * (qx - ax)
    of_a = (qx - px) * (ay - py) - (qy - py) * (ax - px)
    of_b = (qx - px) * (by - py) - (qy - py) * (bx - px)
    return bool(of_p * of_q < 0.0 and of_a * of_b < 0.0)


@njit(cache=True)
def segment_hits_polygon(
    ax: float, ay: float, bx: float, by: float, vertices: FloatArray, begin: int, end: int, rho: float
) -> bool:
    """Whether some point of the segment from a to b has a signed distance below `rho` to a polygon.

    The polygon is rows `begin` to `end` - 1 of `vertices`: a slice of the array would cost a third of the time.
    """
    if rho <= 0.0:
        return _crosses_core(ax, ay, bx, by, vertices, begin, end, rho)
    limit = rho * rho
    dx, dy = bx - ax, by - ay
    dd = dx * dx + dy * dy
    for i in range(begin, end):
        j = i + 1 if i + 1 < end else begin
        px, py, qx, qy = vertices[i, 0], vertices[i, 1], vertices[j, 0], vertices[j, 1]
        if _squared_distance(px, py, ax, ay, dx, dy, dd) < limit:
            return True
        ex, ey = qx - px, qy - py
        ee = ex * ex + ey * ey
        if _squared_distance(ax, ay, px, py, ex, ey, ee) < limit:
            return True
        if _squared_distance(bx, by, px, py, ex, ey, ee) < limit:
            return True
        if _segments_cross(ax, ay, bx, by, px, py, qx, qy):
            return True
    return _crosses_core(ax, ay, bx, by, vertices, begin, end, 0.0)


@njit(cache=True)
def segment_free(
    ax: float,
    ay: float,
    bx: float,
    by: float,
    vertices: FloatArray,
    first: IntArray,
    rho: FloatArray,
    boxes: FloatArray,
) -> bool:
    """Whether the segment from a to b meets no obstacle of the set; a point is a segment with a = b."""
    x_min, x_max = min(ax, bx), max(ax, bx)
    y_min, y_max = min(ay, by), max(ay, by)
    for k in range(len(rho)):
        if x_max <= boxes[k, 0] or y_max <= boxes[k, 1] or x_min >= boxes[k, 2] or y_min >= boxes[k, 3]:
            continue
        if segment_hits_polygon(ax, ay, bx, by, vertices, first[k], first[k + 1], rho[k]):
            return False
    return True


@njit(cache=True)
def joined(
    vertices: FloatArray,
    first: IntArray,
    rho: FloatArray,
    boxes: FloatArray,
    more_vertices: FloatArray,
    more_first: IntArray,
    more_rho: FloatArray,
    more_boxes: FloatArray,
    by: FloatArray,
) -> tuple[FloatArray, IntArray, FloatArray, FloatArray]:
    """An obstacle set and another one translated by the vector `by` (2,) [m]."""
    n, m = len(rho), len(vertices)
    all_vertices = np.empty((m + len(more_vertices), 2))
    all_vertices[:m] = vertices
    all_vertices[m:] = more_vertices + by
    all_first = np.empty(n + len(more_rho) + 1, np.int64)
    all_first[: n + 1] = first
    all_first[n:] = more_first + m
    all_boxes = np.empty((n + len(more_rho), 4))
    all_boxes[:n] = boxes
    all_boxes[n:, :2] = more_boxes[:, :2] + by
    all_boxes[n:, 2:] = more_boxes[:, 2:] + by
    return all_vertices, all_first, np.concatenate((rho, more_rho)), all_boxes


@njit(cache=True)
def points_free(
    points: FloatArray, vertices: FloatArray, first: IntArray, rho: FloatArray, boxes: FloatArray
) -> BoolArray:
    """For each of `points` (n, 2) whether it lies in no obstacle."""
    free = np.empty(len(points), np.bool_)
    for i in range(len(points)):
        x, y = points[i, 0], points[i, 1]
        free[i] = segment_free(x, y, x, y, vertices, first, rho, boxes)
    return free


@njit(cache=True)
def points_free_within(
    points: FloatArray, bounds: FloatArray, vertices: FloatArray, first: IntArray, rho: FloatArray, boxes: FloatArray
) -> BoolArray:
    """For each of `points` (n, 2) whether it lies in the closed rectangle `bounds` (2, 2) and in no obstacle."""
    free = np.empty(len(points), np.bool_)
    for i in range(len(points)):
        x, y = points[i, 0], points[i, 1]
        inside = bounds[0, 0] <= x <= bounds[1, 0] and bounds[0, 1] <= y <= bounds[1, 1]
        free[i] = inside and segment_free(x, y, x, y, vertices, first, rho, boxes)
    return free


@njit(cache=True)
def segments_free(
    starts: FloatArray,
    ends: FloatArray,
    vertices: FloatArray,
    first: IntArray,
    rho: FloatArray,
    boxes: FloatArray,
) -> BoolArray:
    """For each pair of rows of `starts` and `ends` (n, 2) whether the segment between them meets no obstacle."""
    free = np.empty(len(starts), np.bool_)
    for i in range(len(starts)):
        free[i] = segment_free(starts[i, 0], starts[i, 1], ends[i, 0], ends[i, 1], vertices, first, rho, boxes)
    return free
