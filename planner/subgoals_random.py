"""Random subgoals (`Rnd` of [L], section IV-B): uniform over free positions, in the room or near the object.

Where an object can be moved by centimetres only between two regrasps, as in Maze, one uniform position in two thousand
is of use. So a share of the proposals draws its candidates from squares around the object, of 1/2 to 1/32 of the room.
"""

import numpy as np

from converter.shape import FloatArray
from planner.problem import Configuration, Problem
from planner.settings import Settings

_DRAWS_PER_CANDIDATE = 50
"""Uniform draws before a cluttered room is taken to have fewer free positions than asked for."""

_SCALES = 5
"""Rooms around the object, each half as wide as the one before."""


class RandomSubgoals:
    """Uniform candidates; nothing is computed beforehand."""

    def __init__(self, problem: Problem, settings: Settings) -> None:
        self._problem = problem
        self._near_share = settings.near_share
        self.time_s = 0.0

    def candidates(self, configuration: Configuration, index: int, n: int, rng: np.random.Generator) -> FloatArray:
        """At most `n` free positions (k, 2) [m] of object `index`, all in the room or all near the object."""
        space = self._problem.object_space(configuration, index)
        near = rng.random() < self._near_share
        found = np.empty((0, 2))
        for _ in range(_DRAWS_PER_CANDIDATE):
            draws = rng.uniform(space.bounds[0], space.bounds[1], (n, 2))
            if near:
                draws = _towards(configuration.objects[index], draws, space.bounds, rng)
            found = np.vstack([found, draws[space.points_free(draws)]])
            if len(found) >= n:
                break
        return found[:n]


def _towards(here: FloatArray, draws: FloatArray, room: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Scales `draws` (n, 2), uniform in `room`, into smaller rooms about `here`, each of a random scale."""
    scales = 0.5 ** rng.integers(1, _SCALES + 1, size=(len(draws), 1))
    return np.asarray(here + (draws - room.mean(axis=0)) * scales)
