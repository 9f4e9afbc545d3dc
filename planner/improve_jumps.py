"""Fewer carries between the placements of a route: which of its configurations can be skipped?

A search that gets ahead by short carries, as in Maze, takes more of them than it needs. Often a later configuration of
its route can be reached from an earlier one in a single carry. All pairs are tried, in the grasp in which the route gets
there and in others, and dynamic programming over the configurations keeps the fewest carries, then the shortest way. In
Maze that leaves half of the carries and of the way in 20 ms.
"""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from planner.carries import Carry, Route, RoutePlanner, carry_of
from planner.contact_curve import ContactCurve
from planner.pick_place import PickPlace, PickPlaceSolver, Region
from planner.pick_place_exact import ExactPickPlace
from planner.problem import Configuration, Problem
from planner.settings import PRESETS
from planner.visibility import ShortestPathTree

JUMP = replace(PRESETS["fast"], grasp_starts=12, placement_samples=4)
"""Settings of a carry that skips configurations."""


@dataclass(frozen=True, eq=False)
class Way:
    """Carries from the start to some configuration.

    Attributes:
        configuration: Where everything is afterwards.
        carries: What is done.
        length: Distance that the agent drives [m].
    """

    configuration: Configuration
    carries: tuple[Carry, ...] = ()
    length: float = 0.0

    @property
    def cost(self) -> tuple[int, float]:
        """Pick-places, then length [m], as of a route."""
        return len(self.carries), self.length

    def followed_by(self, step: PickPlace) -> "Way":
        """One carry more."""
        carries = (*self.carries, carry_of(self.configuration, step))
        return Way(step.applied_to(self.configuration), carries, self.length + step.length)


class Jumps:
    """Skips configurations of the routes of one problem."""

    def __init__(self, problem: Problem, motions: RoutePlanner, rng: np.random.Generator) -> None:
        self._problem = problem
        self._motions = motions
        self._rng = rng
        self._curves = [ContactCurve(body, problem.scene.agent.radius) for body in problem.scene.objects]

    def fewest(self, route: Route) -> tuple[Carry, ...]:
        """The fewest carries found, at most as many as those of `route`, that bring the goal-object to the goal."""
        n = len(route.carries)
        ways: list[list[Way]] = [[Way(route.configurations[0])], *([] for _ in range(n))]
        for i in range(n):
            ways[i] = self._apart(ways[i])
            for way in ways[i]:
                solver = ExactPickPlace(self._problem, self._curves, way.configuration, JUMP, self._rng, Counter())
                for j in range(i + 1, n + 1):
                    ways[j] += [way.followed_by(step) for step in self._jumps(solver, way.configuration, route, j)]
        complete = [way for found in ways for way in found if self._problem.at_goal(way.configuration)]
        return min(complete, key=lambda way: way.cost).carries if complete else route.carries

    def _apart(self, ways: list[Way]) -> list[Way]:
        """The best of some ways to one configuration, and the best after which the agent is shut off from there."""
        if not ways:
            return []
        best = min(ways, key=lambda way: way.cost)
        tree = ShortestPathTree(self._problem.agent_space(best.configuration), best.configuration.agent)
        reached = tree.reaches(np.array([way.configuration.agent for way in ways]))
        others = [way for way, same in zip(ways, reached, strict=True) if not same]
        return [best, *sorted(others, key=lambda way: way.cost)[:1]]

    def _jumps(
        self, solver: PickPlaceSolver, configuration: Configuration, route: Route, j: int
    ) -> Iterator[PickPlace]:
        """Single carries from `configuration` to the placements of configuration `j` of the route, or to the goal."""
        carry, target = route.carries[j - 1], route.configurations[j]
        moved = np.flatnonzero((target.objects != configuration.objects).any(axis=1))
        if [*moved] == [carry.index] and (own := self._motions.step(configuration, carry)):
            yield own
        if j == len(route.carries):
            index, region = self._problem.goal_index, Region.of_goal(self._problem.scene.goal)
        elif len(moved) == 1:
            index, region = int(moved[0]), Region.around(target.objects[moved[0]], 0.0)
        else:
            return
        if other := solver.pick_place(index, region):
            yield other
