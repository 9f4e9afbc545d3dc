"""Pick-and-place subproblems by exact geometry: grasps on the contact curve, shortest paths by visibility graphs."""

from collections import Counter
from collections.abc import Callable
from functools import cached_property
from itertools import chain

import numpy as np

from converter.shape import FloatArray
from planner.configuration_space import ConfigurationSpace
from planner.contact_curve import ContactCurve
from planner.kernel import BoolArray
from planner.pick_place import PickPlace, Region
from planner.problem import Configuration, Problem
from planner.settings import Settings
from planner.visibility import ShortestPathTree


class _Grasp:
    """One way to hold one object, and where that leads.

    Attributes:
        offset: (2,) [m] agent centre minus object position.
        start: (2,) [m] agent centre at the pick.
    """

    def __init__(
        self, position: FloatArray, offset: FloatArray, space_at: Callable[[FloatArray], ConfigurationSpace]
    ) -> None:
        self.offset = offset
        self.start = position + offset
        self._space_at = space_at

    @cached_property
    def _space(self) -> ConfigurationSpace:
        return self._space_at(self.offset)

    @cached_property
    def _tree(self) -> ShortestPathTree:
        return ShortestPathTree(self._space, self.start)

    def leads_to(self, positions: FloatArray) -> BoolArray:
        """For each of `positions` (n, 2) whether the object can be carried there in this grasp."""
        return self._tree.reaches(positions + self.offset)

    def nearby(self, positions: FloatArray) -> FloatArray:
        """For each of `positions` (n, 2) a position close to it that the object can be carried to in this grasp.

        In a corridor as wide as the agent no random position is free; the tree's edges run along its middle.
        """
        return self._tree.nearest_points(positions + self.offset) - self.offset

    def near_centre(self, region: Region) -> FloatArray:
        """The position (1, 2) close to the centre of `region` that `nearby` finds, or (0, 2) if it lies outside."""
        near = self.nearby(region.centre[None])
        return near[region.contains(near)]

    def contacts(self) -> FloatArray:
        """Positions (k, 2) [m] of the object at which contact stops a carry in this grasp."""
        return self._tree.turns - self.offset

    def carry_to(self, position: FloatArray) -> FloatArray | None:
        """The shortest path (n, 2) of the agent that brings the object to `position` (2,)."""
        return self._tree.path_to(position + self.offset)


class ExactPickPlace:
    """Subproblems of one configuration; what one query computes, later ones reuse."""

    def __init__(
        self,
        problem: Problem,
        curves: list[ContactCurve],
        configuration: Configuration,
        settings: Settings,
        rng: np.random.Generator,
        counters: Counter[str],
    ) -> None:
        self._problem = problem
        self._curves = curves
        self._configuration = configuration
        self._settings = settings
        self._rng = rng
        self._counters = counters
        self._from_agent = ShortestPathTree(problem.agent_space(configuration), configuration.agent)
        self._grasps: dict[int, list[_Grasp]] = {}

    def reachable(self, index: int) -> bool:
        """Whether one of the sampled grasps of object `index` can be driven to."""
        reachable = bool(self._reachable_grasps(index))
        self._counters["reachable" if reachable else "unreachable"] += 1
        return reachable

    def placeable(self, index: int, subgoals: FloatArray) -> BoolArray:
        """For each of `subgoals` (n, 2) whether one of the sampled grasps leads object `index` near it."""
        reach = self._settings.subgoal_size / 2
        found = np.zeros(len(subgoals), dtype=bool)
        for grasp in self._reachable_grasps(index):
            missing = subgoals[~found]
            led = np.asarray((np.abs(grasp.nearby(missing) - missing) <= reach).all(axis=1))
            led[~led] = grasp.leads_to(missing[~led])
            found[~found] = led
        return found

    def contacts(self, index: int) -> FloatArray:
        """Positions (k, 2) [m] of object `index` at which contact stops a carry in one of the sampled grasps."""
        return np.vstack([np.empty((0, 2)), *(grasp.contacts() for grasp in self._reachable_grasps(index))])

    def pick_place(self, index: int, region: Region) -> PickPlace | None:
        """Tries the sampled grasps in turn, for the centre of `region` first; None if none of them leads into it."""
        self._counters["subproblems_tried"] += 1
        samples = region.sample(self._settings.placement_samples, self._rng)
        grasps = self._reachable_grasps(index)
        to_centre = ((grasp, samples[:1]) for grasp in grasps)
        elsewhere = ((grasp, np.vstack([samples[1:], grasp.near_centre(region)])) for grasp in grasps)
        for grasp, positions in chain(to_centre, elsewhere):
            for position in positions[grasp.leads_to(positions)]:
                approach, carry = self._from_agent.path_to(grasp.start), grasp.carry_to(position)
                if approach is not None and carry is not None:
                    self._counters["subproblems_solved"] += 1
                    return PickPlace(index, approach, carry, position)
        return None

    def regrasp(self, index: int) -> PickPlace | None:
        """Drives to a sampled grasp of object `index` and leaves the object where it is."""
        for grasp in self._reachable_grasps(index):
            approach = self._from_agent.path_to(grasp.start)
            if approach is not None:
                return PickPlace(index, approach, approach[-1:], self._configuration.objects[index])
        return None

    def _reachable_grasps(self, index: int) -> list[_Grasp]:
        if index not in self._grasps:
            position = self._configuration.objects[index]
            obstacles = self._problem.grasp_obstacles(self._configuration, index)
            offsets = self._curves[index].sample_free(self._settings.grasp_starts, obstacles, self._rng)
            reached = self._from_agent.reaches(position + offsets)
            space_at = self._problem.carry_spaces(self._configuration, index)
            self._grasps[index] = [_Grasp(position, offset, space_at) for offset in offsets[reached]]
        return self._grasps[index]
