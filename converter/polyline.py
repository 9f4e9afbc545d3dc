"""Polylines: way-points joined by straight lines."""

import numpy as np

from converter.shape import FloatArray


def path_length(path: FloatArray) -> float:
    """Length [m] of the polyline `path` (n, 2); 0 for a single point."""
    return float(np.hypot(*np.diff(path, axis=0).T).sum())
