"""Scenes: a disc-shaped agent, walls and movable objects on a floor, one of which has to reach a goal.

Metres and radians; world frame, x right, y up in every picture, z out of the floor (z = 0 is the floor). Dimensions
below: n vertices of a polygon. All values are immutable; `dataclasses.replace` makes variants.
"""

import hashlib
import json
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Self

import numpy as np

from converter.shape import FloatArray, Part, frozen_array, rotation, rounded

OUTER_WALL_PREFIX = "outwall_"
"""Walls with this prefix bound the room; geometry presets move their inner faces."""

AGENT = "agent"
"""What the agent is called wherever bodies are named; no wall or object may be called so."""

NUMERIC_SLACK = 1e-9
"""Slack of every geometric comparison [m], so that touching counts as free with tolerance 0."""


@dataclass(frozen=True, eq=False)
class Body:
    """A wall or a movable object: an upright prism over one or several rigidly joined convex parts.

    Attributes:
        name: Unique in its scene, and not `AGENT`.
        position: (3,) [m], world. Its x and y are the centre of the footprint, its z the middle of the height.
        height: Extent in z [m].
        parts: Convex parts of the footprint, in the frame of the body, before `yaw`.
        yaw: Rotation about z [rad].
        color: Red, green, blue in 0..1; None leaves the choice to the renderer.
    """

    name: str
    position: FloatArray
    height: float
    parts: tuple[Part, ...]
    yaw: float = 0.0
    color: tuple[float, float, float] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", frozen_array(self.position, (3,)))
        object.__setattr__(self, "parts", tuple(self.parts))
        if not self.name:
            raise ValueError("a body needs a name")
        if not self.parts:
            raise ValueError("a body needs at least one part")
        if not (np.isfinite(self.height) and self.height > 0):
            raise ValueError(f"height {self.height} must be positive")
        if not np.isfinite(self.yaw):
            raise ValueError(f"yaw {self.yaw} must be finite")

    @cached_property
    def cores(self) -> tuple[FloatArray, ...]:
        """The (n, 2) core polygons [m], turned by `yaw`, relative to `position`."""
        if self.yaw == 0:
            return tuple(part.core for part in self.parts)
        turn = rotation(self.yaw)
        return tuple(frozen_array(part.core @ turn, (None, 2)) for part in self.parts)

    @property
    def bottom_top(self) -> tuple[float, float]:
        """Height interval [m], world."""
        z = float(self.position[2])
        return z - self.height / 2, z + self.height / 2

    @cached_property
    def geometry(self) -> str:
        """Position, height and outline to 1 nm as text: equal for bodies that fill the same space.

        A convex polygon is the set of its vertices, so neither their order nor that of the parts counts.
        """
        parts = [
            [_rounded(part.edge_radius), sorted(_rounded(core))]
            for core, part in zip(self.cores, self.parts, strict=True)
        ]
        return json.dumps([_rounded(self.position), _rounded(self.height), sorted(parts)])

    def at(self, xy: FloatArray) -> Self:
        """The body moved to `xy` (2,) [m], world."""
        return replace(self, position=np.array([xy[0], xy[1], self.position[2]]))


@dataclass(frozen=True, eq=False)
class Agent:
    """An upright cylinder that translates in the plane and never turns.

    Attributes:
        position: (2,) [m], world: the centre at the start.
        radius: [m].
        height: [m]; the agent stands on the floor.
    """

    position: FloatArray
    radius: float
    height: float = 0.2

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", frozen_array(self.position, (2,)))
        for name in ("radius", "height"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise ValueError(f"{name} {value} must be positive")


@dataclass(frozen=True, eq=False)
class Goal:
    """The centre of `object` has to come to rest in an axis-aligned rectangle.

    Attributes:
        object: Name of the goal-object.
        position: (2,) [m], world: centre of the rectangle.
        size: (2,) [m].
    """

    object: str
    position: FloatArray
    size: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", frozen_array(self.position, (2,)))
        object.__setattr__(self, "size", frozen_array(self.size, (2,)))
        if (self.size <= 0).any():
            raise ValueError(f"size {self.size.tolist()} must be positive")

    def contains(self, xy: FloatArray) -> bool:
        """Whether the point `xy` (2,) [m] lies in the rectangle; its border belongs to it."""
        return bool((np.abs(xy - self.position) <= self.size / 2 + NUMERIC_SLACK).all())

    def distance(self, xy: FloatArray) -> float:
        """How far the point `xy` (2,) is from the rectangle [m]; 0 inside."""
        return float(np.hypot(*np.maximum(np.abs(xy - self.position) - self.size / 2, 0.0)))


@dataclass(frozen=True, eq=False)
class Scene:
    """A manipulation puzzle.

    Attributes:
        name: Name of the scene, by default the stem of its file.
        bounds: (2, 2) [m], world: lower and upper corner of the rectangle in which every centre has to stay.
        tolerance: The penetration that still counts as touching [m], >= 0.
        agent: The disc that grasps and carries.
        walls: Bodies that never move; those named `outwall_*` bound the room.
        objects: Movable bodies, standing on the floor.
        goal: Where the goal-object has to go.
        preset: `clear`, `published` or None for other geometry.
        source: Where the scene came from (level, options, imported file); plain values only.
    """

    name: str
    bounds: FloatArray
    tolerance: float
    agent: Agent
    walls: tuple[Body, ...]
    objects: tuple[Body, ...]
    goal: Goal
    preset: str | None = None
    source: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "bounds", frozen_array(self.bounds, (2, 2)))
        object.__setattr__(self, "walls", tuple(self.walls))
        object.__setattr__(self, "objects", tuple(self.objects))
        if (self.bounds[0] >= self.bounds[1]).any():
            raise ValueError(f"bounds {self.bounds.tolist()}: the lower corner must be below the upper one")
        if not (np.isfinite(self.tolerance) and self.tolerance >= 0):
            raise ValueError(f"tolerance {self.tolerance} must be >= 0")
        counts = Counter(body.name for body in (*self.walls, *self.objects))
        if repeated := sorted(name for name, count in counts.items() if count > 1):
            raise ValueError(f"names must be unique, found {', '.join(repeated)} twice")
        if AGENT in counts:
            raise ValueError(f"no wall or object may be called {AGENT!r}, which is what the agent is called")
        if self.goal.object not in self.object_names:
            raise ValueError(f"goal.object {self.goal.object!r} is not an object; there are {self.object_names}")

    @property
    def object_names(self) -> list[str]:
        """Names of the movable objects, in order."""
        return [body.name for body in self.objects]

    @property
    def goal_object(self) -> Body:
        """The object that has to reach the goal."""
        return self.object(self.goal.object)

    def object(self, name: str) -> Body:
        """The movable object called `name`.

        Raises:
            KeyError: there is none.
        """
        for body in self.objects:
            if body.name == name:
                return body
        raise KeyError(f"no object {name!r}; there are {self.object_names}")

    @cached_property
    def geometry_hash(self) -> str:
        """Sixteen hexadecimal digits over geometry and tolerance (to 1 nm), not over scene name, colours or source."""
        document = {
            "bounds": _rounded(self.bounds),
            "tolerance": _rounded(self.tolerance),
            "agent": [_rounded(self.agent.position), _rounded(self.agent.radius), _rounded(self.agent.height)],
            "walls": sorted(wall.geometry for wall in self.walls),
            "objects": [[body.name, body.geometry] for body in self.objects],
            "goal": [self.goal.object, _rounded(self.goal.position), _rounded(self.goal.size)],
        }
        return hashlib.sha256(json.dumps(document, sort_keys=True).encode()).hexdigest()[:16]


def heights_meet(first: tuple[float, float], second: tuple[float, float]) -> bool:
    """Whether two height intervals [m] overlap by more than rounding; bodies on top of each other do not."""
    return min(first[1], second[1]) - max(first[0], second[0]) > NUMERIC_SLACK


def _rounded(values: float | FloatArray) -> Any:
    return rounded(values, 9).tolist()
