"""Shortest paths of a point among convex obstacles, exactly: a visibility graph searched by Dijkstra's algorithm.

A shortest path among polygons turns at their convex vertices only (Lozano-Perez and Wesley 1979). Obstacles with
rounded edges enter by the tight polygons of `ObstacleSet.corners`, whose edges are tangent to them, so a corridor
between parallel walls is passable even without clearance; every edge is checked against the rounded shapes
themselves. Nothing is sampled: of the free space only slivers between two arcs that the tangents cut off are lost.

One tree answers every query from its start, which is what a search asks: where can the agent, or the agent with an
object, get to from here?
"""

from collections.abc import Callable

import numpy as np
from numba import njit

from converter.shape import FloatArray
from planner.configuration_space import ConfigurationSpace
from planner.kernel import BoolArray, IntArray, segment_free
from planner.motion import MotionResult


@njit(cache=True)
def _shortest_tree(
    points: FloatArray, vertices: FloatArray, first: IntArray, rho: FloatArray, boxes: FloatArray
) -> tuple[FloatArray, IntArray]:
    """Distances [m] of all `points` (n, 2) from points[0] over free straight edges, and their predecessors."""
    n = len(points)
    distance = np.full(n, np.inf)
    previous = np.full(n, -1)
    settled = np.zeros(n, np.bool_)
    distance[0] = 0.0
    for _ in range(n):
        best = -1
        for i in range(n):
            if not settled[i] and distance[i] < np.inf and (best < 0 or distance[i] < distance[best]):
                best = i
        if best < 0:
            break
        settled[best] = True
        x, y = points[best]
        for i in range(n):
            if settled[i]:
                continue
            through = distance[best] + np.hypot(points[i, 0] - x, points[i, 1] - y)
            if through < distance[i] and segment_free(x, y, points[i, 0], points[i, 1], vertices, first, rho, boxes):
                distance[i] = through
                previous[i] = best
    return distance, previous


@njit(cache=True)
def _best_last_turn(
    goal: FloatArray,
    points: FloatArray,
    distance: FloatArray,
    vertices: FloatArray,
    first: IntArray,
    rho: FloatArray,
    boxes: FloatArray,
) -> int:
    """The point from which the straight edge to `goal` completes a shortest path; -1 if no point sees it."""
    total = distance + np.hypot(points[:, 0] - goal[0], points[:, 1] - goal[1])
    for i in np.argsort(total):
        if total[i] == np.inf:
            break
        if segment_free(points[i, 0], points[i, 1], goal[0], goal[1], vertices, first, rho, boxes):
            return int(i)
    return -1


@njit(cache=True)
def _last_turns(
    goals: FloatArray,
    points: FloatArray,
    distance: FloatArray,
    vertices: FloatArray,
    first: IntArray,
    rho: FloatArray,
    boxes: FloatArray,
) -> IntArray:
    """`_best_last_turn` for each row of `goals` (m, 2)."""
    turns = np.empty(len(goals), np.int64)
    for i in range(len(goals)):
        turns[i] = _best_last_turn(goals[i], points, distance, vertices, first, rho, boxes)
    return turns


class ShortestPathTree:
    """Shortest paths from one start to anywhere in a configuration space.

    Args:
        space: Where the point may be.
        start: (2,) [m], a free point of `space`.
    """

    def __init__(self, space: ConfigurationSpace, start: FloatArray) -> None:
        corners = space.obstacles.corners
        self.space = space
        self._points = np.ascontiguousarray(np.vstack([start[None], corners[space.points_free(corners)]]))
        self._distance, self._previous = _shortest_tree(self._points, *space.obstacles.arrays)

    def reaches(self, goals: FloatArray) -> BoolArray:
        """For each of `goals` (n, 2) whether a free path leads to it."""
        reached = self.space.points_free(goals)
        reached[reached] = self._last_turns(goals[reached]) >= 0
        return reached

    def path_to(self, goal: FloatArray) -> FloatArray | None:
        """The shortest path (n, 2) [m] from the start to `goal` (2,), or None if there is none."""
        if not self.space.point_free(goal):
            return None
        turn = int(self._last_turns(goal[None])[0])
        if turn < 0:
            return None
        path = [goal]
        while turn >= 0:
            path.append(self._points[turn])
            turn = int(self._previous[turn])
        return np.array(path[::-1])

    def nearest_points(self, positions: FloatArray) -> FloatArray:
        """For each of `positions` (n, 2) the nearest point (n, 2) on the edges of the tree, all of which are free."""
        reached = np.flatnonzero(np.isfinite(self._distance))
        ends = self._points[reached]
        starts = self._points[np.where(self._previous[reached] < 0, reached, self._previous[reached])]
        edges = ends - starts
        squared = np.maximum((edges**2).sum(axis=1), 1e-18)
        along = ((positions[:, None] - starts) * edges).sum(axis=2) / squared
        on_edges = starts + np.clip(along, 0.0, 1.0)[..., None] * edges
        nearest = ((on_edges - positions[:, None]) ** 2).sum(axis=2).argmin(axis=1)
        return np.asarray(on_edges[np.arange(len(positions)), nearest])

    def _last_turns(self, goals: FloatArray) -> IntArray:
        return np.asarray(_last_turns(goals, self._points, self._distance, *self.space.obstacles.arrays))


def shortest_path(
    space: ConfigurationSpace,
    start: FloatArray,
    goals: FloatArray,
    max_iterations: int,
    rng: np.random.Generator,
    should_stop: Callable[[], bool] = lambda: False,
) -> MotionResult:
    """The shortest free path to one of `goals`; see `planner.motion.MotionPlanner`. Nothing is drawn or counted."""
    del max_iterations, rng, should_stop
    if not space.point_free(start):
        return MotionResult(None, 0)
    tree = ShortestPathTree(space, start)
    paths = [path for path in map(tree.path_to, goals) if path is not None]
    return MotionResult(min(paths, key=_length, default=None), 0)


def _length(path: FloatArray) -> float:
    return float(np.hypot(*np.diff(path, axis=0).T).sum())
