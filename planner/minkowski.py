"""Minkowski sums of convex polygons: the forbidden set of a translating body is B + (-A)."""

import numpy as np

from converter.shape import FloatArray

_SAME_DIRECTION = 1e-12
"""Edges whose directions differ by less [rad] become one edge of the sum."""


def minkowski_sum(p: FloatArray, q: FloatArray) -> FloatArray:
    """The sum of two convex counter-clockwise polygons (n, 2) and (m, 2), counter-clockwise.

    One vertex stands for a point and two for a segment. The edges of the sum are those of the summands in the order
    of their directions (de Berg et al., Computational Geometry, section 13.3).
    """
    if len(p) == 1 or len(q) == 1:
        return p + q
    # Adding 0.0 removes negative zeros, for which arctan2 would answer -pi instead of pi.
    edges = np.vstack([np.roll(p, -1, axis=0) - p, np.roll(q, -1, axis=0) - q]) + 0.0
    directions = np.arctan2(edges[:, 1], edges[:, 0])
    order = np.argsort(directions, kind="stable")
    edges, directions = edges[order], directions[order]
    # Directions rise from -pi: the walk starts at the top, at its left end, where edges turn downwards.
    vertices = _top_left(p) + _top_left(q) + np.vstack([np.zeros(2), np.cumsum(edges[:-1], axis=0)])
    turns = np.diff(directions, prepend=directions[-1] - 2 * np.pi)
    return np.asarray(vertices[turns > _SAME_DIRECTION])


def _top_left(polygon: FloatArray) -> FloatArray:
    return np.asarray(polygon[np.lexsort((polygon[:, 0], -polygon[:, 1]))[0]])
