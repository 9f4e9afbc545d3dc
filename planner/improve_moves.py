"""Changes of a route that may make it better: another grasp, another placement, one carry less, another order.

A move only proposes carries; whether they are possible, and how long the way is, `RoutePlanner` finds out.
"""

from collections.abc import Callable, Iterable
from dataclasses import replace
from itertools import chain

import numpy as np

from planner.carries import Carry, Route, RoutePlanner, carry_of
from planner.improve_draws import Draws
from planner.pick_place import PickPlace
from planner.problem import Configuration, Problem

REPAIRS = 8
"""Grasps tried for a carry whose own grasp has become impossible."""

SHAKES = 30
"""Grasps and placements tried for a carry that is drawn anew."""

Carries = tuple[Carry, ...]


class Moves:
    """Random changes of the routes of one problem."""

    def __init__(self, problem: Problem, motions: RoutePlanner, rng: np.random.Generator) -> None:
        self._problem = problem
        self._motions = motions
        self._rng = rng
        self._draws = Draws(problem, rng)
        self._moves: list[Callable[[Route], Carries]] = [
            *2 * [self.other_grasp],
            *2 * [self.other_placement],
            *2 * [self.placement_between_other_grasps],
            self.placement_on_the_way,
            self.fewer,
            self.other_order,
        ]

    def propose(self, route: Route) -> Carries:
        """The carries of a random move."""
        return self._moves[self._rng.integers(len(self._moves))](route)

    def other_grasp(self, route: Route) -> Carries:
        """One carry in another grasp."""
        i = self._any(route)
        return _replaced(route.carries, i, self._draws.grasp(route.configurations[i], route.carries[i]))

    def other_placement(self, route: Route) -> Carries:
        """One object placed somewhere near."""
        i = self._any(route)
        return _replaced(route.carries, i, self._placed_near(route, i))

    def placement_between_other_grasps(self, route: Route) -> Carries:
        """One object placed somewhere near, and grasped in another way before, at its next carry, or both."""
        i = self._any(route)
        j = _next_of_object(route.carries, i)
        carry = self._placed_near(route, i)
        which = self._rng.integers(3)
        if which != 0 or j is None:
            carry = self._draws.grasp(route.configurations[i], carry)
        carries = _replaced(route.carries, i, carry)
        if which != 1 and j is not None:
            configuration = route.configurations[j].with_object(carry.index, carry.placement)
            carries = _replaced(carries, j, self._draws.grasp(configuration, carries[j]))
        return carries

    def placement_on_the_way(self, route: Route) -> Carries:
        """One object placed earlier on its way, or further along its next one."""
        i = self._any(route)
        following = _next_of_object(route.carries, i)
        j = i if following is None or self._rng.random() < 0.5 else following
        placement = self._draws.point_on(route.steps[j].carry) - route.carries[j].grasp
        return _replaced(route.carries, i, replace(route.carries[i], placement=placement))

    def fewer(self, route: Route) -> Carries:
        """Without one or two of the carries, half of the others to placements near."""
        dropped = self._rng.permutation(len(route.carries))[: self._rng.integers(1, 3)]
        return self._repaired(
            carry if self._rng.random() < 0.5 else self._placed_near(route, i)
            for i, carry in enumerate(route.carries)
            if i not in dropped
        )

    def other_order(self, route: Route) -> Carries:
        """Two carries swapped."""
        i, j = self._any(route), self._any(route)
        swapped = _replaced(_replaced(route.carries, i, route.carries[j]), j, route.carries[i])
        return self._repaired(swapped)

    def shaken(self, route: Route) -> Carries:
        """The same objects in other grasps to other placements, all of them from a random carry on."""
        kept = self._any(route)
        configuration, carries = route.configurations[kept], list(route.carries[:kept])
        for i in range(kept, len(route.carries)):
            step = self._first_possible(configuration, self._drawn_anew(configuration, route, i))
            if step is None:
                break
            carries.append(carry_of(configuration, step))
            configuration = step.applied_to(configuration)
        return tuple(carries)

    def _drawn_anew(self, configuration: Configuration, route: Route, i: int) -> Iterable[Carry]:
        carry, is_final = route.carries[i], self._is_final(route, i)
        placed = (self._draws.new_placement(configuration, carry, is_final=is_final) for _ in range(SHAKES))
        return (self._draws.grasp(configuration, carry) for carry in placed)

    def _repaired(self, carries: Iterable[Carry]) -> Carries:
        """The carries, those that are impossible in another grasp; up to the first that is impossible in all tried."""
        configuration, kept = self._problem.initial, list[Carry]()
        for carry in carries:
            others = (self._draws.grasp(configuration, carry) for _ in range(REPAIRS))
            step = self._first_possible(configuration, chain([carry], others))
            if step is None:
                break
            kept.append(carry_of(configuration, step))
            configuration = step.applied_to(configuration)
        return tuple(kept)

    def _first_possible(self, configuration: Configuration, carries: Iterable[Carry]) -> PickPlace | None:
        return next(filter(None, (self._motions.step(configuration, carry) for carry in carries)), None)

    def _placed_near(self, route: Route, i: int) -> Carry:
        is_final = self._is_final(route, i)
        return self._draws.near_placement(route.configurations[i], route.carries[i], is_final=is_final)

    def _is_final(self, route: Route, i: int) -> bool:
        """Whether carry `i` is the one that has to end in the goal."""
        return route.carries[i].index == self._problem.goal_index and _next_of_object(route.carries, i) is None

    def _any(self, route: Route) -> int:
        return int(self._rng.integers(len(route.carries)))


def _replaced(carries: Carries, i: int, carry: Carry) -> Carries:
    return (*carries[:i], carry, *carries[i + 1 :])


def _next_of_object(carries: Carries, i: int) -> int | None:
    """The next carry of the object that carry `i` moves, if there is one."""
    return next((j for j in range(i + 1, len(carries)) if carries[j].index == carries[i].index), None)
