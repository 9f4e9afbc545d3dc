"""Which search answers to which method's name."""

from collections.abc import Callable
from typing import Protocol

import numpy as np

from converter.scene import Scene
from planner import push, search
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


SOLVERS: dict[str, Solver] = dict.fromkeys(METHODS, search.solve) | {
    "MBTS": _mbts,
    "MBTS-rrt": _mbts,
    "Push": push.solve,
}
"""Searches by the name of the method."""


def solve(
    scene: Scene,
    settings: Settings,
    rng: np.random.Generator,
    *,
    should_stop: Callable[[], bool] = lambda: False,
    on_progress: Callable[[Progress], object] = lambda _: None,
) -> PlanResult:
    """Searches by the method of `settings` for a plan that brings the goal-object to the goal.

    Args:
        scene: The puzzle.
        settings: Method and budgets.
        rng: Source of all randomness.
        should_stop: Asked between subproblems; True ends the search with status `timeout`.
        on_progress: Told after every expansion that did not end the search.

    Raises:
        InputError: bodies of the scene overlap at the start, or the scene lacks what the method needs.
    """
    return SOLVERS[settings.method](scene, settings, rng, should_stop=should_stop, on_progress=on_progress)
