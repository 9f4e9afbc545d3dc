"""Compiled RRT-Connect: equal to a plain twin, bounded, at home in narrow corridors; the rest is in `test_motion`."""

from itertools import count

import numpy as np
import pytest

from converter.shape import FloatArray
from planner.configuration_space import ConfigurationSpace, ObstacleSet
from planner.motion import MotionResult
from planner.rrt_connect import BATCH, HALVINGS, rrt_connect
from tests.planner.scenes import vectors

BOUNDS = vectors([-2, -2], [2, 2])
BARRIER = vectors([-0.1, -2], [0.1, -2], [0.1, 1.5], [-0.1, 1.5])
CLOSED = vectors([-0.1, -2], [0.1, -2], [0.1, 2], [-0.1, 2])
LEFT, RIGHT = vectors([-1, -1], [1, -1])


def space_with(*cores: FloatArray, rho: float = 0.1) -> ConfigurationSpace:
    """A square of 4 m with these obstacles."""
    return ConfigurationSpace(ObstacleSet.of(cores, [rho] * len(cores)), BOUNDS)


def random_space(rng: np.random.Generator) -> ConfigurationSpace:
    """A square of 4 m with eight turned boxes."""
    corners = vectors([-1, -1], [1, -1], [1, 1], [-1, 1])
    cores = []
    for angle in rng.uniform(0, np.pi, 8):
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        cores.append(rng.uniform(-2, 2, 2) + corners * rng.uniform(0.02, 0.6, 2) @ turn)
    return space_with(*cores)


def query(space: ConfigurationSpace, *goals: FloatArray, seed: int = 0, iterations: int = 5000) -> MotionResult:
    """A query from the left side."""
    return rrt_connect(space, LEFT, np.array(goals or [RIGHT]), iterations, np.random.default_rng(seed))


def plain_twin(
    space: ConfigurationSpace, start: FloatArray, goal: FloatArray, max_iterations: int, rng: np.random.Generator
) -> tuple[FloatArray | None, int]:
    """The same algorithm with lists, one test at a time, from the same random numbers."""
    trees, parents = [[start], [goal]], [[-1], [-1]]

    def nearest(tree: int, place: FloatArray) -> int:
        return int(np.argmin([(node[0] - place[0]) ** 2 + (node[1] - place[1]) ** 2 for node in trees[tree]]))

    def branch(tree: int, node: int) -> list[FloatArray]:
        return [] if node < 0 else [trees[tree][node], *branch(tree, parents[tree][node])]

    samples = np.empty((0, 2))
    for iteration in range(max_iterations):
        if iteration == len(samples):
            shares = rng.random((min(BATCH, max_iterations - iteration), 2))
            samples = np.vstack([samples, space.bounds[0] + (space.bounds[1] - space.bounds[0]) * shares])
        tree = int(len(trees[0]) > len(trees[1]))
        parent = nearest(tree, samples[iteration])
        origin = trees[tree][parent]
        steps = [samples[iteration]]
        for _ in range(HALVINGS):
            steps.append((origin + steps[-1]) / 2)
        free = [to for to in steps if space.segment_free(*(origin, to)[:: 1 - 2 * tree])]
        if not free:
            continue
        trees[tree].append(free[0])
        parents[tree].append(parent)
        nodes = [len(trees[tree]) - 1, nearest(1 - tree, free[0])][:: 1 - 2 * tree]
        if space.segment_free(trees[0][nodes[0]], trees[1][nodes[1]]):
            return np.array(branch(0, nodes[0])[::-1] + branch(1, nodes[1])), iteration + 1
    return None, max_iterations


@pytest.mark.parametrize("seed", range(40))
def test_agrees_with_the_plain_twin(seed: int):
    """Path and iterations are those of the plain twin, number by number; more than a batch of them among the queries."""
    rng = np.random.default_rng(seed)
    space = random_space(rng) if seed % 4 else space_with(BARRIER, rho=0.1 + 0.001 * seed)
    draws = rng.uniform(*BOUNDS, (100, 2))
    start, goal = draws[space.points_free(draws)][:2] if seed % 4 else (LEFT, RIGHT)
    path, iterations = plain_twin(space, start, goal, BATCH + 50, np.random.default_rng(seed))
    result = rrt_connect(space, start, goal[None], BATCH + 50, np.random.default_rng(seed))
    assert result.iterations == iterations
    if path is None:
        assert result.path is None
    else:
        np.testing.assert_array_equal(result.path, path)


def test_more_goals_than_a_tree_begins_with():
    """There is room for any number of goals."""
    space = space_with(CLOSED)
    goals = np.column_stack([np.full(5000, 1.0), np.linspace(-2, 2, 5000)])
    result = rrt_connect(space, LEFT, goals, 3 * BATCH, np.random.default_rng(0))
    assert (result.path, result.iterations) == (None, 3 * BATCH)
    assert query(space_with(BARRIER), *goals).path is not None


@pytest.mark.parametrize("iterations", [0, 1, BATCH, BATCH + 1, 10 * BATCH])
def test_iterations_are_bounded(iterations: int):
    """Where there is no way, the query ends after exactly as many iterations as allowed."""
    result = query(space_with(CLOSED), iterations=iterations)
    assert (result.path, result.iterations) == (None, iterations)


def test_the_query_can_be_stopped():
    """Before each batch it is asked whether to stop."""
    asked = count(1)
    result = rrt_connect(
        space_with(CLOSED), LEFT, RIGHT[None], 10**9, np.random.default_rng(0), lambda: next(asked) == 4
    )
    assert (result.path, result.iterations) == (None, 3 * BATCH)


def test_narrow_corridors():
    """Halved steps find the way through a slit 0.1 m wide and 0.4 m long."""
    slit = [
        vectors([-0.2, -2], [0.2, -2], [0.2, 0], [-0.2, 0]),
        vectors([-0.2, 0.1], [0.2, 0.1], [0.2, 2], [-0.2, 2]),
    ]
    space = space_with(*slit, rho=-1e-9)
    for seed in range(10):
        path = query(space, seed=seed, iterations=20_000).path
        assert path is not None
        assert space.path_free(path)
