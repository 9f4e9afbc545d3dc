"""Scenes as `.g` files for the engine `rai`, laid out like the published ones; `converter.formats.rai_g` reads them back.

- Sharp boxes are `box`, rounded ones `ssBox`, discs `ssCylinder`, all other parts `ssCvx`: a core swept by a sphere,
  whose corners have to be round, so sharp polygons are written with a radius far below every tolerance, `SHARP`.
- The engine rounds a shape alike in all directions, hence also its top and bottom: a part must be higher than two
  edge radii.
- A wall of several parts becomes several frames, which are read back as several walls. Objects keep their parts.
- What `.g` files have no word for stands in attributes that the engine ignores: tolerance and preset at `floor`, the
  goal-object's name at `goal`.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from converter.formats.body_document import short
from converter.formats.rai_g import NEVER_COLLIDING, SHARP
from converter.formats.safe_names import safe_names
from converter.outline import rectangle_of
from converter.scene import Body, Scene
from converter.shape import FloatArray, Part, denoised
from pcg.errors import InputError
from pcg.files import write_text

FLOOR_THICKNESS = 0.1
"""[m]; the floor's top is at z = 0."""

GOAL_HEIGHT = 0.1
CYLINDER_EDGE = 0.02
"""Largest edge radius of cylinders [m], which only rounds their top and bottom."""

_RESERVED = (*sorted(NEVER_COLLIDING), "world", "egoJoint", "ego", "camera_gl", "Include")


@dataclass(frozen=True, eq=False)
class _Shape:
    """A shape as attributes, and where it is in the frame of its body: (2,) [m] and [rad]."""

    attributes: str
    offset: FloatArray
    yaw: float

    @property
    def is_centred(self) -> bool:
        return not self.offset.any() and self.yaw == 0


def write_rai_g(path: Path, scene: Scene) -> None:
    """Writes a scene as a `.g` file.

    Raises:
        InputError: the engine has no shape for a part, or the path cannot be written.
    """
    write_text(path, rai_g_text(scene))


def rai_g_text(scene: Scene) -> str:
    """The text of a scene's `.g` file.

    Raises:
        InputError: the engine has no shape for a part.
    """
    centre, size = scene.bounds.mean(axis=0), np.ptp(scene.bounds, axis=0)
    origin = np.array([*centre, -FLOOR_THICKNESS / 2])
    agent = scene.agent
    bodies = (*scene.walls, *scene.objects)
    names = dict(
        zip((body.name for body in bodies), safe_names([body.name for body in bodies], _RESERVED), strict=True)
    )
    edge = min(CYLINDER_EDGE, agent.radius / 4, agent.height / 4)
    floor_shape = f"shape:box, size:{_list([*size, FLOOR_THICKNESS])}, contact:1"
    agent_shape = f"shape:ssCylinder, size:{_list([agent.height, agent.radius, edge])}, contact:1"
    # Of the joint, so relative to its origin: both lower limits, then both upper ones.
    limits = _list((scene.bounds - agent.position).ravel())
    goal_shape = f"shape:box, size:{_list([*scene.goal.size, GOAL_HEIGHT])}, contact:0"
    goal_place = np.array([*(scene.goal.position - centre), 0.0])
    own = f"tolerance:{_number(scene.tolerance)}", f"preset:{scene.preset}" if scene.preset else ""
    lines = [
        f"# manipuzzle scene {scene.geometry_hash}; metres",
        "world { X:[0 0 0] }",
        _frame("floor", "world", _pose(origin), floor_shape, "logical:{ table }", *own),
        _frame("egoJoint", "world", _pose(np.array([*agent.position, agent.height / 2]))),
        _frame("ego", "egoJoint", agent_shape, f"joint:transXY, limits:{limits}", "logical:{ gripper }"),
        _frame(
            "goal", "floor", _pose(goal_place), goal_shape, "logical:{ table }", f"object:{names[scene.goal.object]}"
        ),
    ]
    taken = [*_RESERVED, *names.values()]
    for body in scene.walls:
        lines += _frames(body, names[body.name], origin, "", taken, scene.name)
    for body in scene.objects:
        lines += _frames(body, names[body.name], origin, "joint:rigid, logical:{ object }", taken, scene.name)
    return "\n".join(lines) + "\n"


def _frames(body: Body, name: str, origin: FloatArray, extra: str, taken: list[str], where: str) -> list[str]:
    """The frame of a body, with its only shape or above those of its parts; their names are added to `taken`."""
    shapes = [_shape(body, part, where) for part in body.parts]
    color = "" if body.color is None else f"color:{_list(body.color)}"
    pose = _pose(body.position - origin, body.yaw)
    if len(shapes) == 1 and shapes[0].is_centred:
        return [_frame(name, "floor", pose, shapes[0].attributes, color, extra)]
    parts = safe_names([f"{name}_{i}" for i in range(1, len(shapes) + 1)], taken)
    taken += parts
    return [
        _frame(name, "floor", pose, extra),
        *(
            _frame(part, name, _pose(np.array([*shape.offset, 0.0]), shape.yaw), shape.attributes, color)
            for part, shape in zip(parts, shapes, strict=True)
        ),
    ]


def _frame(name: str, parent: str, *attributes: str) -> str:
    return f"{name} ({parent}) {{ {', '.join(filter(None, attributes))} }}"


def _shape(body: Body, part: Part, where: str) -> _Shape:
    core, radius, height = part.core, part.edge_radius, body.height
    if len(core) == 1:
        size = [height, radius, min(CYLINDER_EDGE, radius / 4, height / 4)]
        return _Shape(f"shape:ssCylinder, size:{_list(size)}, contact:1", core[0], 0.0)
    if not height > 2 * (radius + SHARP):
        problem = f"height {height:g} m must exceed two edge radii of {radius:g} m, for rai rounds top and bottom too"
        raise InputError(where, f"{body.name}: {problem}")
    box = rectangle_of(core)
    if box is not None and box.size.min() > 2 * SHARP:
        outer = _list([*(box.size + 2 * radius), height] + ([radius] if radius else []))
        kind = "ssBox" if radius else "box"
        return _Shape(f"shape:{kind}, size:{outer}, contact:1", box.centre, box.yaw)
    sweep = radius or SHARP / 10
    half = height / 2 - radius
    points = [[*point, z] for z in (-half, half) for point in core]
    core_text = _list(np.concatenate(points).tolist())
    return _Shape(f"shape:ssCvx, core:{core_text}, size:[{_number(sweep)}], contact:1", np.zeros(2), 0.0)


def _pose(translation: FloatArray, yaw: float = 0.0) -> str:
    turn = [math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)] if yaw else []
    return f"Q:{_list([*denoised(translation), *turn])}"


def _list(values: Sequence[float] | FloatArray) -> str:
    return f"[{' '.join(map(_number, values))}]"


def _number(value: float) -> str:
    text = repr(short(value))
    return text.removesuffix(".0")
