"""A scene in motion: what is pushed moves, and stops as soon as it is not pushed any more.

Objects lie on a floor with friction, so they keep no velocity from one step to the next; what moves them are contacts
alone. How a pushed object turns follows from its mass and inertia, as for a floor whose limit surface is an ellipsoid
with the object's radius of gyration as characteristic length (Howe and Cutkosky 1996; Lynch and Mason 1996).

Contacts up to the scene's tolerance are touching, and have no effect.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pymunk
from pymunk import Vec2d

from converter.preview.world import Placed, World
from converter.scene import Scene

SPEED = 1.0
"""Of the agent at most [m/s]."""

DENSITY = 500.0
"""Of the objects, that of wood [kg/m^3]."""

AGENT_MASS = 200.0
"""[kg]; heavy, so that what it pushes hardly slows it down."""

FRICTION = 0.5
"""Of agent and objects; that of a pair is the product. Walls have none, so that what slides along them is not held."""

MOVED = 1e-3
"""Whatever moves by more than this has been moved [m]."""

CONTACT_ERROR = 1e-3
"""A contact whose depth is wrong by more than this has a wrong direction as well [m]."""

Place = tuple[float, float]
"""x and y [m], world."""


@dataclass(frozen=True)
class Touch:
    """Two bodies that touched.

    Attributes:
        bodies: Their names: `agent` first, then objects, then walls.
        depth: Greatest penetration [m].
        where: Place of that contact [m], world.
    """

    bodies: tuple[str, str]
    depth: float
    where: Place


@dataclass(frozen=True)
class Moved:
    """An object that is not where it was.

    Attributes:
        object: Its name.
        start: Where its centre was [m], world.
        end: Where it is.
        turned: Angle by which it turned [rad], counter-clockwise.
    """

    object: str
    start: Place
    end: Place
    turned: float

    @property
    def distance(self) -> float:
        """How far the centre is from where it was [m]."""
        return math.dist(self.start, self.end)


class Simulation:
    """A world with a clock. State: the world, and the contacts so far.

    Args:
        scene: The scene at its start.
        time_step: [s].
    """

    def __init__(self, scene: Scene, time_step: float) -> None:
        self.world = World(scene, DENSITY)
        self.time_step = time_step
        space = self.world.space
        space.damping = 0.0
        space.iterations = 50
        space.collision_bias = 0.0  # penetration is corrected within one step
        space.on_collision(pre_solve=self._touch)
        self.world.agent.body.mass = AGENT_MASS
        for placed in self.world.movable:
            for shape in placed.shapes:
                shape.friction = FRICTION
        everything = [self.world.agent, *self.world.objects, *self.world.walls]
        self._order = {placed.name: i for i, placed in enumerate(everything)}
        self._touches: dict[tuple[str, str], Touch] = {}
        self._steps = 0
        self._pressed: dict[tuple[pymunk.Shape, pymunk.Shape], int] = {}
        self._starts = self._places()

    @property
    def touches(self) -> tuple[Touch, ...]:
        """All pairs that have touched since the last `forget`, in the order of their first contact."""
        return tuple(self._touches.values())

    def step(self) -> None:
        """Moves everything on by `time_step`."""
        self.world.space.step(self.time_step)
        self._steps += 1

    @property
    def time_s(self) -> float:
        """What the clock shows [s]."""
        return self._steps * self.time_step

    def forget(self) -> None:
        """Forgets all contacts, and takes the present places for the starts of the objects."""
        self._touches.clear()
        self._starts = self._places()

    def moved(self, more_than: float = MOVED) -> tuple[Moved, ...]:
        """The objects that have moved since the last `forget`, with a corner at least, by `more_than` that [m]."""
        found = []
        for placed in self.world.objects:
            place, angle = self._starts[placed.name]
            moved = Moved(placed.name, place, placed.place, placed.body.angle - angle)
            if moved.distance + abs(moved.turned) * reach(placed) > more_than:
                found.append(moved)
        return tuple(found)

    def _places(self) -> dict[str, tuple[Place, float]]:
        """Where each object is, and its angle [rad]."""
        return {placed.name: (placed.place, placed.body.angle) for placed in self.world.objects}

    def _touch(self, arbiter: pymunk.Arbiter, _space: pymunk.Space, _data: Any) -> None:
        shapes = arbiter.shapes
        first, second = (self.world.owner[shape] for shape in shapes)
        if not first.meets_in_height(second):
            arbiter.process_collision = False
            return
        deepest = max(arbiter.contact_point_set.points, key=lambda point: abs(point.distance))
        claimed = depth = abs(deepest.distance)
        # What has been pressed goes on being pressed until it is left: the engine keeps it at the tolerance.
        pressed = self._pressed.get(shapes) == self._steps - 1
        if depth > self.world.allowed:
            # Where edges are aligned, the engine may take the depth along another axis. Such contacts are left out.
            depth = self.world.depth(*shapes)
            pressed = (pressed or depth > self.world.allowed) and abs(claimed - depth) < CONTACT_ERROR
        arbiter.process_collision = pressed
        if pressed:
            self._pressed[shapes] = self._steps
        self._note((first.name, second.name), depth, (deepest.point_a + deepest.point_b) / 2)

    def _note(self, names: tuple[str, str], depth: float, where: Vec2d) -> None:
        first, second = sorted(names, key=self._order.__getitem__)
        if (first, second) not in self._touches or depth > self._touches[first, second].depth:
            self._touches[first, second] = Touch((first, second), depth, (where.x, where.y))


def reach(placed: Placed) -> float:
    """Distance of the farthest point of a body from its centre [m], or a little more."""
    lower, upper = abs(placed.box - np.array(placed.place))
    return float(np.hypot(*np.maximum(lower, upper)))
