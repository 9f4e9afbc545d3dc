"""Grasps: the closed curve of agent positions that touch an object.

The disc of radius R touches a convex part with edge radius r exactly where the signed distance to its core is R + r:
offset edges joined by arcs. Along an edge the nearest core point moves and the normal stays; along an arc the normal
turns and the point stays. For an object of several parts the curve of each counts where it stays clear of the others.
Grasps are relative: agent centre minus object position.
"""

import numpy as np

from converter.scene import NUMERIC_SLACK, Body
from converter.shape import FloatArray
from planner.configuration_space import ObstacleSet
from planner.kernel import points_free


class ContactCurve:
    """All positions, relative to `body`, at which a disc of `radius` [m] touches it."""

    def __init__(self, body: Body, radius: float) -> None:
        reaches = [radius + part.edge_radius for part in body.parts]
        knots = [_knots(core, reach) for core, reach in zip(body.cores, reaches, strict=True)]
        # A curve of several parts is sampled as one; the step from part to part has no length.
        lengths = np.cumsum([0.0, *(piece[-1, 0] for piece in knots)])
        self._knots = np.vstack(
            [piece + np.array([start, 0, 0, 0, 0]) for piece, start in zip(knots, lengths, strict=False)]
        )
        self._interior = ObstacleSet.of(body.cores, [reach - NUMERIC_SLACK for reach in reaches])
        self.length = float(lengths[-1])

    def at(self, arc_length: FloatArray) -> FloatArray:
        """Grasps (n, 2) [m] at the given (n,) lengths [m] along the curve, from 0 to `length`."""
        position, *columns = self._knots.T
        x, y, angle, reach = (np.interp(arc_length, position, column) for column in columns)
        return np.column_stack([x + reach * np.cos(angle), y + reach * np.sin(angle)])

    def sample(self, n: int, rng: np.random.Generator) -> FloatArray:
        """At most `n` grasps (k, 2) [m], one in each of `n` equal stretches of the curve, in random order."""
        grasps = self.at(self.length * (np.arange(n) + rng.random(n)) / n)
        return rng.permutation(grasps[points_free(grasps, *self._interior.arrays)])


def _knots(core: FloatArray, reach: float) -> FloatArray:
    """Rows (arc length, nearest core point x, y, angle of the normal, reach), linear in between."""
    n = len(core)
    if n == 1:
        return np.array([[0, *core[0], 0, reach], [2 * np.pi * reach, *core[0], 2 * np.pi, reach]])
    edges = np.roll(core, -1, axis=0) - core
    lengths = np.hypot(*edges.T)
    normals = np.arctan2(-edges[:, 0], edges[:, 1])
    normals = normals[0] + np.cumsum(np.diff(normals, prepend=normals[0]) % (2 * np.pi))
    rows, position = [], 0.0
    for i in range(n):
        following = normals[i + 1] if i + 1 < n else normals[0] + 2 * np.pi
        corner = core[(i + 1) % n]
        rows.append([position, *core[i], normals[i], reach])
        position += lengths[i]
        rows.append([position, *corner, normals[i], reach])
        position += reach * (following - normals[i])
    rows.append([position, *core[0], normals[0] + 2 * np.pi, reach])
    return np.array(rows)
