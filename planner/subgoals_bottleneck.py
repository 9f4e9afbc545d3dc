"""Bottleneck subgoals: where many shortest paths of the object lead through (`Btl` of [L], section IV-B).

The free positions of the object are rasterised; neighbouring vertices (8 of them) are joined where the straight
motion of the object is free. Shortest paths lead from the vertices around the object to all vertices. The density of
a vertex is the number of these paths that lead through it, their ends included, divided by the number of vertices;
candidates are drawn with probabilities in proportion to it. Narrow places are dense, since every path to the far side
goes through them; so is the neighbourhood of the object, where all paths begin.

Neither the agent nor the question whether it can hold the object there plays a part.
"""

import time
from collections import OrderedDict

import numpy as np
from numba import njit
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from converter.shape import FloatArray, denoised
from planner.configuration_space import ConfigurationSpace
from planner.kernel import IntArray
from planner.problem import Configuration, Problem
from planner.settings import Settings

CELL = 0.05
"""Pitch of the raster [m]."""

MAX_VERTICES = 40_000
"""In rooms with more vertices the pitch is larger."""

KEPT_ROADMAPS = 64
"""Roadmaps kept for later configurations; one takes about a megabyte."""

_NEIGHBOURS = ((1, 0), (0, 1), (1, 1), (1, -1))
"""Half of the 8 directions to neighbours: the other half are the same edges."""


class Roadmap:
    """The rasterised free positions of an object, the other objects staying where they are.

    Args:
        space: Where the object's centre may be.
        cell: Pitch of the raster [m]; one vertex lies on the lower corner of the bounds.

    Attributes:
        vertices: (v, 2) [m], world: the free vertices.
    """

    def __init__(self, space: ConfigurationSpace, cell: float = CELL) -> None:
        lower, upper = space.bounds
        self._cell = max(cell, float(np.sqrt(np.prod(upper - lower) / MAX_VERTICES)))
        self._space = space
        columns, rows = (np.floor((upper - lower) / self._cell + 1e-9) + 1).astype(int)
        steps = np.stack(np.meshgrid(np.arange(columns), np.arange(rows), indexing="ij"), axis=-1)
        # Rounding errors must not put the last row outside.
        raster = np.minimum(denoised(lower + self._cell * steps), upper)
        free = space.points_free(raster.reshape(-1, 2)).reshape(columns, rows)
        number = np.full(free.shape, -1)
        number[free] = np.arange(np.count_nonzero(free))
        self.vertices: FloatArray = raster[free]
        self._edges = self._free_edges(number)

    def path_density(self, position: FloatArray) -> FloatArray:
        """The density (v,) of the shortest paths from the vertices around `position` (2,) [m]."""
        sources = self._around(position)
        distances, previous = dijkstra(self._edges, directed=False, indices=sources, return_predecessors=True)
        passing = np.zeros(len(self.vertices))
        for distance, before in zip(distances, previous, strict=True):
            reached = np.flatnonzero(np.isfinite(distance))
            farthest_first = reached[np.argsort(-distance[reached], kind="stable")]
            passing += _paths_through(farthest_first, before.astype(np.int64), len(self.vertices))
        return passing / max(len(self.vertices), 1)

    def _around(self, position: FloatArray) -> IntArray:
        """The vertices at most a cell away in x and y that the object can move to in a straight line."""
        near = np.flatnonzero((np.abs(self.vertices - position) <= self._cell * (1 + 1e-9)).all(axis=1))
        return near[self._space.segments_free(position, self.vertices[near])]

    def _free_edges(self, number: IntArray) -> csr_array:
        """The graph; `number` (columns, rows) is each raster point's vertex, -1 where it is not free."""
        size = len(self.vertices)
        pairs = np.concatenate([_neighbours(number, dx, dy) for dx, dy in _NEIGHBOURS])
        starts, ends = self.vertices[pairs[:, 0]], self.vertices[pairs[:, 1]]
        free = self._space.segments_free(starts, ends)
        lengths = np.hypot(*(ends - starts)[free].T)
        return csr_array((lengths, (pairs[free, 0], pairs[free, 1])), shape=(size, size))


class BottleneckSubgoals:
    """Candidates drawn by the density of shortest paths; configurations with equal other objects share a roadmap."""

    def __init__(self, problem: Problem, settings: Settings) -> None:
        del settings
        self._problem = problem
        self._roadmaps: OrderedDict[tuple[int, bytes], Roadmap] = OrderedDict()
        self.time_s = 0.0

    def candidates(self, configuration: Configuration, index: int, n: int, rng: np.random.Generator) -> FloatArray:
        """At most `n` different vertices (k, 2) [m] to which object `index` could move by itself."""
        started = time.perf_counter()
        roadmap = self._roadmap(configuration, index)
        density = roadmap.path_density(configuration.objects[index])
        self.time_s += time.perf_counter() - started
        possible = np.flatnonzero(density)
        if len(possible) == 0:
            return np.empty((0, 2))
        weights = density[possible] / density[possible].sum()
        drawn = rng.choice(possible, min(n, len(possible)), replace=False, p=weights)
        return np.asarray(roadmap.vertices[drawn])

    def _roadmap(self, configuration: Configuration, index: int) -> Roadmap:
        key = (index, np.delete(configuration.objects, index, axis=0).tobytes())
        roadmap = self._roadmaps.pop(key, None)
        if roadmap is None:
            roadmap = Roadmap(self._problem.object_space(configuration, index))
        self._roadmaps[key] = roadmap
        if len(self._roadmaps) > KEPT_ROADMAPS:
            self._roadmaps.popitem(last=False)
        return roadmap


def _neighbours(number: IntArray, dx: int, dy: int) -> IntArray:
    """Pairs (e, 2) of vertices, the second one `dx` columns and `dy` rows on from the first."""
    columns, rows = number.shape
    bottom, top = max(0, -dy), rows - max(0, dy)
    here, there = number[: columns - dx, bottom:top], number[dx:, bottom + dy : top + dy]
    both = (here >= 0) & (there >= 0)
    return np.column_stack([here[both], there[both]])


@njit(cache=True)
def _paths_through(farthest_first: IntArray, previous: IntArray, n: int) -> IntArray:
    """For each of `n` vertices how many paths of a shortest-path tree lead through it or end there."""
    passing = np.zeros(n, np.int64)
    for vertex in farthest_first:
        passing[vertex] += 1
        if previous[vertex] >= 0:
            passing[previous[vertex]] += passing[vertex]
    return passing
