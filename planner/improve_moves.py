"""Changes of a route that may make it better: another grasp, another placement, one carry less, another order.

A move only proposes carries; whether they are possible, and how long the way is, `MotionPlanner` finds out.
"""

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np

from converter.shape import FloatArray
from planner.carries import Carry, MotionPlanner, Route
from planner.contact_curve import ContactCurve
from planner.pick_place import PickPlace, Region
from planner.problem import Configuration, Problem

CURVE_SAMPLES = 256
"""Points of a contact curve among which the place of a grasp is looked up."""

SMALLEST, LARGEST = 1e-3, 1.0
"""Typical distances of small and of large changes [m]; all scales in between are equally likely."""

REPAIRS = 8
"""Grasps tried for a carry whose own grasp has become impossible."""

GRASP_MARGIN = 1e-6
"""Distance [m] of grasps from the ends of a free stretch: at the very end rounding decides who sees a collision."""

KEPT_STRETCHES = 512
"""Configurations whose free grasps are remembered."""

Carries = tuple[Carry, ...]


class Moves:
    """Random changes of the routes of one problem."""

    def __init__(self, problem: Problem, motions: MotionPlanner, rng: np.random.Generator) -> None:
        self._problem = problem
        self._motions = motions
        self._rng = rng
        self._curves = [ContactCurve(body, problem.scene.agent.radius) for body in problem.scene.objects]
        self._goal = Region.of_goal(problem.scene.goal)
        self._stretches: dict[tuple[int, bytes], FloatArray] = {}
        self._moves: list[Callable[[Route], Carries]] = [
            *2 * [self.other_grasp],
            *2 * [self.other_placement],
            *2 * [self.other_grasp_and_placement],
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
        return _replaced(route, i, self._regrasped(self._before(route, i), route.carries[i]))

    def other_placement(self, route: Route) -> Carries:
        """One object placed somewhere near."""
        i = self._any(route)
        return _replaced(route, i, self._moved(route, i))

    def other_grasp_and_placement(self, route: Route) -> Carries:
        """Both at once, for where neither helps alone."""
        i = self._any(route)
        return _replaced(route, i, self._regrasped(self._before(route, i), self._moved(route, i)))

    def placement_on_the_way(self, route: Route) -> Carries:
        """One object placed earlier on its way, or further along its next one."""
        i = self._any(route)
        next_one = _next_of_object(route.carries, i)
        j = i if next_one is None or self._rng.random() < 0.5 else next_one
        placement = self._point_on(route.steps[j].carry) - route.carries[j].grasp
        return _replaced(route, i, replace(route.carries[i], placement=placement))

    def fewer(self, route: Route) -> Carries:
        """Without one or two of the carries; grasps that this makes impossible are replaced."""
        dropped = self._rng.permutation(len(route.carries))[: self._rng.integers(1, 3)]
        carries = [
            carry if self._rng.random() < 0.5 else self._moved(route, i)
            for i, carry in enumerate(route.carries)
            if i not in dropped
        ]
        return self._repaired(carries)

    def other_order(self, route: Route) -> Carries:
        """Two carries swapped; grasps that this makes impossible are replaced."""
        carries = list(route.carries)
        i, j = self._rng.integers(len(carries), size=2)
        carries[i], carries[j] = carries[j], carries[i]
        return self._repaired(carries)

    def shaken(self, route: Route) -> Carries:
        """Any of the carries in other grasps and to other placements, to leave a local optimum."""
        carries = list(route.carries)
        for i in range(len(carries)):
            if self._rng.random() < 0.5:
                carries[i] = self._regrasped(self._before(route, i), self._moved(route, i))
        return self._repaired(carries)

    def _repaired(self, carries: Iterable[Carry]) -> Carries:
        """The carries, up to the first for which none of some grasps is possible."""
        configuration, kept = self._problem.initial, list[Carry]()
        for carry in carries:
            step = self._motions.step(configuration, carry) or self._step_in_another_grasp(configuration, carry)
            if step is None:
                break
            kept.append(replace(carry, grasp=step.carry[0] - configuration.objects[carry.index]))
            configuration = step.applied_to(configuration)
        return tuple(kept)

    def _step_in_another_grasp(self, configuration: Configuration, carry: Carry) -> PickPlace | None:
        others = (self._regrasped(configuration, carry) for _ in range(REPAIRS))
        return next(filter(None, (self._motions.step(configuration, other) for other in others)), None)

    def _regrasped(self, configuration: Configuration, carry: Carry) -> Carry:
        """The carry in another free grasp, a near one or any."""
        curve, stretches = self._curves[carry.index], self._free_stretches(configuration, carry.index)
        if len(stretches) == 0:
            return carry
        if self._rng.random() < 0.5:
            samples = np.linspace(0.0, curve.length, CURVE_SAMPLES)
            here = samples[((curve.at(samples) - carry.grasp) ** 2).sum(axis=1).argmin()]
            wanted = (here + self._scale() * self._rng.standard_normal()) % curve.length
            nearest = np.clip(wanted, *stretches.T)
            arc_length = nearest[np.abs(nearest - wanted).argmin()]
        else:
            # As many free stretches are short but matter, each is as likely as all by their lengths.
            lengths = stretches[:, 1] - stretches[:, 0]
            weights = lengths if self._rng.random() < 0.5 and lengths.sum() > 0 else np.ones(len(lengths))
            arc_length = self._rng.uniform(*stretches[self._rng.choice(len(weights), p=weights / weights.sum())])
        return replace(carry, grasp=curve.at(np.array([arc_length]))[0])

    def _free_stretches(self, configuration: Configuration, index: int) -> FloatArray:
        key = index, configuration.objects.tobytes()
        if key not in self._stretches:
            if len(self._stretches) >= KEPT_STRETCHES:
                self._stretches.clear()
            obstacles = self._problem.agent_space(configuration, held=index).obstacles
            stretches = self._curves[index].free_stretches(obstacles.moved(-configuration.objects[index]))
            margin = np.minimum(GRASP_MARGIN, (stretches[:, 1] - stretches[:, 0]) / 2)
            self._stretches[key] = stretches + margin[:, None] * np.array([1.0, -1.0])
        return self._stretches[key]

    def _moved(self, route: Route, i: int) -> Carry:
        """Carry `i` to a placement near its own; where the goal-object ends stays in the goal."""
        carry = route.carries[i]
        by = self._scale() * self._rng.standard_normal(2)
        if self._rng.random() < 0.5:
            # Along a corridor without clearance no other direction is free.
            by[self._rng.integers(2)] = 0.0
        placement = carry.placement + by
        if carry.index == self._problem.goal_index and _next_of_object(route.carries, i) is None:
            placement = np.clip(placement, self._goal.lower, self._goal.upper)
        return replace(carry, placement=placement)

    def _scale(self) -> float:
        return float(np.exp(self._rng.uniform(np.log(SMALLEST), np.log(LARGEST))))

    def _point_on(self, path: FloatArray) -> FloatArray:
        """A uniformly random point (2,) of the polyline `path` (n, 2)."""
        lengths = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
        at = self._rng.uniform(0.0, lengths[-1])
        return np.array([np.interp(at, lengths, coordinate) for coordinate in path.T])

    def _any(self, route: Route) -> int:
        return int(self._rng.integers(len(route.carries)))

    def _before(self, route: Route, i: int) -> Configuration:
        return route.configurations(self._problem)[i]


def _replaced(route: Route, i: int, carry: Carry) -> Carries:
    return (*route.carries[:i], carry, *route.carries[i + 1 :])


def _next_of_object(carries: Carries, i: int) -> int | None:
    """The next carry of the object that carry `i` moves, if there is one."""
    return next((j for j in range(i + 1, len(carries)) if carries[j].index == carries[i].index), None)
