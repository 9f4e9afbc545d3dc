"""Parts as other programs know them: outlines as plain polygons without an edge radius, and cores as rectangles."""

import math
from dataclasses import dataclass

import numpy as np

from converter.shape import FloatArray, Part, denoised

MAX_ERROR = 1e-4
"""Largest distance between the outline of a part and its polygon [m]."""

_SQUARE = 1e-9
"""Largest deviation of a rectangle from one, as a share of its size."""


@dataclass(frozen=True, eq=False)
class Rectangle:
    """A rectangle in the frame of a body.

    Attributes:
        centre: (2,) [m].
        size: (2,) [m], before `yaw`.
        yaw: [rad], counter-clockwise.
    """

    centre: FloatArray
    size: FloatArray
    yaw: float


def rectangle_of(core: FloatArray) -> Rectangle | None:
    """The polygon `core` (n, 2) [m] as a rectangle, or None if it is no rectangle."""
    if len(core) != 4:
        return None
    along, across = core[1] - core[0], core[2] - core[1]
    scale = np.abs([along, across]).max()
    parallel = np.abs(core[3] - core[0] - across).max() <= _SQUARE * scale
    if not parallel or abs(along @ across) > _SQUARE * np.hypot(*along) * np.hypot(*across):
        return None
    size = denoised([np.hypot(*along), np.hypot(*across)])
    return Rectangle(denoised(core.mean(axis=0)), size, math.atan2(along[1], along[0]))


def outline_polygon(part: Part, max_error: float = MAX_ERROR) -> FloatArray:
    """The outline of a part with its arcs replaced by chords.

    The vertices lie on the outline, so the polygon is contained in the part; straight edges are exact. A chord over
    the angle a of an arc of radius r leaves it by r (1 - cos(a / 2)).

    Args:
        part: Any part.
        max_error: Largest distance by which a chord may leave its arc [m].

    Returns:
        (n, 2) [m], frame of the body, counter-clockwise.
    """
    core, radius = part.core, part.edge_radius
    if radius == 0:
        return core
    step = 2 * math.acos(max(1 - max_error / radius, 0.0))
    if len(core) == 1:
        circle = _directions(0.0, 2 * math.pi, step)[:-1]
        return np.asarray(core[0] + radius * circle)
    edges = np.roll(core, -1, axis=0) - core
    before = np.roll(edges, 1, axis=0)
    cross = before[:, 0] * edges[:, 1] - before[:, 1] * edges[:, 0]
    turns = np.abs(np.arctan2(cross, (before * edges).sum(axis=1)))
    # The normal of an edge points out of the part: its direction turned clockwise.
    normals = np.arctan2(before[:, 1], before[:, 0]) - math.pi / 2
    corners = zip(core, normals, turns, strict=True)
    return np.concatenate([vertex + radius * _directions(normal, turn, step) for vertex, normal, turn in corners])


def _directions(start: float, turn: float, step: float) -> FloatArray:
    """Unit vectors (n, 2) from the angle `start` over `turn` [rad], at most `step` apart."""
    angles = start + np.linspace(0.0, turn, math.ceil(turn / step) + 1)
    return np.stack([np.cos(angles), np.sin(angles)], axis=1)
