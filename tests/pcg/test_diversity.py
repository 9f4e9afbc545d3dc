from dataclasses import replace
from itertools import combinations, islice

import numpy as np
import pytest

from pcg.diversity import Descriptors, goal_cell_entropy, mean_hamming_distance
from pcg.generate import random_levels
from pcg.level import Level
from pcg.symmetry import symmetries

LEVELS = [generated.level for generated in islice(random_levels(5), 12)]


def test_hamming_distance_is_that_of_pairs():
    """The mean over all pairs, counted one by one."""
    by_pairs = [np.mean(a.tiles != b.tiles) for a, b in combinations(LEVELS, 2)]
    assert mean_hamming_distance(LEVELS) == pytest.approx(np.mean(by_pairs))
    assert mean_hamming_distance([LEVELS[0], LEVELS[0]]) == 0
    assert mean_hamming_distance(LEVELS[:1]) is None


def test_entropy_of_known_distributions():
    """One cell 0 bits, four cells alike 2 bits, three quarters and a quarter 0.811 bits."""
    crates = [(0, 0), (0, 1), (1, 0), (1, 1)]
    level = Level.of(np.zeros((2, 2), dtype=np.bool_), crates=crates)
    named = [replace(level, goal_crate=cell) for cell in crates]
    assert goal_cell_entropy([named[0]] * 4) == 0
    assert goal_cell_entropy(named) == 2
    assert goal_cell_entropy([named[0]] * 3 + [named[1]]) == pytest.approx(0.8113, abs=1e-4)
    assert goal_cell_entropy([]) is None


def test_distances_do_not_see_symmetries():
    """Turned and mirrored levels are at distance 0 from each other and equally far from others."""
    images = [image for level in LEVELS[:3] for image in symmetries(level)]
    descriptors = Descriptors.of(images)
    for index in range(len(images)):
        distances = descriptors.distances_to(index).reshape(3, 8)
        assert distances.max(axis=1) == pytest.approx(distances.min(axis=1))
        assert distances[index // 8] == pytest.approx(0)


def test_distances_are_symmetric_and_bounded():
    """Either way the same, from 0 to 1, and 0 to itself."""
    descriptors = Descriptors.of(LEVELS)
    matrix = np.array([descriptors.distances_to(index) for index in range(len(LEVELS))])
    assert matrix == pytest.approx(matrix.T)
    assert np.diag(matrix) == pytest.approx(0)
    assert matrix.min() >= 0
    assert 0.1 < matrix[~np.eye(len(LEVELS), dtype=np.bool_)].min() < matrix.max() <= 1


def test_a_distance_by_hand():
    """Same walls, the target moved by 2 of at most 4 steps: a half of a third of a half."""
    wall = np.zeros((3, 3), dtype=np.bool_)
    wall[0, 1] = True
    level, moved = (
        Level.of(wall, players=[(0, 0)], crates=[(1, 1)], targets=[target], goal_crate=(1, 1))
        for target in ((2, 0), (2, 2))
    )
    assert Descriptors.of([level, moved]).distances_to(0)[1] == pytest.approx(2 / 4 / 3 / 2)
