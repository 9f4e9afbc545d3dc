"""Grasps: the closed curve of agent positions that touch an object, and which parts of it are free.

The disc of radius R touches a convex part with edge radius r exactly where the signed distance to its core is R + r:
offset edges joined by arcs. Along an edge the nearest core point moves and the normal stays; along an arc the normal
turns and the point stays. For an object of several parts the curve of each counts where it stays clear of the others.
Grasps are relative: agent centre minus object position.

An obstacle's border consists of offset edges and arcs as well, so the curve enters and leaves it only where it meets
one of their lines and circles. Between two such points all of it is free or none, and one test in the middle decides.
No grasp is lost, however short its stretch: in a corridor as wide as the agent it is a single point.
"""

import numpy as np

from converter.scene import NUMERIC_SLACK, Body
from converter.shape import FloatArray
from planner.configuration_space import ObstacleSet
from planner.contact_kernel import crossings
from planner.kernel import points_free

END_MARGIN = 1e-6
"""Distance [m] of grasps from the ends of a free stretch: at the very end rounding decides who sees a collision."""


class ContactCurve:
    """All positions, relative to `body`, at which a disc of `radius` [m] touches it."""

    def __init__(self, body: Body, radius: float) -> None:
        reaches = [radius + part.edge_radius for part in body.parts]
        knots = [_knots(core, reach) for core, reach in zip(body.cores, reaches, strict=True)]
        # A curve of several parts is one parametrised by arc length; the step from part to part has no length.
        lengths = np.cumsum([0.0, *(piece[-1, 0] for piece in knots)])
        self._knots = np.vstack(
            [piece + np.array([start, 0, 0, 0, 0]) for piece, start in zip(knots, lengths, strict=False)]
        )
        self._interior = ObstacleSet.of(body.cores, [reach - NUMERIC_SLACK for reach in reaches])
        self._box = self._surroundings()
        self.length = float(lengths[-1])

    def at(self, arc_length: FloatArray) -> FloatArray:
        """Grasps (n, 2) [m] at the given (n,) lengths [m] along the curve, from 0 to `length`."""
        position, *columns = self._knots.T
        x, y, angle, reach = (np.interp(arc_length, position, column) for column in columns)
        return np.column_stack([x + reach * np.cos(angle), y + reach * np.sin(angle)])

    def encloses(self, position: FloatArray) -> bool:
        """Whether an agent with its centre at `position` (2,) [m], relative to the body, is nearer than touching."""
        return not points_free(position[None], *self._interior.arrays)[0]

    def free_stretches(self, obstacles: ObstacleSet) -> FloatArray:
        """The stretches (k, 2) [m], from and to in arc length, on which the agent lies in none of `obstacles`.

        Args:
            obstacles: Of the agent, relative to the object's position, without the object itself.
        """
        blockers = obstacles.near(self._box).joined(self._interior, np.zeros(2))
        crossed = crossings(self._knots, blockers.vertices, blockers.first, blockers.rho)
        cuts = np.unique(np.concatenate([self._knots[:, 0], crossed]))
        free = points_free(self.at((cuts[1:] + cuts[:-1]) / 2), *blockers.arrays)
        starts_free, ends_free = free & ~np.r_[False, free[:-1]], free & ~np.r_[free[1:], False]
        return np.column_stack([cuts[:-1][starts_free], cuts[1:][ends_free]])

    def sample_free(self, n: int, obstacles: ObstacleSet, rng: np.random.Generator) -> FloatArray:
        """About `n` grasps (k, 2) [m] clear of `obstacles`, in random order.

        Both ends of every free stretch, where the agent touches something else as well, and others spread over the
        whole length. From an end the agent has the longest way to go until it meets the other side.
        """
        stretches = self.free_stretches(obstacles)
        if len(stretches) == 0:
            return np.empty((0, 2))
        lengths = stretches[:, 1] - stretches[:, 0]
        margins = np.minimum(END_MARGIN, lengths / 2)
        ends = np.concatenate([stretches[:, 0] + margins, stretches[:, 1] - margins])
        n_spread = max(n - len(ends), n // 2)
        behind = np.cumsum(lengths)
        spread = behind[-1] * (np.arange(n_spread) + rng.random(n_spread)) / n_spread
        owner = np.minimum(np.searchsorted(behind, spread), len(behind) - 1)
        return rng.permutation(self.at(np.concatenate([ends, stretches[owner, 1] - (behind[owner] - spread)])))

    def _surroundings(self) -> FloatArray:
        nearest, reach = self._knots[:, 1:3], self._knots[:, 4].max()
        return np.array([nearest.min(axis=0) - reach, nearest.max(axis=0) + reach])


def _knots(core: FloatArray, reach: float) -> FloatArray:
    """Rows (arc length, nearest core point x, y, angle of the normal, reach), linear in between."""
    n = len(core)
    if n == 1:
        return np.array([[0, *core[0], 0, reach], [2 * np.pi * reach, *core[0], 2 * np.pi, reach]])
    edges = np.roll(core, -1, axis=0) - core
    lengths = np.hypot(*edges.T)
    normals = np.arctan2(-edges[:, 0], edges[:, 1])
    turns = np.diff(normals, prepend=normals[0]) % (2 * np.pi)
    # A convex polygon turns by at most pi; more is a straight angle at which rounding turns back.
    turns[turns > 1.5 * np.pi] = 0.0
    normals = normals[0] + np.cumsum(turns)
    rows, position = [], 0.0
    for i in range(n):
        following = normals[i + 1] if i + 1 < n else normals[0] + 2 * np.pi
        rows.append([position, *core[i], normals[i], reach])
        position += lengths[i]
        rows.append([position, *core[(i + 1) % n], normals[i], reach])
        position += reach * (following - normals[i])
    rows.append([position, *core[0], normals[0] + 2 * np.pi, reach])
    return np.array(rows)
