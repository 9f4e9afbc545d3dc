"""A scene in the physics engine pymunk: its bodies, what they overlap, and which of them meet in height.

What to know of pymunk 7:

- Its defaults are meant for pixels: `collision_slop` is 0.1 units, here 10 cm; it is set to the tolerance.
- `Shape.shapes_collide` fails for shapes that do not touch; `Space.shape_query` does not.
- The sign of a contact's distance depends on the order in which the engine sorts the two shapes. Contacts exist only
  where shapes touch, so the depth is the absolute value.
- The engine's expanding polytope algorithm may degenerate, in deep overlaps of shapes with aligned features, and then
  answers with a zero normal and no depth. A nudge far below the slack breaks the tie.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pymunk

from converter.scene import AGENT, Body, Scene, heights_meet
from converter.shape import FloatArray, Part, rotation

ENGINE_SLACK = 1e-6
"""Error that the engine's contact depths may have [m]; also the slack of an object's height above the floor."""

_NUDGES = ((0.83e-7, 0.37e-7), (-0.29e-7, 0.91e-7), (0.53e-7, -0.61e-7))

# Categories of bodies, so that a query meets only the walls at the right height.
MEETS_AGENT, MEETS_GOAL_OBJECT, WALL, MOVABLE = 1, 2, 4, 8


@dataclass(frozen=True, eq=False)
class Placed:
    """A wall, an object or the agent in the engine."""

    name: str
    bottom_top: tuple[float, float]
    body: pymunk.Body
    shapes: tuple[pymunk.Shape, ...]

    @property
    def place(self) -> tuple[float, float]:
        """Its position [m], world."""
        return self.body.position.x, self.body.position.y

    def refresh(self) -> None:
        """Moves the shapes to where their body is; the engine itself does that when it steps."""
        for shape in self.shapes:
            shape.cache_bb()

    def meets_in_height(self, other: "Placed") -> bool:
        """Whether the height intervals of the two overlap."""
        return heights_meet(self.bottom_top, other.bottom_top)

    @property
    def box(self) -> FloatArray:
        """(2, 2) [m]: lower and upper corner of the bounding box."""
        boxes = [shape.cache_bb() for shape in self.shapes]
        lower = [min(box.left for box in boxes), min(box.bottom for box in boxes)]
        upper = [max(box.right for box in boxes), max(box.top for box in boxes)]
        return np.array([lower, upper])


@dataclass(frozen=True, eq=False)
class Contact:
    """An overlap: with what, how deep [m], and the unit normal (2,) between the two, zero if the engine failed."""

    other: Placed
    depth: float
    normal: FloatArray


class World:
    """The scene as a pymunk space: static walls, an agent and objects that can move, no gravity. The agent never turns.

    Args:
        scene: The scene.
        density: Of the objects [kg/m^3]; None gives them unit mass and keeps them from turning.

    Attributes:
        allowed: The penetration that still counts as touching [m].
    """

    def __init__(self, scene: Scene, density: float | None = None) -> None:
        self.scene = scene
        self._density = density
        self.allowed = scene.tolerance + ENGINE_SLACK
        self.space = pymunk.Space()
        self.space.collision_slop = self.allowed
        self.space.on_collision(begin=self._ignore_other_heights)
        self.owner: dict[pymunk.Shape, Placed] = {}
        self._outlines: dict[pymunk.Shape, tuple[FloatArray, float]] = {}
        self.walls = [self._place(wall, pymunk.Body.STATIC, self._category(wall)) for wall in scene.walls]
        self.objects = [self._place(body, pymunk.Body.DYNAMIC, MOVABLE) for body in scene.objects]
        agent = scene.agent
        disc = Part(np.zeros((1, 2)), agent.radius)
        cylinder = Body(AGENT, np.array([*agent.position, agent.height / 2]), agent.height, (disc,))
        self.agent = self._place(cylinder, pymunk.Body.DYNAMIC, MOVABLE)

    @property
    def movable(self) -> list[Placed]:
        """The objects and the agent."""
        return [*self.objects, self.agent]

    def contacts(self, placed: Placed) -> list[Contact]:
        """What `placed` overlaps in the plane, whatever the heights, and how."""
        place = placed.body.position
        contacts = self._contacts(placed)
        for nudge in _NUDGES:
            if all(contact.normal.any() for contact in contacts):
                break
            placed.body.position = place + nudge
            contacts = self._contacts(placed)
        placed.body.position = place
        placed.refresh()
        return contacts

    def depth(self, first: pymunk.Shape, second: pymunk.Shape) -> float:
        """How deep two shapes penetrate each other [m], negative if they are apart; exact, unlike the engine's."""
        (one, radius), (other, other_radius) = self._outline(first), self._outline(second)
        return radius + other_radius - signed_distance(one, other)

    def _outline(self, shape: pymunk.Shape) -> tuple[FloatArray, float]:
        """Core polygon (n, 2) [m], world, and edge radius [m]."""
        (core, radius), body = self._outlines[shape], self.owner[shape].body
        return core @ rotation(body.angle) + np.array(body.position), radius

    def _contacts(self, placed: Placed) -> list[Contact]:
        return [
            Contact(
                self.owner[info.shape],
                max(abs(point.distance) for point in info.contact_point_set.points),
                np.array(info.contact_point_set.normal),
            )
            for shape in placed.shapes
            for info in self.space.shape_query(shape)
            if info.shape is not None
        ]

    def _place(self, body: Body, body_type: int, categories: int) -> Placed:
        # With an infinite moment of inertia nothing turns.
        turns = self._density is not None and body_type == pymunk.Body.DYNAMIC and body.name != AGENT
        frame = pymunk.Body() if turns else pymunk.Body(1.0, math.inf, body_type=body_type)
        frame.position = float(body.position[0]), float(body.position[1])
        outlines = [(core, part.edge_radius) for core, part in zip(body.cores, body.parts, strict=True)]
        shapes = tuple(shape_of(frame, core, radius) for core, radius in outlines)
        for shape in shapes if turns else ():
            shape.density = (self._density or 0.0) * body.height
        placed = Placed(body.name, body.bottom_top, frame, shapes)
        self.space.add(frame, *shapes)
        for shape in shapes:
            # Shapes of one group do not collide: the parts of a body may overlap.
            shape.filter = pymunk.ShapeFilter(group=len(self.space.bodies), categories=categories)
            self.owner[shape] = placed
        self._outlines.update(zip(shapes, outlines, strict=True))
        return placed

    def _category(self, wall: Body) -> int:
        agent, goal_object = (0.0, self.scene.agent.height), self.scene.goal_object.bottom_top
        meets_agent = MEETS_AGENT if heights_meet(wall.bottom_top, agent) else 0
        meets_goal_object = MEETS_GOAL_OBJECT if heights_meet(wall.bottom_top, goal_object) else 0
        return meets_agent | meets_goal_object | WALL

    def _ignore_other_heights(self, arbiter: pymunk.Arbiter, _space: pymunk.Space, _data: Any) -> None:
        first, second = arbiter.shapes
        arbiter.process_collision = self.owner[first].meets_in_height(self.owner[second])


def shape_of(frame: pymunk.Body, core: FloatArray, radius: float) -> pymunk.Shape:
    """The polygon `core` (n, 2) [m], inflated by `radius` [m], as a shape of the engine."""
    vertices = [(float(x), float(y)) for x, y in core]
    if len(vertices) == 1:
        return pymunk.Circle(frame, radius, vertices[0])
    if len(vertices) == 2:
        return pymunk.Segment(frame, vertices[0], vertices[1], radius)
    return pymunk.Poly(frame, vertices, radius=radius)


def signed_distance(first: FloatArray, second: FloatArray) -> float:
    """Distance of two convex polygons (n, 2), (m, 2) [m]; of those that overlap the penetration, negative.

    It is the largest gap between their projections on a line. That is on the normal of an edge or, between two corners,
    on the line that joins them.
    """
    corners = (second[:, None] - first[None]).reshape(-1, 2)
    directions = np.concatenate([corners, _normals(first), -_normals(second)])
    lengths = np.hypot(*directions.T)
    directions = directions[lengths > 0] / lengths[lengths > 0, None]
    if len(directions) == 0:
        return 0.0
    return float(((directions @ second.T).min(axis=1) - (directions @ first.T).max(axis=1)).max())


def _normals(polygon: FloatArray) -> FloatArray:
    """Outward normals (n, 2) of the edges of a counter-clockwise polygon."""
    edges = np.roll(polygon, -1, axis=0) - polygon
    return np.column_stack([edges[:, 1], -edges[:, 0]])
