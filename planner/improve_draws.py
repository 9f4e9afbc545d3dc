"""What one carry of a route could be instead: another grasp, another placement.

Distances are drawn at every scale. A quarter of all draws are the special places that chance never hits: the nearest
free grasp where few are free, and placements in contact.
"""

from dataclasses import replace

import numpy as np

from converter.shape import FloatArray
from planner.carries import Carry
from planner.contact_curve import END_MARGIN, ContactCurve
from planner.pick_place import Region
from planner.problem import Configuration, Problem

CURVE_SAMPLES = 256
"""Points of a contact curve among which the place of a grasp is looked up."""

SMALLEST, LARGEST = 1e-3, 1.0
"""Typical distances of small and of large changes [m]; all scales in between are equally likely."""

CONTACT_GAP = 4e-10
"""What a placement in contact leaves free at most [m], less than the numeric slack."""

KEPT_STRETCHES = 512
"""Configurations whose free grasps are remembered."""


class Draws:
    """Random grasps and placements; none of them is checked."""

    def __init__(self, problem: Problem, rng: np.random.Generator) -> None:
        self._problem = problem
        self._rng = rng
        self._curves = [ContactCurve(body, problem.scene.agent.radius) for body in problem.scene.objects]
        self._arc_lengths = [np.asarray(np.linspace(0.0, curve.length, CURVE_SAMPLES)) for curve in self._curves]
        self._samples = [curve.at(at) for curve, at in zip(self._curves, self._arc_lengths, strict=True)]
        self._goal = Region.of_goal(problem.scene.goal)
        self._room = Region(*problem.scene.bounds)
        self._stretches: dict[tuple[int, bytes], FloatArray] = {}

    def grasp(self, configuration: Configuration, carry: Carry) -> Carry:
        """The carry in a grasp near its own, or in any."""
        curve, samples = self._curves[carry.index], self._samples[carry.index]
        if self._coin():
            own = self._arc_lengths[carry.index][((samples - carry.grasp) ** 2).sum(axis=1).argmin()]
            wanted = (own + self._scale() * self._rng.standard_normal()) % curve.length
        else:
            wanted = self._rng.uniform(0.0, curve.length)
        if self._coin():
            # In a narrow place few grasps are free, maybe a single point; elsewhere it takes too long to find out.
            wanted = _nearest(wanted, self._free_stretches(configuration, carry.index))
        return replace(carry, grasp=curve.at(np.array([wanted]))[0])

    def near_placement(self, configuration: Configuration, carry: Carry, *, is_final: bool) -> Carry:
        """The carry to a placement near its own; in the goal, if it is the one that has to end there."""
        placement = carry.placement + self._shift()
        if is_final:
            return replace(carry, placement=np.clip(placement, self._goal.lower, self._goal.upper))
        return replace(carry, placement=self._perhaps_in_contact(configuration, carry.index, placement))

    def new_placement(self, configuration: Configuration, carry: Carry, *, is_final: bool) -> Carry:
        """The carry to a placement near where the object stands, or anywhere; in the goal, if it has to end there."""
        if is_final:
            return replace(carry, placement=self._uniform(self._goal))
        standing = configuration.objects[carry.index]
        placement = self._uniform(self._room) if self._coin() else standing + self._shift()
        return replace(carry, placement=self._perhaps_in_contact(configuration, carry.index, placement))

    def point_on(self, path: FloatArray) -> FloatArray:
        """A uniformly random point (2,) of the polyline `path` (n, 2)."""
        lengths = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
        at = self._rng.uniform(0.0, lengths[-1])
        return np.array([np.interp(at, lengths, coordinate) for coordinate in path.T])

    def _free_stretches(self, configuration: Configuration, index: int) -> FloatArray:
        key = index, configuration.objects.tobytes()
        if key not in self._stretches:
            if len(self._stretches) >= KEPT_STRETCHES:
                self._stretches.clear()
            stretches = self._curves[index].free_stretches(self._problem.grasp_obstacles(configuration, index))
            margin = np.minimum(END_MARGIN, (stretches[:, 1] - stretches[:, 0]) / 2)
            self._stretches[key] = stretches + margin[:, None] * np.array([1.0, -1.0])
        return self._stretches[key]

    def _perhaps_in_contact(self, configuration: Configuration, index: int, placement: FloatArray) -> FloatArray:
        """The placement, or the last free one in a direction of the axes.

        In a corridor that is as wide as object and agent together, the object must touch the wall for the agent to
        pass.
        """
        space = self._problem.object_space(configuration, index)
        if self._coin() or not space.point_free(placement):
            return placement
        axis = self._rng.integers(2)
        free, blocked = placement.copy(), placement.copy()
        blocked[axis] = space.bounds[self._rng.integers(2), axis]
        if space.segment_free(placement, blocked):
            return blocked
        while abs(blocked[axis] - free[axis]) > CONTACT_GAP:
            middle = (free + blocked) / 2
            if space.segment_free(placement, middle):
                free = middle
            else:
                blocked = middle
        return free

    def _shift(self) -> FloatArray:
        by = self._scale() * self._rng.standard_normal(2)
        if self._coin():
            # Along a corridor without clearance no other direction is free.
            by[self._rng.integers(2)] = 0.0
        return by

    def _scale(self) -> float:
        return float(np.exp(self._rng.uniform(np.log(SMALLEST), np.log(LARGEST))))

    def _uniform(self, region: Region) -> FloatArray:
        return self._rng.uniform(region.lower, region.upper)

    def _coin(self) -> bool:
        return bool(self._rng.random() < 0.5)


def _nearest(arc_length: float, stretches: FloatArray) -> float:
    """The point of some stretches (k, 2) of a curve that is nearest along it; `arc_length` itself without any."""
    if len(stretches) == 0:
        return arc_length
    points = np.clip(arc_length, *stretches.T)
    return float(points[np.abs(points - arc_length).argmin()])
