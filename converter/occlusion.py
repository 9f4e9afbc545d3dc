"""Whether the agent sees the goal-object at the start: the line of sight of [L] on the geometry of a scene.

The open segment between the two centres must not meet the interior of a wall or of another object; touching does not
block. A part is a convex core polygon and a disc of radius r, so it is met if the segment enters the core, or comes
closer to it than r.
"""

import numpy as np

from converter.polyline import point_segment_distances
from converter.scene import NUMERIC_SLACK, Body, Scene, heights_meet
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
        any(heights_meet(body.bottom_top, interval) for interval in intervals) and body_blocks(body, start, end)
        for body in others
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
    from_ends = point_segment_distances(np.stack([start, end]), polygon, np.roll(polygon, -1, axis=0))
    from_vertices = point_segment_distances(polygon, start[np.newaxis], end[np.newaxis])
    return float(min(from_ends.min(), from_vertices.min()))
