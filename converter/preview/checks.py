"""A static check of scenes in a 2D physics engine (pymunk): is this a puzzle that can be set up and begun?

Nothing may overlap by more than the scene's tolerance, everything lies inside, objects stand on the floor and stay
where they are when the world is stepped, walls leave the agent room to move, and the goal-object fits into the goal.
That a scene is valid does not mean that it can be solved.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from itertools import product

import numpy as np
import pymunk

from converter.preview.simulation import MOVED
from converter.preview.world import ENGINE_SLACK, MEETS_AGENT, MEETS_GOAL_OBJECT, Placed, World
from converter.scene import AGENT, NUMERIC_SLACK, OUTER_WALL_PREFIX, Scene
from converter.shape import FloatArray

_STEPS, _TIME_STEP = 100, 0.01
_COMPASS = 16
_GOAL_GRID = 32


class ProblemKind(StrEnum):
    """Why a scene is not valid."""

    OVERLAP = "overlap"
    """Two bodies penetrate deeper than the tolerance; amount: the penetration [m]."""
    OUT_OF_BOUNDS = "out_of_bounds"
    """The centre of a body is outside the bounds; amount: by how much [m]."""
    OUTSIDE_WALLS = "outside_walls"
    """A body reaches beyond the outer walls; amount: by how much [m]."""
    NOT_ON_FLOOR = "not_on_floor"
    """An object does not stand on the floor; amount: height of its bottom [m]."""
    NOT_AT_REST = "not_at_rest"
    """A body moves when the world is stepped; amount: distance after one second [m]."""
    AGENT_STUCK = "agent_stuck"
    """Walls block every direction."""
    GOAL_OUT_OF_BOUNDS = "goal_out_of_bounds"
    """The goal rectangle lies outside the bounds; amount: by how much [m]."""
    GOAL_COVERED = "goal_covered"
    """Walls leave no place in the goal for the goal-object."""


@dataclass(frozen=True)
class Problem:
    """One reason why a scene is not valid.

    Attributes:
        kind: What is wrong.
        bodies: Names of the bodies concerned; the agent is `agent`.
        amount: By how much [m]; see `ProblemKind`.
        message: One line for people.
    """

    kind: ProblemKind
    bodies: tuple[str, ...]
    amount: float | None
    message: str


@dataclass(frozen=True)
class SceneCheck:
    """What the preview found.

    Attributes:
        scene: Name of the scene.
        problems: Empty if the scene is valid.
    """

    scene: str
    problems: tuple[Problem, ...]

    @property
    def valid(self) -> bool:
        """Whether there are no problems."""
        return not self.problems


def check_scene(scene: Scene) -> SceneCheck:
    """Builds the scene in pymunk and lists what is wrong with it."""
    world = World(scene)
    problems = (
        *_overlaps(world),
        *_outside(world),
        *_floating(scene),
        *_stuck(world),
        *_goal(world),
        *_moving(world),  # last, because it changes the world
    )
    return SceneCheck(scene.name, problems)


def _overlaps(world: World) -> Iterator[Problem]:
    deepest: dict[tuple[str, str], float] = {}
    for placed in world.movable:
        for contact in world.contacts(placed):
            if placed.meets_in_height(contact.other):
                # Two movable bodies find each other: the pair keeps the order in which it is found first.
                pair, swapped = (placed.name, contact.other.name), (contact.other.name, placed.name)
                pair = swapped if swapped in deepest else pair
                deepest[pair] = max(contact.depth, deepest.get(pair, 0.0))
    for pair, depth in deepest.items():
        if depth > world.allowed:
            yield Problem(ProblemKind.OVERLAP, pair, depth, f"{pair[0]} and {pair[1]} overlap by {depth:.6g} m")


def _outside(world: World) -> Iterator[Problem]:
    """Centres outside the bounds, and bodies that reach beyond the outer faces of the outer walls."""
    outer = [wall.box for wall in world.walls if wall.name.startswith(OUTER_WALL_PREFIX)]
    room = np.array([np.min(outer, axis=0)[0], np.max(outer, axis=0)[1]]) if outer else None
    for placed in world.movable:
        beyond = _excess(np.array([placed.body.position]), world.scene.bounds)
        if beyond > NUMERIC_SLACK:
            message = f"the centre of {placed.name} is {beyond:.6g} m outside the bounds"
            yield Problem(ProblemKind.OUT_OF_BOUNDS, (placed.name,), beyond, message)
        if room is not None and (beyond := _excess(placed.box, room)) > world.allowed:
            message = f"{placed.name} reaches {beyond:.6g} m beyond the outer walls"
            yield Problem(ProblemKind.OUTSIDE_WALLS, (placed.name,), beyond, message)


def _excess(points: FloatArray, rectangle: FloatArray) -> float:
    """How far the farthest of `points` (n, 2) is outside `rectangle` (2, 2) along an axis [m]; 0 inside."""
    return max(0.0, float((rectangle[0] - points).max()), float((points - rectangle[1]).max()))


def _floating(scene: Scene) -> Iterator[Problem]:
    for body in scene.objects:
        bottom = body.bottom_top[0]
        if abs(bottom) > ENGINE_SLACK:
            message = f"{body.name} does not stand on the floor: its bottom is at z = {bottom:.6g} m"
            yield Problem(ProblemKind.NOT_ON_FLOOR, (body.name,), bottom, message)


def _stuck(world: World) -> Iterator[Problem]:
    """Whether walls block a step of a tenth of the agent's radius in every direction.

    Only walls count, because objects can be carried away. The free directions at a contact end at its tangent, and a
    single free direction is a tangent; so tangents are tried besides the points of a compass. A step may go as deep
    into walls, and as far out of bounds, as the start is.
    """
    agent, bounds = world.scene.agent, world.scene.bounds
    step = agent.radius / 10
    start = world.contacts(_swept_disc(agent.position, agent.position, agent.radius))
    near = world.contacts(_swept_disc(agent.position, agent.position, agent.radius + step))
    allowed = max([world.allowed, *(contact.depth + ENGINE_SLACK for contact in start)])
    beyond = _excess(agent.position[np.newaxis], bounds) + NUMERIC_SLACK
    angles = np.arange(_COMPASS) * 2 * np.pi / _COMPASS
    tangents = [contact.normal[::-1] * signs for contact in near for signs in ((1, -1), (-1, 1))]
    for direction in [*np.column_stack([np.cos(angles), np.sin(angles)]), *tangents]:
        end = agent.position + step * direction
        contacts = world.contacts(_swept_disc(agent.position, end, agent.radius))
        if _excess(end[np.newaxis], bounds) <= beyond and all(contact.depth <= allowed for contact in contacts):
            return
    yield Problem(ProblemKind.AGENT_STUCK, (AGENT,), None, f"walls keep the agent from moving by {step:.6g} m")


def _swept_disc(start: FloatArray, end: FloatArray, radius: float) -> Placed:
    """A disc of `radius` [m] on its way from `start` to `end`, (2,) [m] each; it meets walls at the agent's height."""
    frame = pymunk.Body(body_type=pymunk.Body.STATIC)
    shape = pymunk.Segment(frame, (float(start[0]), float(start[1])), (float(end[0]), float(end[1])), radius)
    shape.filter = pymunk.ShapeFilter(mask=MEETS_AGENT)
    return Placed(AGENT, (-math.inf, math.inf), frame, (shape,))


def _goal(world: World) -> Iterator[Problem]:
    goal, bounds = world.scene.goal, world.scene.bounds
    lower = np.maximum(goal.position - goal.size / 2, bounds[0])
    upper = np.minimum(goal.position + goal.size / 2, bounds[1])
    beyond = float((lower - upper).max())
    if beyond > NUMERIC_SLACK:
        message = f"the goal is {beyond:.6g} m outside the bounds"
        yield Problem(ProblemKind.GOAL_OUT_OF_BOUNDS, (goal.object,), beyond, message)
    elif _covered(world, lower, upper):
        message = f"walls leave no place in the goal for {goal.object}"
        yield Problem(ProblemKind.GOAL_COVERED, (goal.object,), None, message)


def _covered(world: World, lower: FloatArray, upper: FloatArray) -> bool:
    """Whether walls certainly forbid every centre of the goal-object in a rectangle.

    The footprint contains a disc of radius r about its centre. If a centre q is allowed, every wall is at least
    r - `allowed` away from it, hence at least r - `allowed` - d away from a point at distance d of q. So no centre in
    a cell with half-diagonal d is allowed if a wall is nearer than that to the middle of the cell.
    """
    body = next(placed for placed in world.objects if placed.name == world.scene.goal.object)
    radius = max(0.0, *(-shape.point_query(body.body.position).distance for shape in body.shapes))
    cell = (upper - lower) / _GOAL_GRID
    nearer = radius - world.allowed - float(np.hypot(*cell)) / 2
    walls = pymunk.ShapeFilter(mask=MEETS_GOAL_OBJECT)
    xs, ys = (lower[axis] + cell[axis] * (np.arange(_GOAL_GRID) + 0.5) for axis in (0, 1))
    return all(world.space.point_query_nearest((float(x), float(y)), nearer, walls) for x, y in product(xs, ys))


def _moving(world: World) -> Iterator[Problem]:
    """Steps the world for a second, which changes it."""
    starts = [placed.body.position for placed in world.movable]
    for _ in range(_STEPS):
        world.space.step(_TIME_STEP)
    for placed, start in zip(world.movable, starts, strict=True):
        distance = (placed.body.position - start).length
        if distance > MOVED:
            message = f"{placed.name} does not rest: the engine moves it by {distance:.6g} m"
            yield Problem(ProblemKind.NOT_AT_REST, (placed.name,), distance, message)
