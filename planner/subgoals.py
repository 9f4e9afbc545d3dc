"""Where an object could go next: candidates, the filter, and the draw ([L], section IV-B)."""

from collections.abc import Callable

import numpy as np

from converter.shape import FloatArray
from planner.heuristics import scores_if
from planner.kernel import BoolArray
from planner.problem import Configuration, Problem
from planner.settings import Settings

SubgoalGenerator = Callable[[Problem, Configuration, int, int, np.random.Generator], FloatArray]
"""(problem, configuration, object index, n, rng) -> at most n candidate positions (k, 2) [m], world."""

_DRAWS_PER_CANDIDATE = 50
"""Uniform draws before a cluttered room is taken to have fewer free positions than asked for."""


def random_candidates(
    problem: Problem, configuration: Configuration, index: int, n: int, rng: np.random.Generator
) -> FloatArray:
    """At most `n` positions (k, 2), uniform over the free positions of object `index`."""
    space = problem.object_space(configuration, index)
    found = np.empty((0, 2))
    for _ in range(_DRAWS_PER_CANDIDATE):
        draws = rng.uniform(space.bounds[0], space.bounds[1], (n, 2))
        found = np.vstack([found, draws[space.points_free(draws)]])
        if len(found) >= n:
            break
    return found[:n]


GENERATORS: dict[str, SubgoalGenerator] = {"Rnd": random_candidates}
"""Subgoal generators by the first part of a method's name."""


def filter_best(scores: FloatArray, share: float, rng: np.random.Generator) -> FloatArray:
    """Indices of the best `share` of `scores` (n,), at least one; ties are broken at random."""
    keep = max(1, round(share * len(scores)))
    shuffled = rng.permutation(len(scores))
    return np.asarray(shuffled[np.argsort(-scores[shuffled], kind="stable")][:keep])


def propose_subgoals(
    problem: Problem,
    configuration: Configuration,
    index: int,
    placeable: Callable[[FloatArray], BoolArray],
    settings: Settings,
    rng: np.random.Generator,
) -> FloatArray:
    """Positions (k, 2) [m] to bring object `index` to; the trivial subgoal, a regrasp, comes on top of them."""
    generate = GENERATORS[settings.generator]
    candidates = generate(problem, configuration, index, settings.candidates, rng)
    candidates = candidates[placeable(candidates)]
    if "F" in settings.letters and len(candidates):
        scores = scores_if(problem, configuration, index, candidates)
        candidates = candidates[filter_best(scores, settings.keep_share, rng)]
    return rng.permutation(candidates)[: settings.subgoals_per_object]
