"""Pictures of configuration spaces: where a point may be, the grasps of an object, and shortest paths."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from converter.drawing import Drawing, Inset, Item, Label, Line, Rounded, Shape, disc, footprint
from converter.render_scene import agent_shape, object_color, object_shapes, room_drawing
from converter.replay import start_positions
from converter.scene import Scene
from converter.shape import FloatArray
from converter.theme import PAPER, Theme

FORBIDDEN_OPACITY = 0.22
TREE_WIDTH, CURVE_WIDTH = 0.8, 4.0
TURN_RADIUS = 2.2
"""Widths and radii in units of the picture."""

MARGIN = 34.0
"""Height of the line above the room, in units of the picture."""


@dataclass(frozen=True, eq=False)
class Space:
    """What a panel shows.

    Attributes:
        title: The line above it.
        obstacles: The forbidden open sets, world.
        edges: (k, 2, 2) [m], world: the tree of shortest paths.
        free: (n, 2) [m], world, each: stretches of the contact curve where the agent may be.
        blocked: Likewise, where it may not.
        path: (n, 2) [m], world: one path; None for none.
        agent: (2,) [m], world: where the agent is.
        held: Object that the agent holds at the start of the path and at its end; None for none.
    """

    title: str
    obstacles: tuple[Rounded, ...]
    edges: FloatArray
    free: Sequence[FloatArray]
    blocked: Sequence[FloatArray]
    path: FloatArray | None
    agent: FloatArray
    held: str | None = None


def spaces_drawing(scene: Scene, spaces: Sequence[Space], *, theme: Theme = PAPER) -> Drawing:
    """The spaces side by side, each over the scene at its start."""
    panels = [_panel(scene, space, theme) for space in spaces]
    width, height = panels[0].upper - panels[0].lower
    insets = tuple(Inset(panel, np.array([i * width, 0.0]), width) for i, panel in enumerate(panels))
    return Drawing(np.zeros(2), np.array([len(panels) * width, height]), theme.page, insets)


def _panel(scene: Scene, space: Space, theme: Theme) -> Drawing:
    room = room_drawing(scene, theme)
    unit = room.unit
    inside = Drawing(room.lower, room.upper, room.background, (*room.items, *_items(scene, space, unit, theme)))
    margin = np.array([0.0, MARGIN * unit])
    heading = np.array([(room.lower[0] + room.upper[0]) / 2, room.upper[1] + margin[1] / 2])
    label = Label(space.title, heading, theme.text_height * unit, theme.outline)
    # As an inset, what reaches out of the room is cut off.
    inset = Inset(inside, room.lower, float(room.upper[0] - room.lower[0]))
    return Drawing(room.lower, room.upper + margin, theme.page, (inset, label))


def _items(scene: Scene, space: Space, unit: float, theme: Theme) -> list[Item]:
    items: list[Item] = [*object_shapes(scene, start_positions(scene), unit, theme)]
    items += [Shape(space.obstacles, theme.outline, FORBIDDEN_OPACITY)] if space.obstacles else []
    items += [Line(edge, TREE_WIDTH * unit, theme.move) for edge in space.edges]
    items += [Shape((disc(edge[1], TURN_RADIUS * unit),), theme.move) for edge in space.edges]
    items += [Line(curve, CURVE_WIDTH * unit, theme.bad) for curve in space.blocked]
    items += [Line(curve, CURVE_WIDTH * unit, theme.good) for curve in space.free]
    if space.path is not None:
        items.append(Line(space.path, theme.carry_width * unit, theme.goal_object))
        items += _end(scene, space, space.path, theme)
    items.append(agent_shape(scene, space.agent, unit, theme))
    return items


def _end(scene: Scene, space: Space, path: FloatArray, theme: Theme) -> list[Item]:
    """Faintly, agent and held object at the end of the path."""
    items: list[Item] = []
    if space.held is not None:
        body = scene.objects[scene.object_names.index(space.held)]
        parts = footprint(body, body.position[:2] + path[-1] - path[0])
        items.append(Shape(parts, object_color(scene, body, theme), theme.ghost_opacity))
    return [*items, Shape((disc(path[-1], scene.agent.radius),), theme.agent, 2 * theme.ghost_opacity)]
