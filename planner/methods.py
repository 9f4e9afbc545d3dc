"""Which search answers to which method's name."""

from collections.abc import Callable
from functools import partial
from typing import Protocol

import numpy as np

from converter.scene import Scene
from planner import push, search
from planner.infeasible import with_proof
from planner.result import PlanResult, Progress
from planner.settings import METHODS, Settings


class Solver(Protocol):
    """A search for a plan."""

    def __call__(
        self,
        scene: Scene,
        settings: Settings,
        rng: np.random.Generator,
        *,
        should_stop: Callable[[], bool],
        on_progress: Callable[[Progress], object],
    ) -> PlanResult:
        """See `solve`."""


def _mbts(
    scene: Scene,
    settings: Settings,
    rng: np.random.Generator,
    *,
    should_stop: Callable[[], bool],
    on_progress: Callable[[Progress], object],
) -> PlanResult:
    # CasADi and OMPL take half a second to import, which the other methods need not pay.
    from planner import mbts  # noqa: PLC0415  # see above

    return mbts.solve(scene, settings, rng, should_stop=should_stop, on_progress=on_progress)


_BESIDES_SEARCH: dict[str, Solver] = {"MBTS": _mbts, "MBTS-rrt": _mbts, "Push": push.solve}

SOLVERS: dict[str, Solver] = {method: _BESIDES_SEARCH.get(method, search.solve) for method in METHODS}
"""Searches by the name of the method."""


def _improve(
    scene: Scene,
    result: PlanResult,
    settings: Settings,
    rng: np.random.Generator,
    should_stop: Callable[[], bool],
) -> PlanResult:
    # The verification that ends an improvement imports shapely, which first plans need not wait for.
    from planner.improve import improve  # noqa: PLC0415  # see above

    return improve(scene, result, settings, rng, should_stop=should_stop)


def solve(
    scene: Scene,
    settings: Settings,
    rng: np.random.Generator,
    *,
    should_stop: Callable[[], bool] = lambda: False,
    on_progress: Callable[[Progress], object] = lambda _: None,
) -> PlanResult:
    """Searches by the method of `settings` for a plan that brings the goal-object to the goal, and may improve it.

    Args:
        scene: The puzzle.
        settings: Method and budgets.
        rng: Source of all randomness.
        should_stop: Asked between subproblems; True ends the search with status `timeout`, or the improvement.
        on_progress: Told after every expansion that did not end the search.

    Returns:
        The first plan found, or with `settings.improve` one that is as good or better. Its `time_s` is the time to the
        first plan in either case. Without a plan it is `infeasible` if there is a proof; see `planner.infeasible`.

    Raises:
        InputError: bodies of the scene overlap at the start, or the scene lacks what the method needs.
    """
    solver = partial(SOLVERS[settings.method], scene, settings, rng, on_progress=on_progress)
    is_exact = settings.method != "MBTS"
    result = with_proof(lambda stop: solver(should_stop=stop), scene, should_stop, ends_search=is_exact)
    return _improve(scene, result, settings, rng, should_stop) if settings.improve else result
