"""A plan as a sequence of carries: which object, in which grasp, to which placement.

That is all there is to choose. The motions follow: from each release the agent takes the shortest way to the next
grasp, and carries the object along the shortest way to its placement.
"""

from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from converter.plan import Segment
from converter.shape import FloatArray
from planner.configuration_space import ConfigurationSpace
from planner.pick_place import PickPlace
from planner.problem import Configuration, Problem
from planner.visibility import ShortestPathTree

KEPT_SPACES = 256
"""Configuration spaces kept for later plans; with its trees one takes some ten kilobytes."""

KEPT_TREES = 16
"""Shortest-path trees kept in each of them."""


@dataclass(frozen=True, eq=False)
class Carry:
    """One pick-and-place.

    Attributes:
        index: The object.
        grasp: (2,) [m] agent centre minus object position.
        placement: (2,) [m], world: where the object rests afterwards.
    """

    index: int
    grasp: FloatArray
    placement: FloatArray


@dataclass(frozen=True, eq=False)
class Route:
    """Carries with their motions.

    Attributes:
        carries: What is done.
        steps: How, one step for each carry.
        configurations: Where everything is before each carry, and after the last.
    """

    carries: tuple[Carry, ...]
    steps: tuple[PickPlace, ...]
    configurations: tuple[Configuration, ...]

    @cached_property
    def length(self) -> float:
        """Distance that the agent drives [m]."""
        return sum(step.length for step in self.steps)

    @property
    def cost(self) -> tuple[int, float]:
        """Pick-places, then length [m]: what is smaller is better."""
        return len(self.carries), self.length


def route_of(problem: Problem, segments: Sequence[Segment]) -> Route:
    """The route that a plan takes, with the plan's own motions."""
    configuration, names = problem.initial, problem.scene.object_names
    carries, steps, configurations = list[Carry](), list[PickPlace](), [configuration]
    approach = [configuration.agent[np.newaxis]]
    for segment in segments:
        if segment.object is None:
            approach.append(segment.path[1:])
            continue
        index = names.index(segment.object)
        grasp = segment.path[0] - configuration.objects[index]
        steps.append(PickPlace(index, np.vstack(approach), segment.path, segment.path[-1] - grasp))
        carries.append(carry_of(configuration, steps[-1]))
        configuration = steps[-1].applied_to(configuration)
        configurations.append(configuration)
        approach = [configuration.agent[np.newaxis]]
    return Route(tuple(carries), tuple(steps), tuple(configurations))


def carry_of(configuration: Configuration, step: PickPlace) -> Carry:
    """The carry that a pick-place from `configuration` is."""
    return Carry(step.index, step.carry[0] - configuration.objects[step.index], step.placement)


@dataclass
class _Space:
    """A configuration space with the trees that grow in it, by their roots."""

    space: ConfigurationSpace
    trees: OrderedDict[bytes, ShortestPathTree] = field(default_factory=OrderedDict)

    def shortest(self, start: FloatArray, goal: FloatArray) -> FloatArray | None:
        """The shortest path (n, 2) [m], or None if there is none."""
        straight = np.array([start, goal])
        if not self.space.points_free(straight).all():
            return None
        if self.space.segment_free(start, goal):
            return straight
        if start.tobytes() not in self.trees and goal.tobytes() in self.trees:
            backward = self.trees[goal.tobytes()].path_to(start)
            # Rounding may tell the two directions apart where there is no clearance.
            if backward is None or self.space.path_free(backward[::-1]):
                return None if backward is None else np.ascontiguousarray(backward[::-1])
        return self._tree(start).path_to(goal)

    def _tree(self, root: FloatArray) -> ShortestPathTree:
        key = root.tobytes()
        if key not in self.trees:
            self.trees[key] = ShortestPathTree(self.space, root)
            if len(self.trees) > KEPT_TREES:
                self.trees.popitem(last=False)
        return self.trees[key]


class RoutePlanner:
    """Finds the motions of carries; what one query computes, later ones reuse."""

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._spaces: OrderedDict[tuple[object, ...], _Space] = OrderedDict()

    def route(self, carries: Sequence[Carry], bound: float = np.inf) -> Route | None:
        """The route of some carries.

        None if one is impossible, if they leave the goal-object elsewhere than in the goal, or if the route is not
        shorter than `bound` [m].
        """
        configurations = [self._problem.initial]
        # What is left is at least as long as straight lines.
        rest = _straight_lengths(self._problem.initial, carries)
        length, steps = 0.0, []
        for carry, left in zip(carries, rest, strict=True):
            if length + left >= bound:
                return None
            step = self.step(configurations[-1], carry)
            if step is None:
                return None
            length += step.length
            steps.append(step)
            configurations.append(step.applied_to(configurations[-1]))
        is_plan = length < bound and self._problem.at_goal(configurations[-1])
        return Route(tuple(carries), tuple(steps), tuple(configurations)) if is_plan else None

    def step(self, configuration: Configuration, carry: Carry) -> PickPlace | None:
        """The shortest motions of one carry; None if it is impossible."""
        start = configuration.objects[carry.index] + carry.grasp
        approach = self._driving(configuration).shortest(configuration.agent, start)
        if approach is None:
            return None
        motion = self._carrying(configuration, carry).shortest(start, carry.placement + carry.grasp)
        return None if motion is None else PickPlace(carry.index, approach, motion, carry.placement)

    def _driving(self, configuration: Configuration) -> _Space:
        return self._space((configuration.objects.tobytes(),), lambda: self._problem.agent_space(configuration))

    def _carrying(self, configuration: Configuration, carry: Carry) -> _Space:
        others = np.delete(configuration.objects, carry.index, axis=0)
        return self._space(
            (carry.index, carry.grasp.tobytes(), others.tobytes()),
            lambda: self._problem.carry_space(configuration, carry.index, carry.grasp),
        )

    def _space(self, key: tuple[object, ...], make: Callable[[], ConfigurationSpace]) -> _Space:
        found = self._spaces.pop(key, None) or _Space(make())
        self._spaces[key] = found
        if len(self._spaces) > KEPT_SPACES:
            self._spaces.popitem(last=False)
        return found


def _straight_lengths(configuration: Configuration, carries: Sequence[Carry]) -> FloatArray:
    """For each carry the length (n,) [m] of straight lines from where it begins, with its approach, to the end."""
    points, positions = [configuration.agent], configuration.objects.copy()
    for carry in carries:
        points += [positions[carry.index] + carry.grasp, carry.placement + carry.grasp]
        positions[carry.index] = carry.placement
    lines = np.hypot(*np.diff(np.array(points), axis=0).T)
    return np.asarray(lines[::-1].cumsum()[::-1][::2])
