"""Shortcuts: free, same ends, never longer."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from converter.shape import FloatArray
from planner.configuration_space import ConfigurationSpace, ObstacleSet
from planner.shortcut import shortcut
from tests.planner.plain_geometry import length, points, polygons
from tests.planner.scenes import vectors

BOUNDS = vectors([-3, -3], [3, 3])
EMPTY = ConfigurationSpace(ObstacleSet.of([], []), BOUNDS)
SQUARE = ConfigurationSpace(ObstacleSet.of([vectors([-1, -1], [1, -1], [1, 1], [-1, 1])], [-1e-9]), BOUNDS)


@settings(deadline=None)
@given(st.lists(points, min_size=1, max_size=8), st.lists(polygons(), max_size=2), st.integers(0, 99))
def test_result_is_free_and_not_longer(path: list[FloatArray], cores: list[FloatArray], seed: int):
    """Whatever the path, the result has its ends, is free and no longer."""
    before = np.array(path)
    space = ConfigurationSpace(ObstacleSet.of(cores, [0.02] * len(cores)), BOUNDS)
    assume(space.path_free(before))
    after = shortcut(before, space, 20, np.random.default_rng(seed))
    np.testing.assert_array_equal(after[[0, -1]], before[[0, -1]])
    assert space.path_free(after)
    assert length(after) <= length(before) + 1e-12


def test_in_the_open_the_ends_remain():
    """Nothing in the way leaves a straight line."""
    zigzag = vectors([0, 0], [1, 1], [2, 0], [2, 2], [0, 1])
    np.testing.assert_array_equal(shortcut(zigzag, EMPTY, 0, np.random.default_rng(0)), zigzag[[0, -1]])
    np.testing.assert_array_equal(shortcut(zigzag, EMPTY, 30, np.random.default_rng(0)), zigzag[[0, -1]])


def test_needed_points_stay():
    """Of a tour around a square the corners stay, points on its edges go."""
    tour = vectors([-2, 0], [-1.5, 0.5], [-1, 1], [0, 1], [1, 1], [2, 0])
    np.testing.assert_array_equal(shortcut(tour, SQUARE, 0, np.random.default_rng(0)), tour[[0, 2, 4, 5]])


def test_random_shortcuts_approach_the_taut_string():
    """A wide tour comes close to the shortest path."""
    tour = vectors([-2, 0], [-2, 2.5], [2, 2.5], [2, 0])
    after = shortcut(tour, SQUARE, 500, np.random.default_rng(0))
    taut = 2 + 2 * np.sqrt(2)
    assert taut <= length(after) + 1e-9
    assert length(after) < 1.05 * taut
    assert length(shortcut(tour, SQUARE, 0, np.random.default_rng(0))) == length(tour)


def test_same_seed_gives_the_same_path():
    """All randomness comes from the generator."""
    tour = vectors([-2, 0], [-2, 2.5], [2, 2.5], [2, 0])
    first, again, other = (shortcut(tour, SQUARE, 20, np.random.default_rng(seed)) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert first.shape != other.shape or (first != other).any()


@pytest.mark.parametrize("path", [[[0.5, 2.0]], [[0.5, 2.0], [0.5, 2.0]], [[0.5, 2.0]] * 4])
def test_paths_without_length(path: list[list[float]]):
    """A path that stays in one place stays a path."""
    after = shortcut(np.array(path), SQUARE, 5, np.random.default_rng(0))
    assert 1 <= len(after) <= 2
    assert (after == path[0]).all()


def test_no_clearance_on_either_side():
    """In a corridor of zero width the path stays free and its ends stay."""
    walls = [vectors([-2, 0], [2, 0], [2, 1], [-2, 1]), vectors([-2, -1], [2, -1], [2, 0], [-2, 0])]
    turn = np.array([[np.cos(0.3), np.sin(0.3)], [-np.sin(0.3), np.cos(0.3)]])
    space = ConfigurationSpace(ObstacleSet.of([wall @ turn for wall in walls], [-1e-9, -1e-9]), BOUNDS)
    path = vectors([-2.5, 0], [-1, 0], [0, 0], [1, 0], [2, 0], [2.2, 1.2]) @ turn
    assert space.path_free(path)
    after = shortcut(path, space, 100, np.random.default_rng(0))
    assert space.path_free(after)
    np.testing.assert_array_equal(after[[0, -1]], path[[0, -1]])
    assert length(after) <= length(path)
