"""Motion planning by sampling, compiled: RRT-Connect (Kuffner and LaValle, ICRA 2000) on the exact collision test.

Two trees grow, one from the start and one from the goals, until they meet. In every iteration the smaller one extends
from its nearest node towards a uniform sample; then the other one tries to connect its nearest node with the one that
this added. Since one test decides a motion of any length, there are no small steps, which changes two things:

- A tree extends all the way to its target, and where that is blocked half as far, and half again, up to `HALVINGS`
  times. Long steps cross open space at once, halved ones find their way into narrow corridors.
- Connecting is one test, which adds nothing where it fails.

Samples are drawn in batches from the caller's generator, so its seed fixes the path.
"""

from collections.abc import Callable

import numpy as np
from numba import njit

from converter.shape import FloatArray
from planner.configuration_space import ConfigurationSpace, ObstacleSet
from planner.kernel import IntArray, segment_free
from planner.motion import MotionResult

HALVINGS = 4
"""How often a blocked step is halved: fewer lose the corridors without clearance, more cost time everywhere."""

BATCH = 256
"""Iterations between two questions whether to stop."""

START, GOAL = 0, 1
"""The two trees."""


@njit(cache=True)
def _nearest(nodes: FloatArray, tree: int, size: int, x: float, y: float) -> int:
    """The node of a tree that is nearest to (x, y)."""
    nearest, least = 0, np.inf
    for i in range(size):
        dx, dy = nodes[tree, i, 0] - x, nodes[tree, i, 1] - y
        squared = dx * dx + dy * dy
        if squared < least:
            nearest, least = i, squared
    return nearest


@njit(cache=True)
def _extend(
    nodes: FloatArray,
    parents: IntArray,
    sizes: IntArray,
    tree: int,
    x: float,
    y: float,
    vertices: FloatArray,
    first: IntArray,
    rho: FloatArray,
    boxes: FloatArray,
) -> bool:
    """Adds a node to a tree, from its nearest one towards (x, y), unless all steps there are blocked."""
    added = sizes[tree]
    parent = _nearest(nodes, tree, added, x, y)
    from_x, from_y = nodes[tree, parent, 0], nodes[tree, parent, 1]
    for _ in range(1 + HALVINGS):
        # Rounding may tell a motion from its reverse where there is no clearance, so it is tested as it will be driven.
        if tree == START:
            free = segment_free(from_x, from_y, x, y, vertices, first, rho, boxes)
        else:
            free = segment_free(x, y, from_x, from_y, vertices, first, rho, boxes)
        if free:
            nodes[tree, added, 0], nodes[tree, added, 1] = x, y
            parents[tree, added] = parent
            sizes[tree] += 1
            return True
        x, y = (from_x + x) / 2, (from_y + y) / 2
    return False


@njit(cache=True)
def _grow(
    nodes: FloatArray,
    parents: IntArray,
    sizes: IntArray,
    samples: FloatArray,
    vertices: FloatArray,
    first: IntArray,
    rho: FloatArray,
    boxes: FloatArray,
) -> tuple[int, int, int]:
    """Grows the trees by an iteration for each of `samples` until they meet.

    Args:
        nodes: (2, capacity, 2) [m] of the start's tree and of the goals' tree.
        parents: (2, capacity) the node that each was reached from; -1 for roots.
        sizes: (2,) nodes of each tree; there is room for one more per sample.
        samples: (k, 2) [m].
        vertices: This and the rest: the obstacles, see `planner.kernel`.
        first: See there.
        rho: See there.
        boxes: See there.

    Returns:
        Iterations, and the node of each tree at which a free edge joins them; -1 and -1 if they did not meet.
    """
    for k in range(len(samples)):
        tree = START if sizes[START] <= sizes[GOAL] else GOAL
        x, y = samples[k, 0], samples[k, 1]
        if not _extend(nodes, parents, sizes, tree, x, y, vertices, first, rho, boxes):
            continue
        added = sizes[tree] - 1
        other = _nearest(nodes, 1 - tree, sizes[1 - tree], nodes[tree, added, 0], nodes[tree, added, 1])
        i, j = (added, other) if tree == START else (other, added)
        (ax, ay), (bx, by) = nodes[START, i], nodes[GOAL, j]
        if segment_free(ax, ay, bx, by, vertices, first, rho, boxes):
            return k + 1, i, j
    return len(samples), -1, -1


def rrt_connect(
    space: ConfigurationSpace,
    start: FloatArray,
    goals: FloatArray,
    max_iterations: int,
    rng: np.random.Generator,
    should_stop: Callable[[], bool] = lambda: False,
) -> MotionResult:
    """A free path to the first of `goals` that the trees meet; see `planner.motion.MotionPlanner`."""
    free = space.points_free(np.concatenate([start[None], goals]))
    if not free[0] or not free[1:].any():
        return MotionResult(None, 0)
    trees = _Trees(start, goals[free[1:]])
    lower, size = space.bounds[0], space.bounds[1] - space.bounds[0]
    iterations = 0
    while iterations < max_iterations and not should_stop():
        batch = min(BATCH, max_iterations - iterations)
        spent, in_start, in_goal = trees.grow(lower + size * rng.random((batch, 2)), space.obstacles)
        iterations += spent
        if in_start >= 0:
            return MotionResult(trees.path(in_start, in_goal), iterations)
    return MotionResult(None, iterations)


class _Trees:
    """The trees from the start and from the goals; see `_grow` for the arrays."""

    def __init__(self, start: FloatArray, goals: FloatArray) -> None:
        capacity = len(goals) + 2 * BATCH
        self._nodes = np.empty((2, capacity, 2))
        self._parents = np.full((2, capacity), -1)
        self._sizes = np.array([1, len(goals)])
        self._nodes[START, 0] = start
        self._nodes[GOAL, : len(goals)] = goals

    def grow(self, samples: FloatArray, obstacles: ObstacleSet) -> tuple[int, int, int]:
        """See `_grow`."""
        if self._sizes.max() + len(samples) > self._parents.shape[1]:
            self._nodes = np.concatenate([self._nodes, np.empty_like(self._nodes)], axis=1)
            self._parents = np.concatenate([self._parents, np.full_like(self._parents, -1)], axis=1)
        spent, in_start, in_goal = _grow(self._nodes, self._parents, self._sizes, samples, *obstacles.arrays)
        return int(spent), int(in_start), int(in_goal)

    def path(self, in_start: int, in_goal: int) -> FloatArray:
        """The path (n, 2) [m] from the start to a goal over the edge between two nodes."""
        return np.concatenate([self._branch(START, in_start)[::-1], self._branch(GOAL, in_goal)])

    def _branch(self, tree: int, node: int) -> FloatArray:
        """From a node to its root (n, 2) [m]."""
        branch = []
        while node >= 0:
            branch.append(node)
            node = int(self._parents[tree, node])
        return np.asarray(self._nodes[tree, branch])
