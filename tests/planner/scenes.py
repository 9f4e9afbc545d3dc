"""Small scenes built in code, and what the independent verifier says about steps in them."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from converter.plan import Status
from converter.scene import Agent, Body, Goal, Scene
from converter.shape import FloatArray, Part, rotation
from planner.assemble import segments_of, subgoals_of
from planner.pick_place import PickPlace
from planner.result import PlanResult
from planner.settings import Settings
from planner.verify import ViolationKind, verify

RADIUS = 0.2
HEIGHT = 0.2


def body(name: str, x: float, y: float, *parts: Part, yaw: float = 0.0, z: float = HEIGHT / 2) -> Body:
    """A body of height 0.2, by default on the floor and a sharp box of side 0.2."""
    return Body(name, np.array([x, y, z]), HEIGHT, parts or (Part.box((0.2, 0.2)),), yaw)


def wall(x: float, y: float, sx: float, sy: float, edge_radius: float = 0.0) -> Body:
    """A box-shaped wall, named after its place."""
    return body(f"wall at {x:g}, {y:g}", x, y, Part.box((sx, sy), edge_radius))


def room(
    *walls: Body,
    objects: Sequence[Body] = (),
    agent: tuple[float, float] = (0.0, 0.0),
    goal: tuple[float, float] = (1.5, 1.5),
    goal_size: tuple[float, float] = (0.35, 0.35),
    tolerance: float = 0.0,
    half: float = 2.0,
) -> Scene:
    """A square room of side 2 `half` that only the bounds confine; by default the object stands at (1.5, -1.5)."""
    objects = tuple(objects) or (body("obj", 1.5, -1.5),)
    return Scene(
        name="room",
        bounds=np.array([[-half, -half], [half, half]]),
        tolerance=tolerance,
        agent=Agent(np.array(agent), RADIUS),
        walls=walls,
        objects=objects,
        goal=Goal(objects[0].name, np.array(goal), np.array(goal_size)),
    )


def turned(one: Body, yaw: float) -> Body:
    """The body turned about the origin of the world."""
    x, y = one.position[:2] @ rotation(yaw)
    return replace(one, position=np.array([x, y, one.position[2]]), yaw=one.yaw + yaw)


def vectors(*rows: Sequence[float]) -> FloatArray:
    """Rows (n, 2) of plain numbers."""
    return np.array(rows, dtype=float)


def violations(scene: Scene, *steps: PickPlace) -> set[ViolationKind]:
    """What the verifier finds in the plan of these steps."""
    result = PlanResult(Status.SOLVED, 0.0, segments_of(scene, steps), subgoals_of(scene, steps))
    return {violation.kind for violation in verify(scene, result.to_plan(scene, Settings(), 0))}
