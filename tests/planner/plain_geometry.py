"""Slow, plain twins of the planner's geometry: shapely distances, brute force and exact rational numbers."""

from collections.abc import Iterable, Sequence
from fractions import Fraction
from itertools import combinations, pairwise
from typing import Any

import numpy as np
import shapely
from hypothesis import strategies as st

from converter.scene import Body
from converter.shape import FloatArray

coordinates = st.floats(-1.0, 1.0).map(lambda x: round(x, 3))
points = st.tuples(coordinates, coordinates).map(np.array)


@st.composite
def polygons(draw: st.DrawFn, min_vertices: int = 1, max_vertices: int = 7) -> FloatArray:
    """Convex counter-clockwise polygons, a point or a segment among them, thin and fat, at any angle."""
    n = draw(st.integers(min_vertices, max_vertices))
    angles = (np.arange(n) + [draw(st.floats(0, 0.5)) for _ in range(n)]) * 2 * np.pi / n + draw(st.floats(0, 6))
    axes = [draw(st.floats(0.02, 0.6)), draw(st.floats(0.1, 0.6))]
    return draw(points) + np.column_stack([np.cos(angles), np.sin(angles)]) * axes


def polyline(path: Sequence[FloatArray] | FloatArray) -> Any:
    """A shapely line, or a point if all of `path` (n, 2) is one."""
    places = np.asarray(path, dtype=float)
    return shapely.Point(places[0]) if (places == places[0]).all() else shapely.LineString(places)


def hull(polygon: FloatArray) -> Any:
    """The polygon (n, 2) as a shapely geometry."""
    return shapely.convex_hull(shapely.multipoints(polygon))


def clearance(a: FloatArray, b: FloatArray, polygon: FloatArray) -> float:
    """Least signed distance of the points between `a` and `b` to a convex polygon (n, 2), negative inside.

    Inside it is the largest height over an edge's line. Along the segment each height is linear, so the least of the
    largest lies at an end or where two heights agree: all of these are tried.
    """
    distance = float(shapely.distance(polyline([a, b]), hull(polygon)))
    if distance > 0 or len(polygon) < 3:
        return distance
    edges = np.roll(polygon, -1, axis=0) - polygon
    normals = np.column_stack([edges[:, 1], -edges[:, 0]]) / np.hypot(*edges.T)[:, np.newaxis]
    at_a, at_b = ((normals * (end - polygon)).sum(axis=1) for end in (a, b))
    slopes = at_b - at_a
    crossings = [
        (at_a[j] - at_a[i]) / (slopes[i] - slopes[j])
        for i, j in combinations(range(len(polygon)), 2)
        if slopes[i] != slopes[j]
    ]
    places = [0.0, 1.0, *(t for t in crossings if 0 < t < 1)]
    return min(0.0, *(float((at_a + t * slopes).max()) for t in places))


def meets_interior(a: FloatArray, b: FloatArray, polygon: FloatArray) -> bool:
    """Whether a point between `a` and `b` lies inside a convex polygon (n, 2), n >= 3, by exact rational numbers.

    The segment changes sides of an edge's line at one point at most; between these points one sample decides.
    """
    (ax, ay), (bx, by) = ([Fraction(float(v)) for v in end] for end in (a, b))
    corners = [(Fraction(float(x)), Fraction(float(y))) for x, y in polygon]
    edges = list(zip(corners, [*corners[1:], corners[0]], strict=True))

    def heights(x: Fraction, y: Fraction) -> list[Fraction]:
        return [(qx - px) * (y - py) - (qy - py) * (x - px) for (px, py), (qx, qy) in edges]

    cuts = {Fraction(0), Fraction(1)}
    for at_a, at_b in zip(heights(ax, ay), heights(bx, by), strict=True):
        if at_a * at_b < 0:
            cuts.add(at_a / (at_a - at_b))
    ordered = sorted(cuts)
    samples = [(s + t) / 2 for s, t in pairwise(ordered)]
    return any(min(heights(ax + t * (bx - ax), ay + t * (by - ay))) > 0 for t in samples)


def disc_penetration(path: FloatArray, radius: float, bodies: Iterable[Body]) -> float:
    """How deep a disc penetrates `bodies` where they stand along `path` (n, 2) [m]; below 0 it is the gap."""
    line = polyline(path)
    depths = [
        radius + part.edge_radius - float(shapely.distance(line, hull(core + body.position[:2])))
        for body in bodies
        for core, part in zip(body.cores, body.parts, strict=True)
    ]
    return max(depths, default=-np.inf)


def length(path: FloatArray) -> float:
    """Length of a polyline (n, 2) [m]."""
    return float(np.hypot(*np.diff(path, axis=0).T).sum())
