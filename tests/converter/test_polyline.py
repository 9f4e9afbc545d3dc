"""Lengths of polylines."""

import numpy as np

from converter.polyline import path_length


def test_lengths_of_known_polylines():
    """A point has no length; a 3-4-5 triangle walked around has 12 m."""
    assert path_length(np.array([[1.0, 2.0]])) == 0
    assert path_length(np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 4.0], [0.0, 0.0]])) == 12
