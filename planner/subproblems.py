"""Which solver answers the subproblems: one for each settings preset."""

from collections import Counter
from collections.abc import Callable

import numpy as np

from planner.contact_curve import ContactCurve
from planner.pick_place import PickPlaceSolver
from planner.pick_place_exact import ExactPickPlace
from planner.problem import Configuration, Problem
from planner.settings import Settings

SolverForConfiguration = Callable[[Configuration], PickPlaceSolver]


def subproblem_solvers(
    problem: Problem,
    settings: Settings,
    rng: np.random.Generator,
    counters: Counter[str],
    should_stop: Callable[[], bool],
) -> SolverForConfiguration:
    """Makes a subproblem solver for a configuration; what depends on the scene alone is computed once."""
    curves = [ContactCurve(body, problem.scene.agent.radius) for body in problem.scene.objects]
    if settings.preset == "fast":
        return lambda configuration: ExactPickPlace(problem, curves, configuration, settings, rng, counters)
    # CasADi and OMPL take half a second to import, which the fast preset need not pay.
    from planner.pick_place_sampled import SampledPickPlace  # noqa: PLC0415  # see above

    return lambda configuration: SampledPickPlace(problem, curves, configuration, settings, rng, counters, should_stop)
