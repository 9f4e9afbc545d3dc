"""Pictures of plans: one image that shows the whole motion.

The scene stands as it is at the start. The agent's path is thin and grey where it drives alone, thick and in the
object's colour where it carries. Translucent shapes with numbers show where objects are placed, in order, and one
without a number where the agent ends.
"""

from dataclasses import dataclass, replace

import numpy as np

from converter.drawing import Drawing, Item, Label, Line, Rounded, Shape
from converter.plan import Plan
from converter.polyline import path_length
from converter.render_scene import agent_shape, body_shape, object_color, scene_drawing
from converter.replay import Step, points_along, replay
from converter.scene import Body, Scene
from converter.shape import FloatArray, rotation
from converter.theme import PAPER, Color, Theme, mixed

SAME_PLACE = 1e-3
"""Placements of an object at one point of a grid of this pitch [m] share one shape and one label."""

LABELLED = 3
"""Numbers that a shared label lists."""

GHOST_SHADE = 0.55
"""Share of the outline's colour in the outlines of translucent shapes and of paths."""

CASING = 1.0
"""Width of the outline of carrying paths, in units of the picture; without it white ones would not show."""

ARROW = np.array([[0.5, 0.0], [-0.5, 0.5], [-0.5, -0.5]])
"""Triangle of unit length that points right, its middle at the origin."""

ARROW_LENGTH = 9.0
"""Arrow heads show the direction of paths at least three times as long, in units of the picture."""


@dataclass(frozen=True, eq=False)
class Placement:
    """A place where an object is put down, once or several times.

    Attributes:
        body: The object.
        position: (2,) [m], world: its centre there.
        numbers: Which of the plan's placements these are, counted from 1.
    """

    body: Body
    position: FloatArray
    numbers: tuple[int, ...]


def plan_drawing(scene: Scene, plan: Plan, *, theme: Theme = PAPER) -> Drawing:
    """The plan over the scene at its start.

    Raises:
        InputError: the plan carries an object that the scene does not have.
    """
    start = scene_drawing(scene, theme=theme)
    unit = start.unit
    steps = replay(scene, plan)
    if not steps:
        return start
    carries = carries_of(scene, steps)
    places = placements(carries)
    end = agent_shape(scene, steps[-1].segment.path[-1], unit, theme)
    items: list[Item] = [_ghost(end, theme)]
    for place in places:
        color = object_color(scene, place.body, theme)
        items.append(_ghost(body_shape(place.body, color, unit, theme, place.position), theme))
    for body, step in carries:
        items += _carry_path(step.segment.path, object_color(scene, body, theme), unit, theme)
    for step in steps:
        if step.carried is None:
            items += _move_path(step.segment.path, unit, theme)
    for place in places:
        items += _badge(place, object_color(scene, place.body, theme), unit, theme)
    return replace(start, items=(*start.items, *items))


def carries_of(scene: Scene, steps: list[Step]) -> list[tuple[Body, Step]]:
    """The carries among `steps`, each with its object."""
    return [(scene.objects[step.carried], step) for step in steps if step.carried is not None]


def placements(carries: list[tuple[Body, Step]]) -> list[Placement]:
    """Where carries, each with its object, end; those of one object at one place are one."""
    found: dict[tuple[str, int, int], Placement] = {}
    for number, (body, step) in enumerate(carries, start=1):
        position = step.segment.path[-1] + step.offset
        column, row = np.rint(position / SAME_PLACE).astype(int).tolist()
        known = found.setdefault((body.name, column, row), Placement(body, position, ()))
        found[body.name, column, row] = replace(known, numbers=(*known.numbers, number))
    return list(found.values())


def _ghost(shape: Shape, theme: Theme) -> Shape:
    return replace(
        shape,
        fill_opacity=theme.ghost_opacity,
        outline=mixed(shape.fill, theme.outline, GHOST_SHADE),
        outline_width=0.8 * shape.outline_width,
    )


def carry_lines(path: FloatArray, color: Color, unit: float, theme: Theme) -> list[Line]:
    """A path (n, 2) [m] of carrying in the object's colour, with an outline; `unit` is that of the drawing."""
    width = theme.carry_width * unit
    return [Line(path, width + 2 * CASING * unit, mixed(color, theme.outline, GHOST_SHADE)), Line(path, width, color)]


def _carry_path(path: FloatArray, color: Color, unit: float, theme: Theme) -> list[Item]:
    casing = mixed(color, theme.outline, GHOST_SHADE)
    heads = _arrow(path, 2 * ARROW_LENGTH * unit)
    arrow = [Shape((head,), color, outline=casing, outline_width=CASING * unit) for head in heads]
    return [*carry_lines(path, color, unit, theme), *arrow]


def _move_path(path: FloatArray, unit: float, theme: Theme) -> list[Item]:
    heads = [Shape((head,), theme.move) for head in _arrow(path, ARROW_LENGTH * unit)]
    return [Line(path, theme.move_width * unit, theme.move), *heads]


def _arrow(path: FloatArray, length: float) -> list[Rounded]:
    """An arrow head of `length` [m] in the middle of a path; none if the path is too short for one."""
    total = path_length(path)
    if total < 3 * length:
        return []
    before, middle, after = points_along(path, total / 2 + length / 4 * np.array([-1.0, 0.0, 1.0]))
    heading = float(np.arctan2(*(after - before)[::-1]))
    return [Rounded(middle + length * ARROW @ rotation(heading), 0.0)]


def _badge(place: Placement, color: Color, unit: float, theme: Theme) -> list[Item]:
    """The numbers of a placement on a plate at its centre."""
    shown = [str(number) for number in place.numbers[:LABELLED]]
    text = ",".join(shown) + ("…" if len(place.numbers) > LABELLED else "")
    height = theme.text_height * unit
    half_width = np.array([(len(text) - 1) * 0.25 * height, 0.0])
    ends = np.unique([place.position - half_width, place.position + half_width], axis=0)
    outline = mixed(color, theme.outline, GHOST_SHADE)
    return [
        Shape((Rounded(ends, 0.6 * height),), theme.badge, outline=outline, outline_width=theme.outline_width * unit),
        Label(text, place.position, height, theme.outline),
    ]
