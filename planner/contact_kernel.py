"""Where a contact curve may enter or leave obstacles: at the lines and circles that contain their borders.

Layout of the curve: `knots (n, 5)` rows of arc length [m], nearest core point x and y [m], angle of the normal [rad] and
reach [m], linear in between; see `planner.contact_curve`. Obstacles as in `planner.kernel`.
"""

import math

import numpy as np
from numba import njit

from converter.shape import FloatArray
from planner.kernel import IntArray

_PARALLEL = 1e-12
"""A line does not cross another one if it nears it by less [m] per metre."""


@njit(cache=True)
def crossings(knots: FloatArray, vertices: FloatArray, first: IntArray, rho: FloatArray) -> FloatArray:
    """Arc lengths (k,) [m] at which the curve meets a line or circle of an obstacle; some may miss its border."""
    found = np.empty(4 * len(knots) * len(vertices))
    n = 0
    for i in range(len(knots) - 1):
        if knots[i + 1, 0] <= knots[i, 0]:
            continue
        is_straight = knots[i, 3] == knots[i + 1, 3]
        for k in range(len(rho)):
            for v in range(first[k], first[k + 1]):
                w = v + 1 if v + 1 < first[k + 1] else first[k]
                if is_straight:
                    meets = _on_straight(knots[i], vertices[v], vertices[w], rho[k])
                else:
                    meets = _on_arc(knots[i], vertices[v], vertices[w], rho[k])
                for at in meets:
                    if 0.0 < at < knots[i + 1, 0] - knots[i, 0]:
                        found[n] = knots[i, 0] + at
                        n += 1
    return found[:n].copy()


@njit(cache=True)
def _on_straight(knot: FloatArray, p: FloatArray, q: FloatArray, rho: float) -> tuple[float, float, float, float]:
    """Lengths from `knot` on at which a straight piece meets the offset edge p q and the circle about p, or NaN.

    Four numbers, as `_on_arc` returns; a straight piece meets the line once only.
    """
    nx, ny = math.cos(knot[3]), math.sin(knot[3])
    # Relative to p; the piece runs from (x, y) in the direction (-ny, nx).
    x, y = knot[1] + knot[4] * nx - p[0], knot[2] + knot[4] * ny - p[1]
    with_line = with_circle = other = math.nan
    ex, ey = q[0] - p[0], q[1] - p[1]
    length = math.sqrt(ex * ex + ey * ey)
    if length > 0.0:
        speed = (-ny * ey - nx * ex) / length
        if abs(speed) > _PARALLEL:
            with_line = (rho - (x * ey - y * ex) / length) / speed
    if rho > 0.0:
        middle = x * ny - y * nx
        half = math.sqrt(max(rho * rho - x * x - y * y + middle * middle, 0.0))
        with_circle, other = middle - half, middle + half
    return with_line, math.nan, with_circle, other


@njit(cache=True)
def _on_arc(knot: FloatArray, p: FloatArray, q: FloatArray, rho: float) -> tuple[float, float, float, float]:
    """The same of an arc, which meets the line and the circle twice."""
    x, y, reach = knot[1] - p[0], knot[2] - p[1], knot[4]
    ex, ey = q[0] - p[0], q[1] - p[1]
    length = math.sqrt(ex * ex + ey * ey)
    on_line, other_on_line = math.nan, math.nan
    if length > 0.0:
        cosine = (rho - (x * ey - y * ex) / length) / reach
        on_line, other_on_line = _turns(math.atan2(-ex, ey), cosine, knot)
    on_circle, other_on_circle = math.nan, math.nan
    if rho > 0.0:
        distance = max(math.sqrt(x * x + y * y), _PARALLEL)
        cosine = (reach * reach + distance * distance - rho * rho) / (2 * reach * distance)
        on_circle, other_on_circle = _turns(math.atan2(-y, -x), cosine, knot)
    return on_line, other_on_line, on_circle, other_on_circle


@njit(cache=True)
def _turns(middle: float, cosine: float, knot: FloatArray) -> tuple[float, float]:
    """Lengths from `knot` on to the angles whose distance from `middle` [rad] has that cosine, or NaN."""
    if abs(cosine) > 1.0:
        return math.nan, math.nan
    half = math.acos(cosine)
    return knot[4] * ((middle - half - knot[3]) % (2 * np.pi)), knot[4] * ((middle + half - knot[3]) % (2 * np.pi))
