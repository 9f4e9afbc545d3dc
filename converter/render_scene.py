"""Pictures of scenes: floor, goal, walls, objects and agent in their true shapes, seen from above."""

import numpy as np

from converter.drawing import Drawing, Item, Rounded, Shape, box, disc, extent, footprint
from converter.replay import start_positions
from converter.scene import Body, Scene
from converter.shape import FloatArray
from converter.theme import PAPER, Color, Theme


def scene_drawing(scene: Scene, *, theme: Theme = PAPER) -> Drawing:
    """The scene at its start."""
    empty = room_drawing(scene, theme)
    unit = empty.unit
    movable = object_shapes(scene, start_positions(scene), unit, theme)
    agent = agent_shape(scene, scene.agent.position, unit, theme)
    return Drawing(empty.lower, empty.upper, empty.background, (*empty.items, *movable, agent))


def room_drawing(scene: Scene, theme: Theme) -> Drawing:
    """What never moves: floor, goal and walls."""
    lower, upper = _room(scene)
    unit = float((upper - lower).max()) / 600
    items: list[Item] = [
        Shape((box((lower + upper) / 2, upper - lower),), theme.floor),
        Shape(
            (box(scene.goal.position, scene.goal.size),),
            theme.goal,
            outline=theme.goal_dark,
            outline_width=theme.outline_width * unit,
        ),
    ]
    if scene.walls:
        parts = tuple(part for wall in scene.walls for part in footprint(wall))
        items.append(Shape(parts, theme.wall, outline=theme.wall_dark, outline_width=theme.outline_width * unit))
    margin = 2 * theme.outline_width * unit
    return Drawing(lower - margin, upper + margin, theme.page, tuple(items))


def body_shape(body: Body, color: Color, unit: float, theme: Theme, position: FloatArray | None = None) -> Shape:
    """An object at its own position or at `position` (2,) [m]; `unit` is that of the drawing."""
    return _outlined(footprint(body, position), color, unit, theme)


def object_shapes(scene: Scene, positions: FloatArray, unit: float, theme: Theme) -> list[Shape]:
    """All objects at `positions` (n_objects, 2) [m]; `unit` is that of the drawing."""
    return [
        body_shape(body, object_color(scene, body, theme), unit, theme, position)
        for body, position in zip(scene.objects, positions, strict=True)
    ]


def agent_shape(scene: Scene, position: FloatArray, unit: float, theme: Theme) -> Shape:
    """The agent at `position` (2,) [m]; `unit` is that of the drawing."""
    return _outlined((disc(position, scene.agent.radius),), theme.agent, unit, theme)


def object_color(scene: Scene, body: Body, theme: Theme) -> Color:
    """The object's own colour, or the theme's for the goal-object or for an obstacle with its place in the scene."""
    if body.color is not None and theme.own_colors:
        return body.color
    if body.name == scene.goal.object:
        return theme.goal_object
    obstacles = [name for name in scene.object_names if name != scene.goal.object]
    return theme.obstacles[obstacles.index(body.name) % len(theme.obstacles)]


def _outlined(parts: tuple[Rounded, ...], color: Color, unit: float, theme: Theme) -> Shape:
    return Shape(parts, color, outline=theme.outline, outline_width=theme.outline_width * unit)


def _room(scene: Scene) -> tuple[FloatArray, FloatArray]:
    """Lower and upper corner (2,) [m] of what the picture has to show."""
    bodies = [extent(footprint(body)) for body in (*scene.walls, *scene.objects)]
    agent = extent((disc(scene.agent.position, scene.agent.radius),))
    corners = np.concatenate([scene.bounds, *bodies, agent, extent((box(scene.goal.position, scene.goal.size),))])
    return corners.min(axis=0), corners.max(axis=0)
