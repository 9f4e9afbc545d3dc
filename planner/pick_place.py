"""The easier subproblem of [L]: pick one object and place it in a region, everything else staying put.

Two solvers share this interface: `pick_place_exact` (contact curve and visibility graph) and `pick_place_sampled`
(nonlinear program and RRT-Connect, as published).
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from converter.polyline import path_length
from converter.scene import Goal
from converter.shape import FloatArray
from planner.kernel import BoolArray
from planner.problem import Configuration


@dataclass(frozen=True, eq=False)
class Region:
    """An axis-aligned rectangle of object positions.

    Attributes:
        lower: (2,) [m], world.
        upper: (2,) [m], world.
    """

    lower: FloatArray
    upper: FloatArray

    @classmethod
    def around(cls, centre: FloatArray, size: float) -> "Region":
        """The square with sides of `size` [m], 0 for a single point."""
        return cls(centre - size / 2, centre + size / 2)

    @classmethod
    def of_goal(cls, goal: Goal) -> "Region":
        """Where the goal-object's centre has to come to rest."""
        return cls(goal.position - goal.size / 2, goal.position + goal.size / 2)

    @property
    def centre(self) -> FloatArray:
        """The centre (2,) [m]."""
        return (self.lower + self.upper) / 2

    def contains(self, positions: FloatArray) -> BoolArray:
        """For each of `positions` (n, 2) whether it lies in the region."""
        return np.asarray(((positions >= self.lower) & (positions <= self.upper)).all(axis=1))

    def sample(self, n: int, rng: np.random.Generator) -> FloatArray:
        """Positions (n, 2): the centre and `n` - 1 uniform ones."""
        return np.vstack([self.centre, rng.uniform(self.lower, self.upper, (n - 1, 2))])


@dataclass(frozen=True, eq=False)
class PickPlace:
    """A solved subproblem.

    Attributes:
        index: The object.
        approach: (n, 2) [m] agent centres from where it was to the grasp.
        carry: (m, 2) [m] agent centres from the grasp to the release; the object moves along. A regrasp has one
            point only: the object stays.
        placement: (2,) [m] where the object rests afterwards.
    """

    index: int
    approach: FloatArray
    carry: FloatArray
    placement: FloatArray

    @cached_property
    def length(self) -> float:
        """Distance that the agent drives [m]."""
        return path_length(self.approach) + path_length(self.carry)

    @property
    def is_regrasp(self) -> bool:
        """Whether the agent only drives to another grasp."""
        return len(self.carry) == 1

    def applied_to(self, configuration: Configuration) -> Configuration:
        """The configuration after the subproblem."""
        moved = configuration.with_object(self.index, self.placement)
        return Configuration(self.carry[-1], moved.objects)


class PickPlaceSolver(Protocol):
    """Answers the questions about one configuration that Algorithm 1 asks."""

    def reachable(self, index: int) -> bool:
        """Whether the agent can get to a position in which it touches object `index`."""

    def placeable(self, index: int, subgoals: FloatArray) -> BoolArray:
        """For each of `subgoals` (n, 2) whether object `index` may be brought near it; necessary, not sufficient."""

    def contacts(self, index: int) -> FloatArray:
        """Positions (k, 2) [m] at which contact stops a carry of object `index`; none if the solver does not know."""

    def pick_place(self, index: int, region: Region) -> PickPlace | None:
        """Brings object `index` into `region`; None if no way was found."""

    def regrasp(self, index: int) -> PickPlace | None:
        """The trivial subproblem: drives to a grasp of object `index`, which stays where it is."""
