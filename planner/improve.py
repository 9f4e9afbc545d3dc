"""After the first plan: fewer pick-places and shorter ways, as long as time allows.

[L] leaves open how to improve the plans that its search finds. What has to be decided is little (see
`planner.carries`), and every candidate is decided exactly, so simple means go far:

- *Local search* changes one decision at a time (`planner.improve_moves`) and keeps what is better.
- *Restarts* run the forward search again, from the start or from a configuration along the best route, and local
  search makes the most of what they find.

Better means fewer pick-places, or as many and a shorter way. Local search and restarts take turns; a round is a fixed
number of moves, so time decides only where the sequence of improvements ends.
"""

import time
from collections import Counter
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from converter.plan import Status
from converter.scene import Scene
from planner.assemble import segments_of, subgoals_of
from planner.carries import Carry, MotionPlanner, Route, carries_of
from planner.improve_moves import Moves
from planner.pick_place import PickPlace
from planner.problem import Problem
from planner.result import PlanResult
from planner.search import Search
from planner.settings import PRESETS, Settings
from planner.verify import verify

RESTART = replace(PRESETS["fast"], method="Rnd+FPR", max_expansions=50)
"""Settings of restarts, whatever method found the plan."""

MOVES = 60
"""Moves of a round of local search."""

SPLICED = 0.5
"""Share of the restarts that begin on the way of the best route."""

WORSE = 1.5
"""How much longer than the best route a restart's may be for local search to start from it."""


def improve(
    scene: Scene,
    result: PlanResult,
    settings: Settings,
    rng: np.random.Generator,
    *,
    should_stop: Callable[[], bool] = lambda: False,
) -> PlanResult:
    """A plan that is at least as good, sought for at most `settings.improve` seconds and `improve_rounds` rounds.

    Args:
        scene: The puzzle.
        result: A plan for it; anything else comes back as it is.
        settings: Budgets.
        rng: Source of all randomness.
        should_stop: Asked between moves; True ends the improvement.

    Returns:
        The result with another motion if that is better and passes verification. Its counters tell `improve_time_s`
        and what was tried; status and `time_s` stay.
    """
    if result.status is not Status.SOLVED or not result.subgoals:
        return result
    started = time.perf_counter()
    improver = Improver(Problem(scene), rng, lambda: should_stop() or time.perf_counter() - started > settings.improve)
    best = improver.run(carries_of(improver.problem, result.segments), settings.improve_rounds)
    improved = result
    if best is not None:
        improved = replace(result, segments=segments_of(scene, best.steps), subgoals=subgoals_of(scene, best.steps))
    if _cost(improved) > _cost(result) or verify(scene, improved.to_plan(scene, settings, 0)):
        improved = result
    counters = {**result.counters, **improver.counters, "improve_time_s": time.perf_counter() - started}
    return replace(improved, counters=counters)


def _cost(result: PlanResult) -> tuple[int, float]:
    return len(result.subgoals), sum(segment.length for segment in result.segments)


class Improver:
    """Local search and restarts for one problem.

    Attributes:
        problem: The problem.
        counters: Work done.
    """

    def __init__(self, problem: Problem, rng: np.random.Generator, should_stop: Callable[[], bool]) -> None:
        self.problem = problem
        self.counters: Counter[str] = Counter(improve_moves=0, improve_restarts=0, improvements=0)
        self._rng = rng
        self._should_stop = should_stop
        self._motions = MotionPlanner(problem)
        self._moves = Moves(problem, self._motions, rng)

    def run(self, carries: tuple[Carry, ...], rounds: int) -> Route | None:
        """The best route found from a plan's carries; None if they are no plan."""
        best = self._motions.route(carries)
        if best is None:
            return None
        for _ in range(rounds):
            best = self._local_search(best)
            if self._should_stop():
                break
            other = self._restarted(best)
            if other is not None:
                best = min(best, self._local_search(other), key=lambda route: route.cost)
        return best

    def _local_search(self, route: Route) -> Route:
        for _ in range(MOVES):
            if self._should_stop():
                break
            self.counters["improve_moves"] += 1
            carries = self._moves.propose(route)
            bound = route.length if len(carries) == len(route.carries) else np.inf
            better = self._motions.route(carries, bound)
            if better is not None:
                self.counters["improvements"] += 1
                route = better
        return route

    def _restarted(self, best: Route) -> Route | None:
        """A route of a new search, from the start or after some carries of `best`, with no more pick-places."""
        self.counters["improve_restarts"] += 1
        kept = int(self._rng.integers(len(best.carries))) if self._rng.random() < SPLICED else 0
        problem = self.problem.starting_at(best.configurations(self.problem)[kept])
        left = len(best.carries) - kept

        def admits(steps: list[PickPlace]) -> bool:
            return sum(not step.is_regrasp for step in steps) < left

        found = Search(problem, RESTART, self._rng, self._should_stop, admits=admits).run()
        carries = (*best.carries[:kept], *carries_of(problem, found.segments))
        bound = WORSE * best.length if len(carries) == len(best.carries) else np.inf
        return self._motions.route(carries, bound)
