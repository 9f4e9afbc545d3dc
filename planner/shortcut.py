"""Shorter paths of the same homotopy class or a neighbouring one, by exact straight shortcuts."""

import numpy as np

from converter.shape import FloatArray
from planner.configuration_space import ConfigurationSpace


def shortcut(path: FloatArray, space: ConfigurationSpace, rounds: int, rng: np.random.Generator) -> FloatArray:
    """A path (m, 2) [m] with the ends of `path` (n, 2), free and never longer.

    Each round joins two random points of the path by a straight line where that is free (Geraerts and Overmars 2007);
    then every way-point is dropped that its neighbours do not need.
    """
    path = without_needless_points(path, space)
    for _ in range(rounds):
        if len(path) <= 2:
            break
        path = _joined_at_random(path, space, rng)
    return without_needless_points(path, space)


def without_needless_points(path: FloatArray, space: ConfigurationSpace) -> FloatArray:
    """From each way-point on goes straight to the last one that it sees."""
    kept, i = [0], 0
    while i < len(path) - 1:
        j = len(path) - 1
        while j > i + 1 and not space.segment_free(path[i], path[j]):
            j -= 1
        kept.append(j)
        i = j
    return path[kept]


def _joined_at_random(path: FloatArray, space: ConfigurationSpace, rng: np.random.Generator) -> FloatArray:
    lengths = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
    from_length, to_length = np.sort(rng.uniform(0.0, lengths[-1], 2))
    a, b = (np.array([np.interp(s, lengths, path[:, axis]) for axis in range(2)]) for s in (from_length, to_length))
    before, after = path[lengths < from_length], path[lengths > to_length]
    if len(before) + len(after) == len(path) or not space.segment_free(a, b):
        return path
    candidate = np.vstack([before, a, b, after])
    # Rounding moves a point on the old line by 1e-16 m; where there is no clearance that may matter.
    return candidate if space.path_free(candidate) else path
