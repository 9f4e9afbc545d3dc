"""Scenes as MuJoCo models (MJCF).

- The agent is a cylinder on two slide joints, whose positions are its displacement from the start [m], so that a
  model that is loaded and stepped stays as it is. For each axis there is a position servo and a velocity servo, which
  together follow a trajectory without lag.
- Objects are free bodies, each with a weld to the agent that is off until a program grasps with it; or mocap bodies,
  which go where a program puts them. Walls are fixed bodies, the goal is a flat site on the floor.
- Sharp boxes are box geoms, discs are cylinders; every other part is a convex mesh whose outline is at most
  `converter.outline.MAX_ERROR` inside the part's.
- The agent touches without friction and does not touch the floor, on which it has no weight to put.

Lengths in metres, angles in radians. The same scene gives the same text, byte for byte.
"""

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path

import numpy as np

from converter.formats.body_document import short
from converter.formats.safe_names import safe_names
from converter.outline import outline_polygon, rectangle_of
from converter.render_scene import object_color
from converter.scene import AGENT, Body, Scene
from converter.shape import FloatArray, Part, denoised
from converter.theme import PAPER, Color
from pcg.files import write_text

FLOOR = "floor"
GOAL = "goal"
AGENT_JOINTS = f"{AGENT}_x", f"{AGENT}_y"
"""The agent's joints; a free joint is called after its object."""

GRASP_PREFIX = "grasp_"
"""The weld between agent and object is called after the object's body, behind this prefix."""

TIME_STEP = 0.001
"""[s]."""

AGENT_MASS = 10.0
"""[kg]; heavier than what it carries, so that one pair of servo gains serves both."""

SERVO_FREQUENCY = 100.0
"""Natural frequency of the agent's critically damped servos [rad/s]."""

OBJECT_DENSITY = 125.0
"""[kg/m^3]: a cube of 0.2 m weighs 1 kg."""

_SITE_HEIGHT = 1e-3
_FIELD_OF_VIEW = 45.0
"""Of the camera [degrees], which MJCF wants whatever its unit of angles is."""


class Movable(StrEnum):
    """What objects are in the engine."""

    FREE = "free"
    """Bodies with six degrees of freedom, which obey physics."""
    MOCAP = "mocap"
    """Bodies that a program places."""


@dataclass(frozen=True)
class BodyNames:
    """What walls and objects are called in the model, in the order of the scene."""

    walls: tuple[str, ...]
    objects: tuple[str, ...]


def body_names(scene: Scene) -> BodyNames:
    """The names of a scene's bodies in its MuJoCo model."""
    reserved = ("world", AGENT, FLOOR, GOAL, *AGENT_JOINTS)
    names = safe_names([body.name for body in (*scene.walls, *scene.objects)], reserved)
    return BodyNames(tuple(names[: len(scene.walls)]), tuple(names[len(scene.walls) :]))


def write_mjcf(path: Path, scene: Scene, movable: Movable = Movable.FREE) -> None:
    """Writes a scene as a MuJoCo model.

    Raises:
        InputError: the path cannot be written.
    """
    write_text(path, mjcf_text(scene, movable))


def mjcf_text(scene: Scene, movable: Movable = Movable.FREE) -> str:
    """The XML text of a scene's MuJoCo model."""
    names = body_names(scene)
    (model_name,) = safe_names([scene.name])
    root = ET.Element("mujoco", model=model_name)
    root.append(ET.Comment(f" manipuzzle scene {scene.geometry_hash}; metres, radians "))
    _add(root, "compiler", angle="radian", autolimits="true")
    option = _add(
        root, "option", timestep=_number(TIME_STEP), integrator="implicitfast", cone="elliptic", impratio="10"
    )
    # With several contact points a pair, MuJoCo 4.0 reports cylinders up to half a millimetre too deep.
    _add(option, "flag", multiccd="disable")
    # Together with the directional light no more than white, so that colours keep their look.
    dim = {"ambient": "0.35 0.35 0.35", "diffuse": "0.35 0.35 0.35", "specular": "0 0 0"}
    _add(_add(root, "visual"), "headlight", dim)
    _add_defaults(root)
    meshes = _Meshes(_add(root, "asset"))
    world = _add(root, "worldbody")
    _add_room(world, scene)
    for name, wall in zip(names.walls, scene.walls, strict=True):
        _add_geoms(_add_body(world, name, wall), wall, "wall", _color(wall.color or PAPER.wall), meshes)
    for name, body in zip(names.objects, scene.objects, strict=True):
        element = _add_body(world, name, body, **({"mocap": "true"} if movable is Movable.MOCAP else {}))
        if movable is Movable.FREE:
            _add(element, "freejoint", name=name)
        _add_geoms(element, body, "object", _color(object_color(scene, body, PAPER)), meshes)
    _add_agent(root, world, scene)
    if movable is Movable.FREE:
        _add_grasps(root, names.objects)
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


def _add_defaults(root: ET.Element) -> None:
    default = _add(root, "default")
    _add(_add(default, "default", {"class": "wall"}), "geom", density="1000")
    _add(_add(default, "default", {"class": "object"}), "geom", density=_number(OBJECT_DENSITY))
    agent = _add(default, "default", {"class": AGENT})
    _add(agent, "geom", type="cylinder", mass=_number(AGENT_MASS), condim="1", priority="1")
    _add(agent, "joint", type="slide")


def _add_room(world: ET.Element, scene: Scene) -> None:
    centre, half = scene.bounds.mean(axis=0), np.ptp(scene.bounds, axis=0) / 2
    middle = _numbers([*centre, 0.0])
    distance = 1.1 * half.max() / math.tan(math.radians(_FIELD_OF_VIEW / 2))
    above = _numbers([*centre, distance])
    _add(world, "light", type="directional", pos=above, dir="0.3 -0.5 -1", diffuse="0.3 0.3 0.3")
    _add(world, "camera", name="top", pos=above, fovy=_number(_FIELD_OF_VIEW))
    _add(world, "geom", name=FLOOR, type="plane", pos=middle, size=_numbers([*half, 0.1]), rgba=_color(PAPER.floor))
    place, size = scene.goal.position, scene.goal.size
    extent = _numbers([*(size / 2), _SITE_HEIGHT / 2])
    _add(world, "site", name=GOAL, type="box", pos=_numbers([*place, 0.0]), size=extent, rgba=_color(PAPER.goal))


def _add_body(world: ET.Element, name: str, body: Body, **attributes: str) -> ET.Element:
    return _add(world, "body", {"name": name, "pos": _numbers(body.position), **_turned(body.yaw)}, **attributes)


def _add_geoms(element: ET.Element, body: Body, class_: str, rgba: str, meshes: "_Meshes") -> None:
    for part in body.parts:
        _add(element, "geom", {"class": class_, **_geom(part, body.height, meshes)}, rgba=rgba)


def _geom(part: Part, height: float, meshes: "_Meshes") -> dict[str, str]:
    """Type, size and place of the geom of a part, in the frame of its body."""
    if len(part.core) == 1:
        return {"type": "cylinder", "size": _numbers([part.edge_radius, height / 2]), **_moved(part.core[0])}
    box = rectangle_of(part.core) if part.edge_radius == 0 else None
    if box is not None:
        size = _numbers([*(box.size / 2), height / 2])
        return {"type": "box", "size": size, **_moved(box.centre), **_turned(box.yaw)}
    return {"type": "mesh", "mesh": meshes.name_of(part, height)}


def _moved(offset: FloatArray) -> dict[str, str]:
    return {"pos": _numbers([*offset, 0.0])} if offset.any() else {}


def _turned(yaw: float) -> dict[str, str]:
    return {"euler": _numbers([0.0, 0.0, yaw])} if yaw else {}


@dataclass
class _Meshes:
    """The mesh assets of a model: one for all parts of the same shape."""

    asset: ET.Element
    names: dict[tuple[bytes, float, float], str] = field(default_factory=dict)

    def name_of(self, part: Part, height: float) -> str:
        """The name of the prism over a part, about the middle of its height."""
        shape = part.core.round(9).tobytes(), part.edge_radius, height
        if shape not in self.names:
            outline = outline_polygon(part)
            levels = [np.column_stack([outline, np.full(len(outline), z)]) for z in (-height / 2, height / 2)]
            self.names[shape] = f"prism_{len(self.names) + 1}"
            # MuJoCo keeps vertices in single precision: nanometres are more than it can tell apart.
            vertices = _numbers(np.concatenate(levels).ravel().round(9).tolist())
            _add(self.asset, "mesh", name=self.names[shape], vertex=vertices)
        return self.names[shape]


def _add_agent(root: ET.Element, world: ET.Element, scene: Scene) -> None:
    agent = scene.agent
    body = _add(world, "body", name=AGENT, pos=_numbers([*agent.position, agent.height / 2]), childclass=AGENT)
    size = _numbers([agent.radius, agent.height / 2])
    _add(body, "geom", name=AGENT, size=size, rgba=_color(PAPER.agent))
    limits = scene.bounds.T - agent.position[:, None]
    for joint, axis, ends in zip(AGENT_JOINTS, ("1 0 0", "0 1 0"), limits, strict=True):
        _add(body, "joint", name=joint, axis=axis, range=_numbers(denoised(ends)))
    actuator = _add(root, "actuator")
    stiffness, damping = AGENT_MASS * SERVO_FREQUENCY**2, 2 * AGENT_MASS * SERVO_FREQUENCY
    for kind, gain in (("position", {"kp": _number(stiffness)}), ("velocity", {"kv": _number(damping)})):
        for axis, joint in zip("xy", AGENT_JOINTS, strict=True):
            _add(actuator, kind, gain, name=f"{AGENT}_{kind}_{axis}", joint=joint)
    _add(_add(root, "contact"), "exclude", name=f"{AGENT}_{FLOOR}", body1="world", body2=AGENT)


def _add_grasps(root: ET.Element, objects: Sequence[str]) -> None:
    equality = _add(root, "equality")
    stiff = {"solref": "0.005 1", "solimp": "0.99 0.999 0.0001"}
    for name in objects:
        _add(equality, "weld", stiff, name=GRASP_PREFIX + name, body1=AGENT, body2=name, active="false")


def _add(parent: ET.Element, tag: str, group: Mapping[str, str] | None = None, **attributes: str) -> ET.Element:
    return ET.SubElement(parent, tag, {**(group or {}), **attributes})


def _color(color: Color) -> str:
    return _numbers([*color, 1.0])


def _numbers(values: Iterable[float]) -> str:
    return " ".join(map(_number, values))


def _number(value: float) -> str:
    return f"{short(value):.12g}"
