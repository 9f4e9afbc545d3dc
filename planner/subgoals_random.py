"""Random subgoals (`Rnd` of [L], section IV-B): uniform over free positions, in the room and ever closer to the object.

Where an object can be moved by centimetres only between two regrasps, as in Maze, one uniform position in two thousand
is of use. So equal shares of the candidates come from the room and from squares around the object, each half as wide
as the one before. One scale is the room alone, as published.
"""

import numpy as np

from converter.shape import FloatArray
from planner.problem import Configuration, Problem
from planner.settings import Settings

_DRAWS_PER_CANDIDATE = 50
"""Uniform draws before a cluttered room is taken to have fewer free positions than asked for."""


class RandomSubgoals:
    """Uniform candidates at `Settings.candidate_scales` scales; nothing is computed beforehand."""

    def __init__(self, problem: Problem, settings: Settings) -> None:
        self._problem = problem
        self._scales = settings.candidate_scales
        self.time_s = 0.0

    def candidates(self, configuration: Configuration, index: int, n: int, rng: np.random.Generator) -> FloatArray:
        """At most `n` positions (k, 2) [m], uniform over the free positions of object `index`."""
        space = self._problem.object_space(configuration, index)
        found = np.empty((0, 2))
        for _ in range(_DRAWS_PER_CANDIDATE):
            draws = self._draws(space.bounds, configuration.objects[index], n, rng)
            found = np.vstack([found, draws[space.points_free(draws)]])
            if len(found) >= n:
                break
        return found[:n]

    def _draws(self, room: FloatArray, here: FloatArray, n: int, rng: np.random.Generator) -> FloatArray:
        draws = rng.uniform(room[0], room[1], (n, 2))
        scale = rng.integers(self._scales, size=n)
        near = scale > 0
        half = ((room[1] - room[0]) / 2 / 2.0 ** scale[near, None]).max(axis=1, keepdims=True)
        draws[near] = here + rng.uniform(-half, half)
        return draws
