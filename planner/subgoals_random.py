"""Random subgoals: uniform over the free positions of the object (`Rnd` of [L], section IV-B)."""

import numpy as np

from converter.shape import FloatArray
from planner.problem import Configuration, Problem
from planner.settings import Settings

_DRAWS_PER_CANDIDATE = 50
"""Uniform draws before a cluttered room is taken to have fewer free positions than asked for."""


class RandomSubgoals:
    """Uniform candidates; nothing is computed beforehand."""

    def __init__(self, problem: Problem, settings: Settings) -> None:
        del settings
        self._problem = problem
        self.time_s = 0.0

    def candidates(self, configuration: Configuration, index: int, n: int, rng: np.random.Generator) -> FloatArray:
        """At most `n` positions (k, 2) [m], uniform over the free positions of object `index`."""
        space = self._problem.object_space(configuration, index)
        found = np.empty((0, 2))
        for _ in range(_DRAWS_PER_CANDIDATE):
            draws = rng.uniform(space.bounds[0], space.bounds[1], (n, 2))
            found = np.vstack([found, draws[space.points_free(draws)]])
            if len(found) >= n:
                break
        return found[:n]
