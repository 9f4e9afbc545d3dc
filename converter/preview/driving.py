"""Driving along a path in the physics engine: a disc that is only told how fast to go.

The controller aims at a point that runs along the path ahead of the disc and waits for it where it is held up. So the
disc follows the path as exactly as the engine lets it, and bodies in its way hold it up or are pushed aside: both are
reported. With the last leg of the path leading against an object, this is a preview of pushing it.
"""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import pymunk

from converter.preview.simulation import SPEED, Moved, Place, Simulation, Touch
from converter.scene import AGENT, Scene
from converter.shape import FloatArray, frozen_array

ARRIVED = 1e-3
"""How near to the end of its path the disc has arrived, besides the tolerance [m]."""

TIME_STEP = 1 / 100
"""[s]."""

LEAD = 1.5 * SPEED * TIME_STEP
"""The point that the disc follows waits where it is this far ahead [m]; on its way it is one step ahead."""

PATIENCE_S = 0.5
"""A disc whose point has waited for this long is stuck [s]."""


@dataclass(frozen=True)
class Drive:
    """What became of a drive.

    Attributes:
        reached: Whether the disc arrived at the end of its path.
        end: Where it was at last [m], world.
        short_by: Distance from there to the end of the path [m].
        time_s: Time driven [s].
        touches: What the agent or a pushed object touched.
        moved: Objects that were pushed.
    """

    reached: bool
    end: Place
    short_by: float
    time_s: float
    touches: tuple[Touch, ...]
    moved: tuple[Moved, ...]


def drive(scene: Scene, path: FloatArray) -> Drive:
    """Drives along `path` (n, 2) [m], world, with the objects of `scene` where they are at its start."""
    path = frozen_array(path, (None, 2))
    simulation = Simulation(scene, TIME_STEP)
    agent = simulation.world.agent.body
    agent.position = float(path[0, 0]), float(path[0, 1])
    points = _points(path)
    aim = waited = 0

    def follow(body: pymunk.Body, _gravity: Any, _damping: float, _dt: float) -> None:
        # Set here and not before the step, because the engine moves bodies first and looks for contacts afterwards.
        x, y = points[aim]
        dx, dy = x - body.position.x, y - body.position.y
        faster = math.hypot(dx, dy) / (SPEED * TIME_STEP)
        scale = 1 / (TIME_STEP * max(faster, 1.0))
        body.velocity = dx * scale, dy * scale

    agent.velocity_func = follow
    while waited < PATIENCE_S / TIME_STEP:
        distance = math.dist(agent.position, points[aim])
        if aim == len(points) - 1 and distance <= ARRIVED / 10:
            break
        if aim < len(points) - 1 and distance <= LEAD:
            aim, waited = aim + 1, 0
        else:
            waited += 1
        simulation.step()
    short_by = math.dist(agent.position, points[-1])
    moved = simulation.moved()
    movers = {AGENT, *(each.object for each in moved)}
    return Drive(
        reached=short_by <= ARRIVED + simulation.world.allowed,
        end=simulation.world.agent.place,
        short_by=short_by,
        time_s=simulation.time_s,
        touches=tuple(touch for touch in simulation.touches if movers.intersection(touch.bodies)),
        moved=moved,
    )


def _points(path: FloatArray) -> list[Place]:
    """Points along the path, one for each step of time, all of its vertices among them."""
    points = [tuple(path[0].tolist())]
    for start, end in pairwise(path):
        steps = max(1, math.ceil(float(np.hypot(*(end - start))) / (SPEED * TIME_STEP)))
        points += map(tuple, (start + np.linspace(0, 1, steps + 1)[1:, None] * (end - start)).tolist())
    return points
