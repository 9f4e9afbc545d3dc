"""The two geometry presets, and the transformation of a scene from one to the other.

`published` is the geometry of the authors' files [L]: the agent is exactly as wide as a cell, so corridors of one cell
leave no clearance, and the outer walls reach 5 cm into the border cells. `clear` leaves 12.5 mm on each side of a
one-cell corridor, which a real robot or a physics engine can drive.

[L] Levit, Ortiz-Haro, Toussaint: Solving Sequential Manipulation Puzzles by Finding Easier Subproblems, ICRA 2024.
"""

import contextlib
from dataclasses import dataclass, replace

import numpy as np

from converter.formats.body_document import MAX_LENGTH
from converter.scene import OUTER_WALL_PREFIX, Body, Scene
from converter.shape import Part, denoised
from pcg.errors import InputError

BLOCK_PREFIX = "block_"
"""Walls with this prefix stand for wall cells of a level."""

OUTER_WALL_SIDES = {"right": (1, -1), "back": (0, 1), "left": (1, 1), "front": (0, -1)}
"""Axis and direction in which each outer wall `outwall_*` lies, seen from the middle of the room."""

MIN_THICKNESS = 0.05
"""Thickness that an outer wall keeps when its inner face moves outward [m]."""


@dataclass(frozen=True)
class Preset:
    """Sizes that tell the geometries apart, all in metres.

    Attributes:
        name: Name in scene files and on the command line.
        agent_radius: Radius of the agent.
        tolerance: Penetration that still counts as touching.
        outer_wall_overhang: How far outer walls reach over the border of the room.
        outer_wall_edge_radius: Edge radius of outer walls, `outwall_*`.
        block_edge_radius: Edge radius of wall cells, `block_*`.
        wall_edge_radius: Edge radius of all other walls.
        object_edge_radius: Edge radius of movable objects.
    """

    name: str
    agent_radius: float
    tolerance: float
    outer_wall_overhang: float
    outer_wall_edge_radius: float
    block_edge_radius: float
    wall_edge_radius: float
    object_edge_radius: float

    def edge_radius_of_wall(self, name: str) -> float:
        """The edge radius of the wall called `name`."""
        if name.startswith(OUTER_WALL_PREFIX):
            return self.outer_wall_edge_radius
        return self.block_edge_radius if name.startswith(BLOCK_PREFIX) else self.wall_edge_radius


CLEAR = Preset(
    name="clear",
    agent_radius=0.1875,
    tolerance=1e-4,
    outer_wall_overhang=0.0,
    outer_wall_edge_radius=0.0,
    block_edge_radius=0.0,
    wall_edge_radius=0.0,
    object_edge_radius=0.0,
)
PUBLISHED = Preset(
    name="published",
    agent_radius=0.2,
    tolerance=1e-3,
    outer_wall_overhang=0.05,
    outer_wall_edge_radius=0.04,
    block_edge_radius=0.01,
    wall_edge_radius=0.02,
    object_edge_radius=0.02,
)
PRESETS = {preset.name: preset for preset in (CLEAR, PUBLISHED)}


def preset_named(name: str) -> Preset:
    """The preset called `name`.

    Raises:
        InputError: there is none; the message lists them.
    """
    if name not in PRESETS:
        raise InputError("preset", f"{name!r} is none of {', '.join(PRESETS)}")
    return PRESETS[name]


def with_preset(scene: Scene, name: str) -> Scene:
    """The scene in another geometry: agent radius, edge radii, inner faces of the outer walls, and tolerance.

    Straight edges of outlines stay where they are. Discs and capsules, and parts that are too thin for the edge radius
    of the preset, are left alone. A wall that stands for several cells is rounded as one: a conversion with the preset
    would leave notches between its blocks, into which the agent can sink by less than the tolerance. A scene without a
    preset is taken to have its outer walls at the border of the room.

    Raises:
        InputError: there is no such preset.
    """
    preset = preset_named(name)
    overhang = PRESETS[scene.preset].outer_wall_overhang if scene.preset in PRESETS else 0.0
    moved = (_with_inner_face_moved(wall, preset.outer_wall_overhang - overhang) for wall in scene.walls)
    return replace(
        scene,
        preset=preset.name,
        tolerance=preset.tolerance,
        agent=replace(scene.agent, radius=preset.agent_radius),
        walls=tuple(_with_edge_radius(wall, preset.edge_radius_of_wall(wall.name)) for wall in moved),
        objects=tuple(_with_edge_radius(body, preset.object_edge_radius) for body in scene.objects),
    )


def with_tolerance(scene: Scene, tolerance: float) -> Scene:
    """The scene with another tolerance [m]; its preset keeps its name.

    Raises:
        InputError: the tolerance is negative or larger than a file may hold.
    """
    if not 0 <= tolerance <= MAX_LENGTH:
        raise InputError("tolerance", f"{tolerance} m must be from 0 to {MAX_LENGTH:g}")
    return replace(scene, tolerance=tolerance)


def _with_edge_radius(body: Body, edge_radius: float) -> Body:
    return replace(body, parts=tuple(_rounded(part, edge_radius) for part in body.parts))


def _rounded(part: Part, edge_radius: float) -> Part:
    with contextlib.suppress(ValueError):
        return part.with_edge_radius(edge_radius)
    return part


def _with_inner_face_moved(wall: Body, inward: float) -> Body:
    """An outer wall whose inner face is moved into the room by `inward` [m], its outer face staying where it is.

    A wall that is moved comes back with sharp edges. Other walls, and outer walls that are no upright boxes along one
    side of the room, are returned as they are.
    """
    side = OUTER_WALL_SIDES.get(wall.name.removeprefix(OUTER_WALL_PREFIX))
    if not wall.name.startswith(OUTER_WALL_PREFIX) or side is None or inward == 0:
        return wall
    part = wall.parts[0]
    if len(wall.parts) > 1 or len(part.core) < 4 or part.box_size is None or wall.yaw != 0:
        return wall
    axis, direction = side
    size, position = np.array(part.box_size), wall.position.copy()
    inner_face = position[axis] - direction * (size[axis] / 2 + inward)
    size[axis] = max(size[axis] + inward, min(size[axis], MIN_THICKNESS))
    position[axis] = inner_face + direction * size[axis] / 2
    return replace(wall, position=denoised(position), parts=(Part.box(denoised(size)),))
