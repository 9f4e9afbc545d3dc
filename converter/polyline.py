"""Polylines, way-points joined by straight lines, and the segments that they consist of."""

import numpy as np

from converter.shape import FloatArray


def path_length(path: FloatArray) -> float:
    """Length [m] of the polyline `path` (n, 2); 0 for a single point."""
    return float(np.hypot(*np.diff(path, axis=0).T).sum())


def point_segment_distances(points: FloatArray, starts: FloatArray, ends: FloatArray) -> FloatArray:
    """(n, m) [m]: the distance of each of n `points` (n, 2) to each of m segments, (m, 2) both."""
    along = ends - starts
    squares = np.maximum((along**2).sum(axis=1), np.finfo(np.float64).tiny)
    offsets = points[:, None] - starts
    t = np.clip((offsets * along).sum(axis=2) / squares, 0.0, 1.0)
    return np.asarray(np.linalg.norm(offsets - t[..., None] * along, axis=2))
