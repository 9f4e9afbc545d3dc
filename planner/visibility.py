"""Shortest paths of a point among convex obstacles, exactly: a visibility graph searched by Dijkstra's algorithm.

A shortest path among polygons turns at their convex vertices only (Lozano-Perez and Wesley 1979). Obstacles with
rounded edges enter by the tight polygons of `ObstacleSet.corners`, whose edges are tangent to them, so a corridor
between parallel walls is passable even without clearance; every edge is checked against the rounded shapes
themselves. Nothing is sampled: of the free space only slivers between two arcs that the tangents cut off are lost.

Most pairs of corners do not see each other, and most of these because the line between them enters the obstacle of one
of them right there: it lies behind both tangents that meet in the corner. Two scalar products tell, so the collision
test is left with a fifth of the pairs.

One tree answers every query from its start, which is what a search asks: where can the agent, or the agent with an
object, get to from here?

Arrays of the compiled functions: `points (n, 2)` [m] the start and the free corners; `normals (n, 4)` their tangents,
see `ObstacleSet`, zero for the start; `distance (n,)` [m] from the start, infinite where no path leads; `previous (n,)`
the point before on the shortest path, -1 if there is none; then the obstacles, see `planner.kernel`.
"""

import math
from collections.abc import Callable

import numpy as np
from numba import njit

from converter.polyline import path_length
from converter.shape import FloatArray
from planner.configuration_space import ConfigurationSpace
from planner.kernel import BoolArray, IntArray, points_free_within, segment_free
from planner.motion import MotionResult


@njit(cache=True)
def _enters(normals: FloatArray, corner: int, dx: float, dy: float) -> bool:
    """Whether the line from a corner by (dx, dy) surely enters the corner's own obstacle."""
    before = normals[corner, 0] * dx + normals[corner, 1] * dy
    behind = normals[corner, 2] * dx + normals[corner, 3] * dy
    return bool(before < -1.0 and behind < -1.0)


@njit(cache=True)
def _shortest_tree(
    points: FloatArray,
    normals: FloatArray,
    vertices: FloatArray,
    first: IntArray,
    rho: FloatArray,
    boxes: FloatArray,
) -> tuple[FloatArray, IntArray]:
    """`distance` and `previous` of all points over free straight edges."""
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
        x, y = points[best, 0], points[best, 1]
        for i in range(n):
            to_x, to_y = points[i, 0], points[i, 1]
            through = distance[best] + math.sqrt((to_x - x) ** 2 + (to_y - y) ** 2)
            if settled[i] or through >= distance[i]:
                continue
            if _enters(normals, best, to_x - x, to_y - y) or _enters(normals, i, x - to_x, y - to_y):
                continue
            if segment_free(x, y, to_x, to_y, vertices, first, rho, boxes):
                distance[i] = through
                previous[i] = best
    return distance, previous


@njit(cache=True)
def _grown(
    start: FloatArray,
    corners: FloatArray,
    tangents: FloatArray,
    bounds: FloatArray,
    vertices: FloatArray,
    first: IntArray,
    rho: FloatArray,
    boxes: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray, IntArray]:
    """`points`, `normals`, `distance` and `previous` of a tree; `tangents` (k, 4) are the normals of all `corners`."""
    free = np.flatnonzero(points_free_within(corners, bounds, vertices, first, rho, boxes))
    points, normals = np.empty((len(free) + 1, 2)), np.zeros((len(free) + 1, 4))
    points[0] = start
    points[1:] = corners[free]
    normals[1:] = tangents[free]
    distance, previous = _shortest_tree(points, normals, vertices, first, rho, boxes)
    return points, normals, distance, previous


@njit(cache=True)
def _last_turn(
    x: float,
    y: float,
    points: FloatArray,
    normals: FloatArray,
    distance: FloatArray,
    vertices: FloatArray,
    first: IntArray,
    rho: FloatArray,
    boxes: FloatArray,
) -> int:
    """The point from which the straight edge to (x, y) completes a shortest path; -1 if no point sees it."""
    turn, least = -1, np.inf
    for i in range(len(points)):
        dx, dy = x - points[i, 0], y - points[i, 1]
        through = distance[i] + math.sqrt(dx * dx + dy * dy)
        if through >= least or _enters(normals, i, dx, dy):
            continue
        if segment_free(points[i, 0], points[i, 1], x, y, vertices, first, rho, boxes):
            turn, least = i, through
    return turn


@njit(cache=True)
def _seen(
    goals: FloatArray,
    points: FloatArray,
    normals: FloatArray,
    distance: FloatArray,
    bounds: FloatArray,
    vertices: FloatArray,
    first: IntArray,
    rho: FloatArray,
    boxes: FloatArray,
) -> BoolArray:
    """For each of `goals` (m, 2) whether it is free and a point of the tree sees it."""
    free = points_free_within(goals, bounds, vertices, first, rho, boxes)
    seen = np.zeros(len(goals), np.bool_)
    for k in np.flatnonzero(free):
        x, y = goals[k, 0], goals[k, 1]
        for i in range(len(points)):
            if distance[i] == np.inf or _enters(normals, i, x - points[i, 0], y - points[i, 1]):
                continue
            if segment_free(points[i, 0], points[i, 1], x, y, vertices, first, rho, boxes):
                seen[k] = True
                break
    return seen


@njit(cache=True)
def _nearest_on_edges(
    positions: FloatArray, points: FloatArray, distance: FloatArray, previous: IntArray
) -> FloatArray:
    """For each of `positions` (m, 2) the nearest point (m, 2) on the edges of the tree, its start among them."""
    nearest = np.empty_like(positions)
    for k in range(len(positions)):
        x, y = positions[k, 0], positions[k, 1]
        least = np.inf
        for i in range(len(points)):
            if distance[i] == np.inf:
                continue
            j = previous[i] if previous[i] >= 0 else i
            ax, ay = points[j, 0], points[j, 1]
            ex, ey = points[i, 0] - ax, points[i, 1] - ay
            along = ((x - ax) * ex + (y - ay) * ey) / max(ex * ex + ey * ey, 1e-18)
            along = min(1.0, max(0.0, along))
            on_x, on_y = ax + along * ex, ay + along * ey
            squared = (on_x - x) ** 2 + (on_y - y) ** 2
            if squared < least:
                least = squared
                nearest[k, 0], nearest[k, 1] = on_x, on_y
    return nearest


class ShortestPathTree:
    """Shortest paths from one start to anywhere in a configuration space.

    Args:
        space: Where the point may be.
        start: (2,) [m], a free point of `space`.
    """

    def __init__(self, space: ConfigurationSpace, start: FloatArray) -> None:
        obstacles = space.obstacles
        self.space = space
        self._points, self._normals, self._distance, self._previous = _grown(
            start, obstacles.corners, obstacles.normals, space.bounds, *obstacles.arrays
        )

    @property
    def turns(self) -> FloatArray:
        """The corners (k, 2) [m] that can be reached: where contact ends a straight motion, or shortest paths turn."""
        return np.asarray(self._points[1:][np.isfinite(self._distance[1:])])

    @property
    def edges(self) -> FloatArray:
        """The straight motions (k, 2, 2) [m] of which the tree consists, each from the point before to a turn."""
        reached = np.flatnonzero(self._previous >= 0)
        return np.stack([self._points[self._previous[reached]], self._points[reached]], axis=1)

    def reaches(self, goals: FloatArray) -> BoolArray:
        """For each of `goals` (n, 2) whether a free path leads to it."""
        obstacles = self.space.obstacles.arrays
        goals = np.ascontiguousarray(goals)
        return np.asarray(_seen(goals, self._points, self._normals, self._distance, self.space.bounds, *obstacles))

    def path_to(self, goal: FloatArray) -> FloatArray | None:
        """The shortest path (n, 2) [m] from the start to `goal` (2,), or None if there is none."""
        if not self.space.point_free(goal):
            return None
        obstacles = self.space.obstacles.arrays
        turn = int(_last_turn(goal[0], goal[1], self._points, self._normals, self._distance, *obstacles))
        if turn < 0:
            return None
        path = [goal]
        while turn >= 0:
            path.append(self._points[turn])
            turn = int(self._previous[turn])
        return np.array(path[::-1])

    def nearest_points(self, positions: FloatArray) -> FloatArray:
        """For each of `positions` (n, 2) the nearest point (n, 2) on the edges of the tree, all of which are free."""
        positions = np.ascontiguousarray(positions)
        return np.asarray(_nearest_on_edges(positions, self._points, self._distance, self._previous))


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
    return MotionResult(min(paths, key=path_length, default=None), 0)
