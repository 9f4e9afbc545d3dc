"""Shorter paths of the same homotopy class or a neighbouring one, by exact straight shortcuts."""

import numpy as np
from numba import njit

from converter.shape import FloatArray
from planner.configuration_space import ConfigurationSpace
from planner.kernel import IntArray, segment_free


def shortcut(path: FloatArray, space: ConfigurationSpace, rounds: int, rng: np.random.Generator) -> FloatArray:
    """A path (m, 2) [m] with the ends of `path` (n, 2), free and never longer.

    Each round joins two random points of the path by a straight line where that is free (Geraerts and Overmars 2007);
    then every way-point is dropped that its neighbours do not need.
    """
    shares = np.sort(rng.random((rounds, 2)))
    return np.asarray(_shortened(np.ascontiguousarray(path), shares, space.bounds, *space.obstacles.arrays))


@njit(cache=True)
def _shortened(
    path: FloatArray,
    shares: FloatArray,
    bounds: FloatArray,
    vertices: FloatArray,
    first: IntArray,
    rho: FloatArray,
    boxes: FloatArray,
) -> FloatArray:
    """See `shortcut`; `shares` (rounds, 2), ascending in each row, say where to join as shares of the length."""
    path = _needed(path, vertices, first, rho, boxes)
    for round_ in range(len(shares)):
        if len(path) <= 2:
            break
        path = _joined(path, shares[round_, 0], shares[round_, 1], bounds, vertices, first, rho, boxes)
    return _needed(path, vertices, first, rho, boxes)


@njit(cache=True)
def _needed(path: FloatArray, vertices: FloatArray, first: IntArray, rho: FloatArray, boxes: FloatArray) -> FloatArray:
    """From each way-point on goes straight to the last one that it sees."""
    kept = np.empty_like(path)
    kept[0] = path[0]
    n, i = 1, 0
    while i < len(path) - 1:
        j = len(path) - 1
        while j > i + 1 and not segment_free(
            path[i, 0], path[i, 1], path[j, 0], path[j, 1], vertices, first, rho, boxes
        ):
            j -= 1
        kept[n] = path[j]
        n, i = n + 1, j
    return kept[:n].copy()


@njit(cache=True)
def _joined(
    path: FloatArray,
    from_share: float,
    to_share: float,
    bounds: FloatArray,
    vertices: FloatArray,
    first: IntArray,
    rho: FloatArray,
    boxes: FloatArray,
) -> FloatArray:
    """`path` with a straight line between two of its points, unless that or its ends are not free."""
    lengths = np.zeros(len(path))
    for k in range(1, len(path)):
        lengths[k] = lengths[k - 1] + np.hypot(path[k, 0] - path[k - 1, 0], path[k, 1] - path[k - 1, 1])
    i, a = _point_at(path, lengths, from_share * lengths[-1])
    j, b = _point_at(path, lengths, to_share * lengths[-1])
    if i == j:
        return path
    # Rounding moves a point on the old line by 1e-16 m; where there is no clearance that may matter.
    line = np.stack((path[i], a, b, path[j + 1]))
    for k in range(3):
        if not segment_free(line[k, 0], line[k, 1], line[k + 1, 0], line[k + 1, 1], vertices, first, rho, boxes):
            return path
    if (line < bounds[0]).any() or (line > bounds[1]).any():
        return path
    return np.concatenate((path[: i + 1], line[1:3], path[j + 1 :]))


@njit(cache=True)
def _point_at(path: FloatArray, lengths: FloatArray, length: float) -> tuple[int, FloatArray]:
    """The point (2,) at a length along `path` (n, 2), and the way-point before it; `lengths` (n,) [m] so far."""
    i = min(int(np.searchsorted(lengths, length, side="right")) - 1, len(path) - 2)
    piece = lengths[i + 1] - lengths[i]
    share = (length - lengths[i]) / piece if piece > 0.0 else 0.0
    return i, path[i] + share * (path[i + 1] - path[i])
