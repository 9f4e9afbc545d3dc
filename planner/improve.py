"""After the first plan: fewer pick-places and shorter ways, for as long as time allows.

[L] leaves open how to improve the plans that its search finds. What there is to decide is little (`planner.carries`)
and every candidate is decided exactly in about a millisecond, so simple means go far:

- *Jumps* leave out configurations of a route that it need not pass through (`planner.improve_jumps`): what many short
  carries did, one can do.
- *Local search* changes a decision or two at a time (`planner.improve_moves`) and keeps what is better.
- It starts anew, again and again, where it may end in another optimum: from the best route shaken, from a new search,
  or from a search that goes on from some configuration of the best route. In O-Room the way from the other side of the
  object is a third as long, but takes a first carry of 10 cm exactly, from contact to contact: most searches leave
  out what is more than half as long as the best route, and so try the ways nearby more often.
- Routes that are much shorter but take a pick-place or two more are kept beside the best one: they often lose them.

Better means fewer pick-places, or as many and a shorter way. Nothing counts as better before the independent
verification has passed it. Time decides only where the sequence of rounds ends, not what happens in them.
"""

import time
from collections import Counter
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from converter.scene import Scene
from planner.assemble import segments_of, subgoals_of
from planner.carries import Route, RoutePlanner, route_of
from planner.improve_jumps import Jumps
from planner.improve_moves import Moves
from planner.problem import Problem
from planner.result import PlanResult
from planner.search import Search
from planner.settings import PRESETS, Settings
from planner.verify import verify

RESTART = replace(
    PRESETS["fast"], method="Rnd+FPR", max_expansions=50, grasp_starts=4, contact_share=0.9, subgoals_per_object=20
)
"""Settings of new searches, whatever method found the plan: many short and broad ones that look for contact."""

SPARE = 2
"""Pick-places that the plan of a new search may have more than the best route; local search drops them."""

MUCH_SHORTER = 0.8
"""Share of the best route's length below which a route with more pick-places is kept: it may yet lose them."""

SHARES_OF_LENGTH = (1.0, 0.5, 0.5)
"""How long the plan of a new search may be, as shares of the best route's length: a way much shorter that is hard to find
is found sooner where long ways are not tried."""

MOVES, PATIENCE = 60, 20
"""The most moves of one local search, and how many in a row without success end it."""

FEW = 4
"""Carries of which no jump is tried to skip some: local search leaves out one or two in less time."""

SHAKES = 10
"""Attempts at shaking a route so that it stays possible."""


def improve(
    scene: Scene,
    first: PlanResult,
    settings: Settings,
    rng: np.random.Generator,
    *,
    should_stop: Callable[[], bool] = lambda: False,
) -> PlanResult:
    """A plan that is at least as good, sought for `settings.improve` seconds or `settings.improve_rounds` rounds.

    Args:
        scene: The puzzle.
        first: A plan for it; what is no valid plan comes back as it is.
        settings: Budgets.
        rng: Source of all randomness.
        should_stop: Asked between moves; True ends the improvement.

    Returns:
        `first` with other motions if those are better and pass verification. Its counters tell `improve_time_s` and
        what was tried; everything else stays, `time_s` too.
    """
    started = time.perf_counter()
    if not first.subgoals or verify(scene, first.to_plan(scene, settings, 0)):
        return first
    improver = Improver(scene, settings, rng, lambda: should_stop() or time.perf_counter() - started > settings.improve)
    best = improver.run(first)
    counters = {**first.counters, **improver.counters, "improve_time_s": time.perf_counter() - started}
    return replace(best, counters=counters)


class Improver:
    """Local search from many starts.

    Attributes:
        counters: Work done.
    """

    def __init__(
        self, scene: Scene, settings: Settings, rng: np.random.Generator, should_stop: Callable[[], bool]
    ) -> None:
        self.counters: Counter[str] = Counter(improve_rounds=0, improve_moves=0)
        self._scene = scene
        self._settings = settings
        self._rng = rng
        self._should_stop = should_stop
        self._problem = Problem(scene)
        self._motions = RoutePlanner(self._problem)
        self._moves = Moves(self._problem, self._motions, rng)
        self._jumps = Jumps(self._problem, self._motions, rng)
        self._starts = (self._shaken, self._restarted, self._spliced)

    def run(self, first: PlanResult) -> PlanResult:
        """The best plan found; `first` if none is better."""
        own = route_of(self._problem, first.segments)
        # A plan may pass slivers of free space, by way of a grasp there, that shortest paths miss.
        best = self._motions.route(own.carries) or own
        result, candidate, shorter = first, best, best
        while self.counters["improve_rounds"] < self._settings.improve_rounds and not self._should_stop():
            self.counters["improve_rounds"] += 1
            candidate = self._local_search(candidate)
            better = self._as_result(candidate, first)
            if _cost(better) < _cost(result) and not verify(
                self._scene, better.to_plan(self._scene, self._settings, 0)
            ):
                best, result = candidate, better
            shorter = self._much_shorter(best, shorter, candidate)
            start = self._starts[self._rng.integers(len(self._starts))]
            base = (best, shorter)[self._rng.integers(2)]
            candidate = start(base) or base
        return result

    def _much_shorter(self, best: Route, *others: Route) -> Route:
        """The shortest of the routes whose length is worth a few more pick-places than `best` has, or `best`."""
        worthwhile = [
            route
            for route in others
            if len(route.carries) <= len(best.carries) + SPARE and route.length < MUCH_SHORTER * best.length
        ]
        return min(worthwhile, key=lambda route: route.length, default=best)

    def _local_search(self, route: Route) -> Route:
        route = self._skipping(route)
        failures = 0
        for _ in range(MOVES):
            if failures >= PATIENCE or self._should_stop():
                break
            self.counters["improve_moves"] += 1
            carries = self._moves.propose(route)
            better = self._motions.route(carries, route.length if len(carries) == len(route.carries) else np.inf)
            failures = failures + 1 if better is None else 0
            route = better or route
        return route

    def _skipping(self, route: Route) -> Route:
        """The route without configurations that it need not pass through."""
        while len(route.carries) > FEW and not self._should_stop():
            other = self._motions.route(self._jumps.fewest(route))
            if other is None or other.cost >= route.cost:
                break
            route = other
        return route

    def _shaken(self, best: Route) -> Route | None:
        routes = (self._motions.route(self._moves.shaken(best)) for _ in range(SHAKES))
        return min(filter(None, routes), key=lambda route: route.cost, default=None)

    def _restarted(self, best: Route) -> Route | None:
        return self._searched(best, 0)

    def _spliced(self, best: Route) -> Route | None:
        return self._searched(best, int(self._rng.integers(len(best.carries))))

    def _searched(self, best: Route, kept: int) -> Route | None:
        """The first `kept` carries of `best`, and then what a new search finds."""
        problem = self._problem.starting_at(best.configurations[kept])
        most = len(best.carries) - kept + SPARE
        longest = best.length * self._rng.choice(SHARES_OF_LENGTH) - sum(step.length for step in best.steps[:kept])
        found = Search(problem, RESTART, self._rng, self._should_stop, max_pick_places=most, max_length=longest).run()
        return self._motions.route((*best.carries[:kept], *route_of(problem, found.segments).carries))

    def _as_result(self, route: Route, first: PlanResult) -> PlanResult:
        return replace(
            first, segments=segments_of(self._scene, route.steps), subgoals=subgoals_of(self._scene, route.steps)
        )


def _cost(result: PlanResult) -> tuple[int, float]:
    return len(result.subgoals), sum(segment.length for segment in result.segments)
