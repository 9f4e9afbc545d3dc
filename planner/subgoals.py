"""Where an object could go next: candidates, the filter, and the draw ([L], section IV-B).

What the methods differ in is where candidates come from: one file per generator (`subgoals_random`,
`subgoals_bottleneck`, `subgoals_human`). The filter keeps the candidates at which the object would make the scene
look most promising; a random draw from what is left bounds the number of subproblems.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from converter.shape import FloatArray
from pcg.printable import one_line
from planner.heuristics import scores_if
from planner.kernel import BoolArray, IntArray
from planner.problem import Configuration, Problem
from planner.settings import Settings
from planner.subgoals_human import HumanSubgoals
from planner.subgoals_random import RandomSubgoals


class SubgoalGenerator(Protocol):
    """Proposes where an object could go; made once per problem.

    Attributes:
        time_s: Time spent so far on computing what candidates are drawn from [s].
    """

    time_s: float

    def candidates(self, configuration: Configuration, index: int, n: int, rng: np.random.Generator) -> FloatArray:
        """At most `n` positions (k, 2) [m], world, for object `index`."""


def _bottleneck(problem: Problem, settings: Settings) -> SubgoalGenerator:
    # SciPy's graphs take a fifth of a second to import, which the other methods need not pay.
    from planner.subgoals_bottleneck import BottleneckSubgoals  # noqa: PLC0415  # see above

    return BottleneckSubgoals(problem, settings)


GeneratorFactory = Callable[[Problem, Settings], SubgoalGenerator]

GENERATORS: dict[str, GeneratorFactory] = {
    "Rnd": RandomSubgoals,
    "Btl": _bottleneck,
    "Hum": HumanSubgoals,
}
"""Subgoal generators by the first part of a method's name."""


@dataclass(frozen=True, eq=False)
class Proposal:
    """Subgoals of one object in one configuration, and how they came about. The trivial subgoal comes on top.

    Attributes:
        candidates: (k, 2) [m], world: positions that the generator proposed and a carry may lead to.
        scores: (k,) the score that the configuration would have with the object there.
        passed: (p,) indices of the candidates that the filter kept; all of them without a filter.
        drawn: (d,) indices of those that were drawn, in random order.
    """

    candidates: FloatArray
    scores: FloatArray
    passed: IntArray
    drawn: IntArray

    @property
    def subgoals(self) -> FloatArray:
        """The positions (d, 2) [m] to bring the object to."""
        return self.candidates[self.drawn]


def propose_subgoals(
    problem: Problem,
    generator: SubgoalGenerator,
    configuration: Configuration,
    index: int,
    placeable: Callable[[FloatArray], BoolArray],
    settings: Settings,
    rng: np.random.Generator,
    scores_of: Callable[[Problem, Configuration, int, FloatArray], FloatArray] = scores_if,
    contacts: Callable[[], FloatArray] | None = None,
) -> Proposal:
    """Positions to bring object `index` to.

    Args:
        problem: The problem.
        generator: Where candidates come from.
        configuration: Where everything is; the scores take the agent to stay there.
        index: The object.
        placeable: For each of some positions (n, 2) [m] whether a carry may lead there.
        settings: Number of candidates, share that the filter keeps, number of subgoals.
        rng: Source of all randomness.
        scores_of: The score that a configuration would have with an object at each of some positions.
        contacts: Where contact stops a carry, positions (k, 2) [m] from which `contact_share` of the proposals draw
            their candidates instead.
    """
    candidates = np.empty((0, 2))
    if contacts is not None and rng.random() < settings.contact_share:
        candidates = rng.permutation(contacts())[: settings.candidates]
    if len(candidates) == 0:
        candidates = _positions(generator.candidates(configuration, index, settings.candidates, rng))
        candidates = candidates[placeable(candidates)]
    scores = scores_of(problem, configuration, index, candidates)
    passed = np.arange(len(candidates))
    if "F" in settings.letters and len(candidates):
        # At least as many as are drawn, so that as many are drawn with a filter as without.
        keep = max(settings.subgoals_per_object, round(settings.keep_share * len(candidates)))
        passed = filter_best(scores, keep, rng)
    return Proposal(candidates, scores, passed, rng.permutation(passed)[: settings.subgoals_per_object])


def _positions(candidates: FloatArray) -> FloatArray:
    """What a generator gave, which may come from outside."""
    try:
        positions = np.asarray(candidates, dtype=np.float64)
    except (TypeError, ValueError):
        positions = np.full(1, np.nan)
    if positions.size == 0:
        return np.empty((0, 2))
    if positions.shape[1:] != (2,) or not np.isfinite(positions).all():
        raise TypeError(
            f"the subgoal generator returned {one_line(repr(candidates), 100)}, allowed are (k, 2) finite numbers"
        )
    return positions


def filter_best(scores: FloatArray, keep: int, rng: np.random.Generator) -> IntArray:
    """Indices of the best `keep` of `scores` (n,), or all if there are fewer; ties are broken at random."""
    shuffled = rng.permutation(len(scores))
    return np.asarray(shuffled[np.argsort(-scores[shuffled], kind="stable")][:keep])
