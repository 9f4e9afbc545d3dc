"""The symbolic half of a logic-geometric program: which objects are picked and placed, in which order.

The domain is small. A state tells what is held and on which surface every other object lies; surfaces are the goal and
the floor. `pick o` needs an empty hand, `place o surface` needs o in it, and both surfaces take any object, as in the
published scenes. A *skeleton* is a sequence of actions; it solves the puzzle symbolically if it ends with the
goal-object lying on the goal. Where things are is left to geometry (`planner.lgp`).
"""

from dataclasses import dataclass
from enum import StrEnum


class Surface(StrEnum):
    """What an object can lie on."""

    GOAL = "goal"
    FLOOR = "floor"


@dataclass(frozen=True)
class Action:
    """A discrete decision: `pick index`, or `place index surface`.

    Attributes:
        index: The object.
        surface: Where it is placed; None for a pick.
    """

    index: int
    surface: Surface | None = None

    @property
    def is_pick(self) -> bool:
        """Whether the action grasps the object."""
        return self.surface is None

    def __str__(self) -> str:
        return f"pick {self.index}" if self.surface is None else f"place {self.index} {self.surface}"


Skeleton = tuple[Action, ...]
"""Actions in order; those of a domain alternate between a pick and the placement of the same object."""


@dataclass(frozen=True)
class SymbolicState:
    """What is held and what lies where.

    Attributes:
        surfaces: For each object what it lies on; None for the one that is held.
    """

    surfaces: tuple[Surface | None, ...]

    @property
    def held(self) -> int | None:
        """The object in the hand."""
        return self.surfaces.index(None) if None in self.surfaces else None

    def with_object(self, index: int, surface: Surface | None) -> "SymbolicState":
        """The state with one object elsewhere."""
        return SymbolicState((*self.surfaces[:index], surface, *self.surfaces[index + 1 :]))


@dataclass(frozen=True)
class Domain:
    """The actions of one scene.

    Attributes:
        n_objects: Number of movable objects.
        goal_index: The object that has to lie on the goal.
    """

    n_objects: int
    goal_index: int

    @property
    def initial(self) -> SymbolicState:
        """Everything on the floor, the hand empty."""
        return SymbolicState((Surface.FLOOR,) * self.n_objects)

    def actions(self, state: SymbolicState) -> list[Action]:
        """Every action that is possible in `state`; picks in the order of the objects, the goal before the floor."""
        if state.held is None:
            return [Action(index) for index in range(self.n_objects)]
        return [Action(state.held, surface) for surface in Surface]

    def successor(self, state: SymbolicState, action: Action) -> SymbolicState:
        """The state after `action`.

        Raises:
            ValueError: the action is not possible in `state`.
        """
        if action not in self.actions(state):
            raise ValueError(f"{action} is not possible with {state.held} held; there are {self.actions(state)}")
        return state.with_object(action.index, action.surface)

    def is_solved(self, state: SymbolicState) -> bool:
        """Whether the goal-object lies on the goal."""
        return state.surfaces[self.goal_index] is Surface.GOAL
