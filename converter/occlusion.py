"""Whether the agent sees the goal-object at the start: the line of sight of [L] on the geometry of a scene.

The open segment between the two centres must not meet the interior of a wall or of another object; touching does not
block. A part is a convex core polygon and a disc of radius r, so it is met if the segment enters the core, or comes
closer to it than r.
"""

import numpy as np

from converter.scene import NUMERIC_SLACK, Body, Scene
from converter.shape import FloatArray


def occluded(scene: Scene) -> bool:
    """Whether a wall or another object hides the goal-object from the agent.

    A body counts if its height interval overlaps that of the agent or of the goal-object.
    """
    goal_object = scene.goal_object
    start, end = scene.agent.position, goal_object.position[:2]
    others = [body for body in (*scene.walls, *scene.objects) if body is not goal_object]
    intervals = ((0.0, scene.agent.height), goal_object.bottom_top)
    return any(
        _overlap(body.bottom_top, interval) and body_blocks(body, start, end)
        for body in others
        for interval in intervals
    )


def body_blocks(body: Body, start: FloatArray, end: FloatArray) -> bool:
    """Whether the segment from `start` to `end`, both (2,) [m] in the world, meets the interior of the body."""
    for core, part in zip(body.cores, body.parts, strict=True):
        polygon = core + body.position[:2]
        if _enters(start, end, polygon):
            return True
        if part.edge_radius > 0 and _distance(start, end, polygon) < part.edge_radius - NUMERIC_SLACK:
            return True
    return False


def _overlap(a: tuple[float, float], b: tuple[float, float]) -> bool:
    return min(a[1], b[1]) - max(a[0], b[0]) > NUMERIC_SLACK


def _enters(start: FloatArray, end: FloatArray, polygon: FloatArray) -> bool:
    """Whether a segment meets the interior of a convex (n, 2) polygon: no axis separates the two.

    The axes that can separate them are the normals of the polygon's edges and that of the segment.
    """
    segment = np.stack([start, end])
    edges = np.vstack([np.roll(polygon, -1, axis=0) - polygon, end - start])
    lengths = np.hypot(*edges.T)
    edges = edges[lengths > 0] / lengths[lengths > 0, np.newaxis]
    normals = np.stack([edges[:, 1], -edges[:, 0]])
    a, b = segment @ normals, polygon @ normals
    gaps = np.maximum(a.min(axis=0) - b.max(axis=0), b.min(axis=0) - a.max(axis=0))
    return bool((gaps < -NUMERIC_SLACK).all())


def _distance(start: FloatArray, end: FloatArray, polygon: FloatArray) -> float:
    """Distance [m] between a segment and a convex (n, 2) polygon that it does not enter."""
    following = np.roll(polygon, -1, axis=0)
    from_ends = min(_point_distance(point, polygon, following) for point in (start, end))
    from_vertices = min(_point_distance(vertex, start[np.newaxis], end[np.newaxis]) for vertex in polygon)
    return min(from_ends, from_vertices)


def _point_distance(point: FloatArray, starts: FloatArray, ends: FloatArray) -> float:
    """Distance [m] from a point (2,) to the nearest of n segments, (n, 2) each."""
    along = ends - starts
    squares = np.maximum((along**2).sum(axis=1), np.finfo(np.float64).tiny)
    t = np.clip(((point - starts) * along).sum(axis=1) / squares, 0.0, 1.0)
    return float(np.hypot(*(starts + t[:, np.newaxis] * along - point).T).min())
