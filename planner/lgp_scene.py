"""The numbers of a scene that logic-geometric programs take as parameters, and the structure they are built for."""

from collections.abc import Iterator
from dataclasses import dataclass

import casadi as ca
import numpy as np

from converter.shape import FloatArray
from planner.configuration_space import ObstacleSet, contact_border
from planner.lgp_constraints import PolygonBlock
from planner.logic import Surface
from planner.pick_place import Region
from planner.problem import Problem

Packed = tuple[PolygonBlock, ca.MX]
"""The structure of an obstacle set and its parameters."""


@dataclass(frozen=True)
class LgpStructure:
    """What a program's graph depends on besides the skeleton.

    Attributes:
        n_objects: Number of movable objects.
        blocks: Structure of each obstacle set, in the order of `obstacle_sets`.
    """

    n_objects: int
    blocks: tuple[PolygonBlock, ...]

    @classmethod
    def of(cls, problem: Problem) -> "LgpStructure":
        """The structure of a scene."""
        return cls(problem.n_objects, tuple(PolygonBlock.of(obstacles) for obstacles in obstacle_sets(problem)))


def obstacle_sets(problem: Problem) -> Iterator[ObstacleSet]:
    """Walls for the agent, objects for the agent, cores to be touched, walls for objects, objects for objects."""
    yield problem.agent_walls
    yield from problem.agent_objects
    for body in problem.scene.objects:
        yield contact_border(problem.scene.agent.radius, body)
    yield from problem.object_walls
    for row in problem.object_objects:
        yield from row


def pack(problem: Problem) -> FloatArray:
    """The parameters of every program of the scene; see `SceneSymbols`."""
    goal = Region.of_goal(problem.scene.goal)
    return np.concatenate(
        [
            problem.initial.agent,
            problem.initial.objects.ravel(),
            goal.lower,
            goal.upper,
            problem.scene.bounds.ravel(),
            *(PolygonBlock.of(obstacles).pack(obstacles) for obstacles in obstacle_sets(problem)),
        ]
    )


class SceneSymbols:
    """The parameters of a structure, symbolically.

    Attributes:
        p: All parameters in the order of `pack`.
        start: (2,) [m] agent centre at the start.
        objects: (2,) [m] position of each object at the start.
        surfaces: Lower and upper corner (2,) [m] of where centres have to be on each surface.
        agent_walls: Obstacles of the agent.
        agent_objects: What each object is to the agent, relative to its position.
        parts: The cores of each object with the radii at which the agent touches them, relative to its position.
        object_walls: Obstacles of each object.
        object_objects: What object k is to object i at [i][k], relative to the position of k.
    """

    def __init__(self, structure: LgpStructure) -> None:
        n = structure.n_objects
        vectors = [ca.MX.sym(name, 2) for name in ("start", *(f"object_{k}" for k in range(n)))]
        corners = [ca.MX.sym(name, 2) for name in ("goal_lower", "goal_upper", "lower", "upper")]
        packed = [(block, ca.MX.sym(f"set_{k}", block.size)) for k, block in enumerate(structure.blocks)]
        self.p = ca.vertcat(*vectors, *corners, *(symbol for _, symbol in packed))
        self.start, *self.objects = vectors
        self.surfaces = {Surface.GOAL: (corners[0], corners[1]), Surface.FLOOR: (corners[2], corners[3])}
        sets: Iterator[Packed] = iter(packed)
        self.agent_walls = next(sets)
        self.agent_objects = [next(sets) for _ in range(n)]
        self.parts = [next(sets) for _ in range(n)]
        self.object_walls = [next(sets) for _ in range(n)]
        self.object_objects = [[next(sets) for _ in range(n)] for _ in range(n)]
