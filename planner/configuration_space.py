"""Configuration-space obstacles of the agent, of an object, and of the agent holding an object.

The configuration is the (2,) position [m], world, of the moving body's reference point. For a body with convex
footprint A among convex B the forbidden set is B + (-A): the sum of the core polygons, inflated by the sum of the
radii. Free space is closed, and `tolerance` widens it: an obstacle is {x : s(x) < rho} with
rho = r_A + r_B - tolerance - 1e-9.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from converter.scene import NUMERIC_SLACK, Agent, Body, heights_meet
from converter.shape import FloatArray
from planner import kernel
from planner.minkowski import minkowski_sum

_ARC_STEP = np.pi / 8
"""Angle between the tangents that replace an arc."""

ARC_EXCESS = 1 / np.cos(_ARC_STEP / 2) - 1
"""Share of the radius by which the corners between these tangents stand off at most: 2 %."""

_MARGIN = 1e-6
"""What lies less deep [m] behind the tangents of a corner may be free by rounding or by a numeric slack."""


@dataclass(frozen=True, eq=False)
class ObstacleSet:
    """Convex polygons, each with its own radius, in the layout of `planner.kernel`.

    Attributes:
        vertices: (M, 2) [m], counter-clockwise polygons one after the other.
        first: (K + 1,) first row of each polygon, then M.
        rho: (K,) radii [m]; a negative one shrinks its polygon.
        boxes: (K, 4) [m] x_min, y_min, x_max, y_max of the inflated polygons.
        corners: (C, 2) [m] where a shortest path may turn: vertices of tight polygons around the obstacles.
        normals: (C, 4) [1/m] the x and y of the outward normals of the two tangents that meet in each corner, so long
            that a line which ends further than 1 behind both has entered the obstacle.
    """

    vertices: FloatArray
    first: kernel.IntArray
    rho: FloatArray
    boxes: FloatArray
    corners: FloatArray
    normals: FloatArray

    @classmethod
    def of(cls, polygons: Sequence[FloatArray], rho: Sequence[float]) -> Self:
        """The set of `polygons` [(n, 2), ...] with their radii."""
        radii = np.array(rho, dtype=np.float64)
        lengths = np.array([0, *map(len, polygons)], dtype=np.int64)
        pairs = list(zip(polygons, radii, strict=True))
        boxes = [[*(polygon.min(axis=0) - r), *(polygon.max(axis=0) + r)] for polygon, r in pairs]
        return cls(
            np.ascontiguousarray(np.vstack([np.empty((0, 2)), *polygons])),
            np.cumsum(lengths),
            radii,
            np.array(boxes, dtype=np.float64).reshape(-1, 4),
            np.vstack([np.empty((0, 2)), *(circumscribed(polygon, r) for polygon, r in pairs)]),
            np.vstack([np.empty((0, 4)), *(_tangent_normals(polygon, r) for polygon, r in pairs)]),
        )

    @classmethod
    def union(cls, sets: Iterable[Self]) -> Self:
        """All obstacles of `sets`, none if there are no sets."""
        members = [s for s in sets if len(s)] or [cls.of([], [])]
        if len(members) == 1:
            return members[0]
        offsets = np.cumsum([0, *(len(s.vertices) for s in members)])
        first = [s.first[:-1] + offset for s, offset in zip(members, offsets[:-1], strict=True)]
        return cls(
            np.concatenate([s.vertices for s in members]),
            np.concatenate([*first, offsets[-1:]]).astype(np.int64),
            np.concatenate([s.rho for s in members]),
            np.concatenate([s.boxes for s in members]),
            np.concatenate([s.corners for s in members]),
            np.concatenate([s.normals for s in members]),
        )

    def moved(self, by: FloatArray) -> Self:
        """The set translated by the vector `by` (2,) [m]."""
        # `np.tile` and `dataclasses.replace` would take longer than all the rest.
        boxes = self.boxes + np.concatenate([by, by])
        return type(self)(self.vertices + by, self.first, self.rho, boxes, self.corners + by, self.normals)

    def joined(self, other: Self, by: FloatArray) -> Self:
        """These obstacles and those of `other` translated by the vector `by` (2,) [m]; what searches do most often."""
        arrays = kernel.joined(*self.arrays, *other.arrays, by)
        corners = np.concatenate([self.corners, other.corners + by])
        return type(self)(*arrays, corners, np.concatenate([self.normals, other.normals]))

    def with_free_corners(self) -> Self:
        """The same obstacles; corners that lie in one of them are dropped."""
        free = kernel.points_free(self.corners, *self.arrays)
        return replace(self, corners=self.corners[free], normals=self.normals[free])

    def near(self, box: FloatArray) -> Self:
        """The obstacles whose boxes meet the rectangle `box` (2, 2) [m], lower and upper corner; no corners."""
        keep = ((self.boxes[:, :2] < box[1]) & (self.boxes[:, 2:] > box[0])).all(axis=1)
        counts = np.diff(self.first)
        return type(self)(
            self.vertices[np.repeat(keep, counts)],
            np.concatenate([[0], np.cumsum(counts[keep])]),
            self.rho[keep],
            self.boxes[keep],
            np.empty((0, 2)),
            np.empty((0, 4)),
        )

    def __len__(self) -> int:
        return len(self.rho)

    @property
    def arrays(self) -> tuple[FloatArray, kernel.IntArray, FloatArray, FloatArray]:
        """The arguments of the kernel functions."""
        return self.vertices, self.first, self.rho, self.boxes


@dataclass(frozen=True, eq=False)
class ConfigurationSpace:
    """Where a moving body's reference point may be: inside `bounds` and in no obstacle.

    Attributes:
        obstacles: Forbidden open sets.
        bounds: (2, 2) [m] lower and upper corner; its border is allowed.
    """

    obstacles: ObstacleSet
    bounds: FloatArray

    def points_free(self, points: FloatArray) -> kernel.BoolArray:
        """For each of `points` (n, 2) whether it is free."""
        points = np.ascontiguousarray(points)
        return np.asarray(kernel.points_free_within(points, self.bounds, *self.obstacles.arrays))

    def point_free(self, point: FloatArray) -> bool:
        """Whether `point` (2,) is free."""
        return bool(self.points_free(point[None])[0])

    def segment_free(self, a: FloatArray, b: FloatArray) -> bool:
        """Whether the straight motion from `a` to `b` (2,), both within the bounds, is free; exact."""
        return bool(kernel.segment_free(a[0], a[1], b[0], b[1], *self.obstacles.arrays))

    def segments_free(self, starts: FloatArray, ends: FloatArray) -> kernel.BoolArray:
        """For each pair of rows of (n, 2) arrays within the bounds whether the straight motion is free; exact."""
        starts, ends = np.broadcast_arrays(starts, ends)
        return np.asarray(
            kernel.segments_free(np.ascontiguousarray(starts), np.ascontiguousarray(ends), *self.obstacles.arrays)
        )

    def path_free(self, path: FloatArray) -> bool:
        """Whether the polyline `path` (n, 2) is free."""
        return bool(self.points_free(path).all() and self.segments_free(path[:-1], path[1:]).all())


def circumscribed(polygon: FloatArray, rho: float) -> FloatArray:
    """The vertices (C, 2) [m] of a polygon around `polygon` (n, 2) inflated by `rho`, its edges tangent to it.

    Arcs are replaced by tangents at most `_ARC_STEP` apart, the tangents of the adjacent edges among them. They run
    half a numeric slack outside, so a path along them is free; in a passage without clearance between parallel walls
    it is free on both sides. A negative `rho` shrinks the polygon and adds no vertices.
    """
    outset = rho + NUMERIC_SLACK / 2
    vertices, angles, halves = _corner_angles(polygon, rho)
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    return np.asarray(vertices + outset / np.cos(halves)[:, None] * directions)


def _tangent_normals(polygon: FloatArray, rho: float) -> FloatArray:
    """For each corner of `circumscribed` the x and y of the normals of the edge before and the edge behind (C, 4).

    Behind both tangents there is free space still, between corner and arc; a grasp may lie there. It is nowhere deeper
    behind both than in the middle of the arc, rho (1 - cos(half the turn)).
    """
    _, angles, halves = _corner_angles(polygon, rho)
    before, behind = angles - halves, angles + halves
    deepest = max(rho, 0.0) * (1 - np.cos(halves)) + _MARGIN
    return np.column_stack([np.cos(before), np.sin(before), np.cos(behind), np.sin(behind)]) / deepest[:, None]


def _corner_angles(polygon: FloatArray, rho: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Of each corner of `circumscribed` the nearest vertex (C, 2), the direction there, and half the turn (C,) [rad]."""
    if len(polygon) == 1:
        normals, turns = np.array([0.0]), np.array([2 * np.pi])
    else:
        edges = polygon - np.roll(polygon, 1, axis=0)
        normals = np.arctan2(-edges[:, 0], edges[:, 1])
        turns = (np.roll(normals, -1) - normals) % (2 * np.pi)
    steps = np.maximum(1, np.ceil(turns / _ARC_STEP - 1e-9)).astype(int) if rho > 0 else np.ones(len(polygon), int)
    halves = np.repeat(turns / (2 * steps), steps)
    step = np.concatenate([np.arange(n) for n in steps])
    return np.repeat(polygon, steps, axis=0), np.repeat(normals, steps) + halves * (2 * step + 1), halves


def agent_obstacles(agent: Agent, body: Body, tolerance: float) -> ObstacleSet:
    """Forbidden agent centres relative to the position of `body`."""
    if not heights_meet(body.bottom_top, (0.0, agent.height)):
        return ObstacleSet.of([], [])
    rho = [agent.radius + part.edge_radius - tolerance - NUMERIC_SLACK for part in body.parts]
    return ObstacleSet.of(body.cores, rho)


def contact_border(radius: float, body: Body) -> ObstacleSet:
    """Around `body`, relative to its position: a disc of `radius` [m] touches it where its centre is on the border."""
    return ObstacleSet.of(body.cores, [radius + part.edge_radius for part in body.parts])


def body_obstacles(moving: Body, body: Body, tolerance: float) -> ObstacleSet:
    """Forbidden positions of `moving` relative to the position of `body`."""
    if not heights_meet(moving.bottom_top, body.bottom_top):
        return ObstacleSet.of([], [])
    pairs = [(i, j) for i in range(len(moving.parts)) for j in range(len(body.parts))]
    return ObstacleSet.of(
        [minkowski_sum(body.cores[j], -moving.cores[i]) for i, j in pairs],
        [moving.parts[i].edge_radius + body.parts[j].edge_radius - tolerance - NUMERIC_SLACK for i, j in pairs],
    )


def sight_obstacles(body: Body, tolerance: float) -> ObstacleSet:
    """What of `body` blocks a line of sight, relative to its position; touching does not block."""
    rho = [part.edge_radius - tolerance - NUMERIC_SLACK for part in body.parts]
    return ObstacleSet.of(body.cores, rho)
