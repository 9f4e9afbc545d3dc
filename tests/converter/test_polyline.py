"""Lengths of polylines, distances to segments."""

import numpy as np

from converter.polyline import path_length, point_segment_distances


def test_lengths_of_known_polylines():
    """A point has no length; a 3-4-5 triangle walked around has 12 m."""
    assert path_length(np.array([[1.0, 2.0]])) == 0
    assert path_length(np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 4.0], [0.0, 0.0]])) == 12


def test_distances_of_points_to_segments():
    """Beside a segment the distance is that to its line, beyond its ends that to the end; a segment may be a point."""
    points = np.array([[1.0, 2.0], [-3.0, 4.0], [0.0, 0.0]])
    starts, ends = np.array([[0.0, 0.0], [0.0, 0.0]]), np.array([[2.0, 0.0], [0.0, 0.0]])
    assert np.allclose(point_segment_distances(points, starts, ends), [[2, np.sqrt(5)], [5, 5], [0, 0]])
