"""How deep a body that moves along a path penetrates others, measured with shapely (GEOS), for `planner.verify`.

Nothing is sampled along the motion, and no disc is replaced by a polygon.

*Swept bodies.* Nothing rotates, so a convex core A that translates by d along a straight piece of path sweeps exactly
the convex hull of A and A + d. With D the distance of that hull to an obstacle's core B, the deepest penetration of
the two rounded shapes along the piece is r_A + r_B - D while D > 0.

*Intersecting cores.* If D = 0 the cores' own depth is added. The depth of A + t d in B is the least overlap over the
separating axes, the edge normals of both polygons (it is the distance from the origin to the border of B + (-A)).
Each overlap is linear in t, so the depth is concave and piecewise linear, and its maximum over t in [0, 1] is found
exactly. Polygons that only touch have depth 0: sharp bodies may touch.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Any, Self

import numpy as np
import shapely  # type: ignore[import-untyped]  # shapely ships no types

from converter.scene import AGENT, NUMERIC_SLACK, Agent, Body
from converter.shape import FloatArray


@dataclass(frozen=True, eq=False)
class Contact:
    """Where two bodies meet deepest.

    Attributes:
        depth: Penetration [m].
        where: (2,) [m], world: a point of the obstacle's core.
    """

    depth: float
    where: FloatArray


@dataclass(frozen=True, eq=False)
class Prism:
    """A rigid body at one place: convex cores with radii, over a height interval.

    Attributes:
        name: For messages.
        position: (2,) [m], world.
        cores: (n, 2) each [m], relative to `position`.
        radii: One for each core [m].
        bottom_top: Height interval [m].
    """

    name: str
    position: FloatArray
    cores: tuple[FloatArray, ...]
    radii: tuple[float, ...]
    bottom_top: tuple[float, float]

    @classmethod
    def of_body(cls, body: Body) -> Self:
        """A wall or an object where its scene has it."""
        radii = tuple(part.edge_radius for part in body.parts)
        return cls(body.name, body.position[:2], body.cores, radii, body.bottom_top)

    @classmethod
    def of_agent(cls, agent: Agent) -> Self:
        """The agent at its start, standing on the floor."""
        return cls(AGENT, agent.position, (np.zeros((1, 2)),), (agent.radius,), (0.0, agent.height))

    def at(self, position: FloatArray) -> Self:
        """The same body at `position` (2,) [m], world."""
        return replace(self, position=position)

    @cached_property
    def world_cores(self) -> list[FloatArray]:
        """The cores' vertices, world."""
        return [core + self.position for core in self.cores]

    @cached_property
    def geometries(self) -> list[Any]:
        """The cores as shapely geometries, world."""
        return [_hull(core) for core in self.world_cores]

    def meets_in_height(self, other: "Prism") -> bool:
        """Whether the height intervals overlap; bodies on top of each other do not."""
        (bottom, top), (other_bottom, other_top) = self.bottom_top, other.bottom_top
        return min(top, other_top) - max(bottom, other_bottom) > NUMERIC_SLACK

    def gap(self, other: "Prism") -> float:
        """Distance of the two [m]; negative or 0 if they overlap, infinite if their heights do not meet."""
        if not self.meets_in_height(other):
            return np.inf
        pairs = product(zip(self.geometries, self.radii, strict=True), zip(other.geometries, other.radii, strict=True))
        return min(float(shapely.distance(a, b)) - r_a - r_b for (a, r_a), (b, r_b) in pairs)


def deepest_contacts(mover: Prism, path: FloatArray, obstacles: Sequence[Prism], allowed: float) -> dict[str, Contact]:
    """The obstacles that `mover` penetrates by more than `allowed` [m], each with the deepest contact.

    Args:
        mover: The moving body.
        path: (n, 2) [m], world: its positions, joined by straight lines; one point stands for a body at rest.
        obstacles: Bodies at rest, with different names.
        allowed: Penetration that does not count [m], >= 0.
    """
    bodies = [body for body in obstacles if body.meets_in_height(mover)]
    if not bodies:
        return {}
    names = [body.name for body in bodies for _ in body.cores]
    vertices = [core for body in bodies for core in body.world_cores]
    radii = np.array([radius for body in bodies for radius in body.radii])
    tree = shapely.STRtree([core for body in bodies for core in body.geometries])
    deepest: dict[str, Contact] = {}
    for core, radius in zip(mover.cores, mover.radii, strict=True):
        starts, steps, swept = _sweep(core, path)
        pieces, hits = tree.query(swept, predicate="dwithin", distance=radius + radii.max())
        distances = shapely.distance(swept[pieces], tree.geometries[hits])
        depths = radius + radii[hits] - distances
        for k in np.flatnonzero((depths > allowed) | (distances == 0)):
            piece, hit, moving, depth = pieces[k], hits[k], swept[pieces[k]], float(depths[k])
            if distances[k] == 0:
                overlap, t = _core_depth(starts[piece], steps[piece], vertices[hit])
                moving, depth = _hull(starts[piece] + t * steps[piece]), depth + overlap
            known = deepest.get(names[hit])
            if depth > (allowed if known is None else known.depth):
                line = shapely.shortest_line(moving, tree.geometries[hit])
                deepest[names[hit]] = Contact(depth, shapely.get_coordinates(line)[-1])
    return deepest


def _hull(points: FloatArray) -> Any:
    """Convex hull of the points (..., n, 2), a shapely geometry for each."""
    return shapely.convex_hull(shapely.multipoints(points))


def _sweep(core: FloatArray, path: FloatArray) -> tuple[FloatArray, FloatArray, Any]:
    """Core (m, 2) at the start of each piece of `path` (n, 2), steps (n - 1, 2), and the hulls that it sweeps.

    A path of one point counts as one piece of length 0.
    """
    path = path if len(path) > 1 else np.repeat(path, 2, axis=0)
    starts = path[:-1, np.newaxis] + core
    steps = np.diff(path, axis=0)
    return starts, steps, _hull(np.concatenate([starts, path[1:, np.newaxis] + core], axis=1))


def _core_depth(core: FloatArray, step: FloatArray, obstacle: FloatArray) -> tuple[float, float]:
    """Deepest penetration [m] of polygon `core` + t `step`, t in [0, 1], in `obstacle`, and the t of it.

    Both polygons (n, 2) are counter-clockwise. Where the two only touch, the depth is 0.
    """
    normals = np.concatenate([_outward_normals(obstacle), -_outward_normals(core)])
    if len(normals) == 0:
        return 0.0, 0.0
    overlaps = (obstacle @ normals.T).max(axis=0) - (core @ normals.T).min(axis=0)
    t = _argmax_of_minimum(overlaps, -normals @ step)
    return max(0.0, float((overlaps - t * (normals @ step)).min())), t


def _outward_normals(polygon: FloatArray) -> FloatArray:
    """Unit normals of the edges; both normals of a segment, none of a point."""
    edges = np.roll(polygon, -1, axis=0) - polygon
    lengths = np.hypot(*edges.T)
    edges, lengths = edges[lengths > 0], lengths[lengths > 0]
    normals: FloatArray = np.stack([edges[:, 1], -edges[:, 0]], axis=1) / lengths[:, np.newaxis]
    return normals


def _argmax_of_minimum(values: FloatArray, slopes: FloatArray) -> float:
    """The t in [0, 1] that maximises the least of the lines `values` + t `slopes`.

    Cutting planes (Kelley 1960), exact for lines: a rising and a falling line bound the maximum by their crossing;
    the line that is least there replaces one of them, until it is one of the two. Each line is used once at most.
    """
    rising = int(values.argmin())
    falling = int((values + slopes).argmin())
    if slopes[rising] <= 0:
        return 0.0
    if slopes[falling] >= 0:
        return 1.0
    t = 0.0
    for _ in values:
        t = (values[falling] - values[rising]) / (slopes[rising] - slopes[falling])
        least = int((values + t * slopes).argmin())
        if least in (rising, falling):
            break
        rising, falling = (least, falling) if slopes[least] > 0 else (rising, least)
    return float(np.clip(t, 0.0, 1.0))
