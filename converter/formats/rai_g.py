"""Scenes from the `.g` files of the authors' engine `rai` [L]: which frame is what.

- `floor` bounds the room; the top of its box is z = 0.
- A frame with `joint:transXY` is the agent, one with `joint:rigid` a movable object; shapes below such a frame
  belong to it. Other shapes that collide (`contact` given and not 0) are walls.
- `goal` is the goal rectangle; it and its markers never collide. The goal-object is `obj`, or the only object.
- `ssBox size [x y z r]` has outer size x, y, z and edges rounded by r; `ssCylinder size [h r s]` has height h and
  radius r; `ssCvx core [x y z ...] size [r]` is a core swept by r, here an upright prism about its frame.
- Files that `converter.formats.rai_g_export` wrote say tolerance and preset at `floor`, the goal-object at `goal`.

[L] Levit, Ortiz-Haro, Toussaint: Solving Sequential Manipulation Puzzles by Finding Easier Subproblems, ICRA 2024.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from converter.formats.body_document import MAX_LENGTH
from converter.formats.rai_pose import IDENTITY, Pose, frame_pose
from converter.formats.rai_text import Frame, read_frames
from converter.preset import PRESETS, PUBLISHED
from converter.scene import Agent, Body, Goal, Scene
from converter.shape import FloatArray, Part, denoised, rotation
from pcg.errors import InputError

TOLERANCE = 1e-3
"""Collision tolerance of the authors' engine when the scenes were published [m]."""

SHARP = 1e-6
"""Radii below this are taken for none [m]: the engine wants the corners of `ssCvx` round."""

NEVER_COLLIDING = frozenset({"floor", "goal", "goal_visible", "goalLarge", "goalSmall", "sub-goal1"})
"""Names of frames that are never part of a wall, an object or the agent."""
_NO_SHAPE = frozenset({"none", "camera", "marker"})
_ALIGNED = 1e-9

MAX_POINTS = 2000
"""Points of a core: both ends of an upright prism."""


def _disc(radius: float) -> Part:
    return Part(np.zeros((1, 2)), radius)


def _swept(size: tuple[float, ...]) -> tuple[Part, float]:
    """The upright prism over a core swept by a sphere; `size` holds the radius and the core's coordinates."""
    points = np.reshape(size[1:], (-1, 3))
    radius, half = size[0] if size[0] >= SHARP else 0.0, points[:, 2].max()
    lower, upper = (points[np.abs(points[:, 2] - z) <= _ALIGNED, :2] for z in (-half, half))
    if len(lower) + len(upper) != len(points) or not _same_points(lower, upper):
        raise ValueError("the core must be an upright prism about the middle of its height")
    middle = lower.mean(axis=0)
    # Around the middle, counter-clockwise; two points have no order.
    order = np.argsort(np.arctan2(*(lower - middle).T[::-1])) if len(lower) > 2 else slice(None)
    return Part(lower[order], radius), float(denoised(2 * (half + radius)))


def _same_points(first: FloatArray, second: FloatArray) -> bool:
    gaps = np.hypot(*np.moveaxis(first[:, np.newaxis] - second, 2, 0))
    return bool(first.shape == second.shape and len(first) and (gaps.min(axis=0) <= _ALIGNED).all())


_SWEPT = "ssCvx"
_SHAPES: dict[str, tuple[int, Callable[[tuple[float, ...]], tuple[Part, float]]]] = {
    "ssBox": (4, lambda size: (Part.box(size[:2], size[3]), size[2])),
    "box": (3, lambda size: (Part.box(size[:2]), size[2])),
    "ssCylinder": (3, lambda size: (_disc(size[1]), size[0])),
    "cylinder": (2, lambda size: (_disc(size[1]), size[0])),
    _SWEPT: (1, _swept),
}
"""Of each shape the count of the numbers of its `size`, and how these become a footprint and a height."""


@dataclass(frozen=True, eq=False)
class _Placed:
    """Where a frame is in the file's world, and the nearest frame with a joint, itself or above it."""

    pose: Pose
    mover: Frame | None


@dataclass(frozen=True, eq=False)
class _Solid:
    """An upright shape in the scene's coordinates: footprint about the origin, and height [m]."""

    frame: Frame
    placed: _Placed
    part: Part
    height: float

    @property
    def bottom_top(self) -> tuple[float, float]:
        z = float(self.placed.pose.translation[2])
        return z - self.height / 2, z + self.height / 2


def read_rai_g(path: Path) -> Scene:
    """Reads a `.g` file, with the geometry preset `published`.

    Raises:
        InputError: naming file and line.
    """
    frames = read_frames(path)
    try:
        return _scene(_Tree(frames, str(path)), path)
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(str(path), str(error)) from None


def _scene(tree: "_Tree", path: Path) -> Scene:
    tree.stand_on("floor")
    solids = [tree.solid(frame) for frame in tree.frames.values() if tree.collides(frame)]
    by_joint: dict[str, list[_Solid]] = {"": [], "rigid": [], "transXY": []}
    for solid in solids:
        by_joint[_joint(solid.placed.mover)].append(solid)
    objects = _objects(by_joint["rigid"], tree)
    floor, goal = tree.frame("floor"), tree.frame("goal")
    return Scene(
        name=path.stem,
        bounds=_bounds(tree.solid(floor)),
        tolerance=_tolerance(floor),
        agent=_agent(by_joint["transXY"], str(path)),
        walls=tuple(_body(solid.frame, solid.placed.pose, [solid]) for solid in by_joint[""]),
        objects=objects,
        goal=_goal(tree.solid(goal), [body.name for body in objects]),
        preset=_preset(floor),
        source={"file": path.name, "format": "rai"},
    )


class _Tree:
    """The frames of a file and where they are."""

    def __init__(self, frames: dict[str, Frame], file: str) -> None:
        self.frames = frames
        self._file = file
        self._placed: dict[str, _Placed] = {}
        self._ground = np.zeros(3)

    def stand_on(self, name: str) -> None:
        """Makes the top of the frame's shape the height 0 of the scene."""
        top = self.solid(self.frame(name)).bottom_top[1]
        self._ground = np.array([0, 0, top])

    def frame(self, name: str) -> Frame:
        if name not in self.frames:
            raise InputError(self._file, f"no frame called {name!r}")
        return self.frames[name]

    def placed(self, frame: Frame) -> _Placed:
        """Pose in the scene's coordinates and mover of a frame."""
        chain: list[Frame] = []
        step: Frame | None = frame
        while step is not None and step.name not in self._placed:
            if len(chain) > len(self.frames):
                raise InputError(frame.where, f"{frame.name}: its parents form a circle")
            chain.append(step)
            step = self._parent(step)
        for step in reversed(chain):
            outer = self._placed[step.parent] if step.parent else _Placed(IDENTITY, None)
            mover = step if step.attributes.get("joint", "none") != "none" else outer.mover
            self._placed[step.name] = _Placed(outer.pose @ frame_pose(step), mover)
        found = self._placed[frame.name]
        translation = denoised(found.pose.translation - self._ground)
        if np.abs(translation).max() > MAX_LENGTH:
            raise InputError(frame.where, f"{frame.name}: farther than {MAX_LENGTH:g} m from the origin")
        return _Placed(Pose(translation, found.pose.yaw), found.mover)

    def _parent(self, frame: Frame) -> Frame | None:
        if frame.parent is None:
            return None
        if frame.parent not in self.frames:
            raise InputError(frame.where, f"{frame.name}: no frame called {frame.parent!r}, its parent")
        return self.frames[frame.parent]

    def collides(self, frame: Frame) -> bool:
        """Whether the frame has a shape that is part of a wall, an object or the agent."""
        if frame.name in NEVER_COLLIDING or _shape(frame) in _NO_SHAPE:
            return False
        has_joint = frame.attributes.get("joint", "none") != "none" and "size" in frame.attributes
        return has_joint or frame.attributes.get("contact", (0.0,)) not in ((0.0,), "false")

    def solid(self, frame: Frame) -> _Solid:
        """The shape of a frame."""
        shape = _shape(frame)
        if shape not in _SHAPES:
            where = frame.places.get("shape", frame.places.get("type", frame.where))
            raise InputError(where, f"{frame.name}: shape {shape!r}; allowed are {', '.join(_SHAPES)}")
        count, build = _SHAPES[shape]
        size = frame.numbers("size", (count,))
        if shape == _SWEPT:
            # The core belongs to the size; without it there is none.
            size = (*size, *_core(frame))
        try:
            part, height = build(size)
        except ValueError as error:
            raise InputError(frame.places["size"], f"{frame.name}: {error}") from None
        if height <= 0 or max(map(abs, size)) > MAX_LENGTH:
            raise InputError(frame.places["size"], f"{frame.name}: sizes must be positive, at most {MAX_LENGTH:g}")
        return _Solid(frame, self.placed(frame), part, height)


def _shape(frame: Frame) -> str:
    without = "" if "size" in frame.attributes else "none"
    shape = frame.attributes.get("shape", frame.attributes.get("type", without))
    return shape if isinstance(shape, str) else " ".join(f"{number:g}" for number in shape)


def _core(frame: Frame) -> tuple[float, ...]:
    """The coordinates of the points of a core."""
    core = frame.attributes.get("core")
    if core is None or isinstance(core, str) or len(core) < 3 or len(core) % 3 != 0:
        raise InputError(frame.places.get("core", frame.where), f"{frame.name}: core needs a list of points x y z")
    if len(core) > 3 * MAX_POINTS:
        raise InputError(frame.places["core"], f"{frame.name}: core has more than {MAX_POINTS} points")
    return core


def _tolerance(floor: Frame) -> float:
    if "tolerance" not in floor.attributes:
        return TOLERANCE
    (tolerance,) = floor.numbers("tolerance", (1,))
    if not 0 <= tolerance <= MAX_LENGTH:
        raise InputError(floor.places["tolerance"], f"floor: tolerance must be from 0 to {MAX_LENGTH:g} m")
    return tolerance


def _preset(floor: Frame) -> str | None:
    """The file's own preset; files without tolerance are taken for published ones."""
    preset = floor.attributes.get("preset", None if "tolerance" in floor.attributes else PUBLISHED.name)
    if preset is not None and preset not in PRESETS:
        raise InputError(floor.places["preset"], f"floor: preset must be one of {', '.join(PRESETS)}")
    return None if preset is None else str(preset)


def _joint(mover: Frame | None) -> str:
    if mover is None:
        return ""
    joint = mover.attributes["joint"]
    if joint not in ("rigid", "transXY"):
        raise InputError(mover.places["joint"], f"{mover.name}: joint {joint!r}; allowed are rigid and transXY")
    return str(joint)


def _bounds(floor: _Solid) -> FloatArray:
    return denoised(floor.placed.pose.translation[:2] + np.outer([-0.5, 0.5], _aligned_size(floor)))


def _agent(solids: Sequence[_Solid], file: str) -> Agent:
    if len(solids) != 1:
        raise InputError(file, f"one shape below a frame with joint:transXY wanted (the agent), found {len(solids)}")
    (solid,) = solids
    if len(solid.part.core) > 1:
        raise InputError(solid.frame.where, f"{solid.frame.name}: the agent must be an upright cylinder")
    # The agent is taken to reach down to the floor.
    height = float(denoised(solid.bottom_top[1]))
    if height <= 0:
        raise InputError(solid.frame.where, f"{solid.frame.name}: the agent is below the floor")
    return Agent(solid.placed.pose.translation[:2], solid.part.edge_radius, height)


def _objects(solids: Sequence[_Solid], tree: _Tree) -> tuple[Body, ...]:
    by_mover: dict[str, list[_Solid]] = {}
    for solid in solids:
        if solid.placed.mover is not None:
            by_mover.setdefault(solid.placed.mover.name, []).append(solid)
    return tuple(_body(tree.frame(name), tree.placed(tree.frame(name)).pose, parts) for name, parts in by_mover.items())


def _body(frame: Frame, pose: Pose, solids: Sequence[_Solid]) -> Body:
    first = solids[0]
    for solid in solids:
        if not np.allclose(solid.bottom_top, first.bottom_top, rtol=0, atol=_ALIGNED):
            raise InputError(solid.frame.where, f"{solid.frame.name}: the parts of {frame.name} differ in height or z")
    position = np.array([*pose.translation[:2], first.placed.pose.translation[2]])
    parts = tuple(_moved(solid.part, solid.placed.pose.relative_to(pose)) for solid in solids)
    return Body(frame.name, position, first.height, parts, pose.yaw, _color(first.frame))


def _moved(part: Part, pose: Pose) -> Part:
    if pose.yaw == 0 and not pose.translation[:2].any():
        return part
    return Part(denoised(part.core @ rotation(pose.yaw) + pose.translation[:2]), part.edge_radius)


def _color(frame: Frame) -> tuple[float, float, float] | None:
    color = frame.attributes.get("color")
    if color is None or isinstance(color, str) or len(color) not in (3, 4):
        return None
    red, green, blue = (min(max(share, 0.0), 1.0) for share in color[:3])
    return red, green, blue


def _goal(solid: _Solid, objects: Sequence[str]) -> Goal:
    default = "obj" if "obj" in objects or len(objects) != 1 else objects[0]
    name = str(solid.frame.attributes.get("object", default))
    if name not in objects and "object" in solid.frame.attributes:
        where = solid.frame.places["object"]
        raise InputError(
            where, f"{solid.frame.name}: object {name[:60]!r} is none of the objects ({', '.join(objects)})"
        )
    if name not in objects:
        raise InputError(
            solid.frame.where,
            f"{solid.frame.name}: no goal-object: none of the objects ({', '.join(objects)}) is called obj",
        )
    return Goal(name, solid.placed.pose.translation[:2], _aligned_size(solid))


def _aligned_size(solid: _Solid) -> FloatArray:
    """Outer size (2,) [m] of a box that must be aligned with the axes."""
    size = solid.part.box_size
    if size is None or abs(solid.placed.pose.yaw) > _ALIGNED:
        raise InputError(solid.frame.where, f"{solid.frame.name}: must be a box that is aligned with the axes")
    return denoised(size)
