"""Footprints: convex polygons with an optional edge radius, the only shapes of the whole product.

A *part* is the Minkowski sum of a convex core polygon and a disc of radius `edge_radius`; a body is an upright prism
over one or several parts that move as one. A rounded box of outer size (sx, sy) has the core (sx - 2r, sy - 2r).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

_STRAIGHT = 1e-10
"""Largest distance [m] of a vertex inside the line through its neighbours that counts as lying on it: rounding alone
bends a straight side inwards when a polygon is turned or shortened."""


def frozen_array(values: npt.ArrayLike, shape: tuple[int | None, ...]) -> FloatArray:
    """A read-only float copy of `values`.

    Raises:
        ValueError: the shape differs (None stands for any length), or a number is not finite.
    """
    array = np.array(values, dtype=np.float64)
    if array.ndim != len(shape) or any(n is not None and n != m for n, m in zip(shape, array.shape, strict=True)):
        wanted = " x ".join("n" if n is None else str(n) for n in shape)
        raise ValueError(f"{wanted} numbers wanted, found shape {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError("every number must be finite")
    array.flags.writeable = False
    return array


def rounded(values: npt.ArrayLike, digits: int) -> FloatArray:
    """`values` to so many decimals; none of them is -0.0."""
    # Adding 0.0 turns -0.0 into 0.0.
    return np.asarray(np.round(np.asarray(values, dtype=np.float64), digits) + 0.0, dtype=np.float64)


def denoised(values: npt.ArrayLike) -> FloatArray:
    """`values` rounded to 1e-12: sums of decimal numbers without the noise of floating-point arithmetic."""
    return rounded(values, 12)


def rotation(yaw: float) -> FloatArray:
    """The (2, 2) matrix R for which `points @ R` turns row vectors counter-clockwise by `yaw` [rad]."""
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, s], [-s, c]])


@dataclass(frozen=True, eq=False)
class Part:
    """A convex polygon inflated by a disc.

    Attributes:
        core: (n, 2) [m], body frame, counter-clockwise, n >= 1 (one point: a disc; two points: a capsule). Vertices may
            lie on a straight side.
        edge_radius: Radius of the disc [m], >= 0.
    """

    core: FloatArray
    edge_radius: float = 0.0

    def __post_init__(self) -> None:
        core = frozen_array(self.core, (None, 2))
        if len(core) == 0:
            raise ValueError("a polygon needs at least one vertex")
        if not (np.isfinite(self.edge_radius) and self.edge_radius >= 0):
            raise ValueError(f"edge radius {self.edge_radius} must be >= 0")
        if len(core) <= 2 and self.edge_radius == 0:
            raise ValueError("a polygon of one or two vertices needs an edge radius > 0")
        if len(core) == 2 and np.array_equal(core[0], core[1]):
            raise ValueError("two vertices of the polygon agree")
        if len(core) >= 3:
            _require_convex(core)
        object.__setattr__(self, "core", core)

    @classmethod
    def box(cls, size: Sequence[float] | FloatArray, edge_radius: float = 0.0) -> Self:
        """The rounded box of outer `size` (sx, sy) [m], centred at the origin.

        Raises:
            ValueError: a side is not positive, or is shorter than two edge radii.
        """
        sx, sy = float(size[0]), float(size[1])
        if min(sx, sy) <= 0:
            raise ValueError(f"size {sx} x {sy} must be positive")
        hx, hy = sx / 2 - edge_radius, sy / 2 - edge_radius
        if min(hx, hy) < -1e-12:
            raise ValueError(f"size {sx} x {sy} is smaller than two edge radii of {edge_radius}")
        hx, hy = max(hx, 0.0), max(hy, 0.0)
        corners = np.array([[-hx, -hy], [hx, -hy], [hx, hy], [-hx, hy]])
        keep = [i for i in range(4) if not any(np.array_equal(corners[i], corners[j]) for j in range(i))]
        return cls(corners[keep], edge_radius)

    @property
    def box_size(self) -> tuple[float, float] | None:
        """Outer size (sx, sy) [m] if the part is a box centred at the origin and aligned with the axes."""
        hx, hy = np.abs(self.core).max(axis=0)
        if len(self.core) != (1 if hx == hy == 0 else 2 if 0 in (hx, hy) else 4):
            return None
        if not np.array_equal(np.abs(self.core), np.tile([hx, hy], (len(self.core), 1))):
            return None
        return 2 * (float(hx) + self.edge_radius), 2 * (float(hy) + self.edge_radius)

    def with_edge_radius(self, edge_radius: float) -> Self:
        """The part with rounder or sharper corners; the straight edges of its outline stay where they are.

        Discs and capsules, which are round by their nature, stay as they are.

        Raises:
            ValueError: the part is too thin for the radius.
        """
        if len(self.core) < 3:
            return self
        edges = np.roll(self.core, -1, axis=0) - self.core
        inward = np.stack([-edges[:, 1], edges[:, 0]], axis=1) / np.hypot(*edges.T)[:, np.newaxis]
        before = np.roll(inward, 1, axis=0)
        # A vertex moves along the bisector of its edges, so that both come in by the change of the radius.
        step = (edge_radius - self.edge_radius) / (1 + (inward * before).sum(axis=1))
        core = self.core + step[:, np.newaxis] * (inward + before)
        if (((np.roll(core, -1, axis=0) - core) * edges).sum(axis=1) <= 0).any():
            raise ValueError(f"the part is too thin for an edge radius of {edge_radius}")
        return type(self)(core, edge_radius)


def _require_convex(core: FloatArray) -> None:
    edges = np.roll(core, -1, axis=0) - core
    following = np.roll(edges, -1, axis=0)
    turns = edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0]
    lengths = np.hypot(*edges.T)
    if (lengths == 0).any():
        raise ValueError("two consecutive vertices of the polygon agree")
    # What a vertex turns, by the line through its neighbours, is its distance from that line.
    if (turns < -_STRAIGHT * np.hypot(*(edges + following).T)).any() or not (turns > 0).any():
        raise ValueError("the polygon must be convex with counter-clockwise vertices")
    angles = np.arctan2(turns, (edges * following).sum(axis=1))
    if not np.isclose(angles.sum(), 2 * np.pi):
        raise ValueError("the polygon must not cross itself")
