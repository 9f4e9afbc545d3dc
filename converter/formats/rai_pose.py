"""Poses of `.g` frames, as far as an upright world needs them: a translation and a rotation about z.

A pose is written as 3 numbers (x y z), as 7 (x y z and a quaternion w x y z), or as a product of factors such as
`t(x y z) d(90 0 0 1)`: `t` translates, `q` is a quaternion, `d` and `r` turn by degrees or radians about an axis.
"""

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from converter.formats.rai_text import Frame
from converter.shape import FloatArray, rotation
from pcg.errors import InputError

_UPRIGHT = 1e-6
"""Largest tilt that counts as none; files hold six digits."""

MAX_FACTORS = 100
"""Factors of a pose."""

_FACTOR = re.compile(r"\s*(?:T\b)?\s*([tqdr])\s*\(([^()]*)\)\s*")


@dataclass(frozen=True, eq=False)
class Pose:
    """A translation (3,) [m] after a rotation about z by `yaw` [rad]."""

    translation: FloatArray
    yaw: float = 0.0

    def __matmul__(self, inner: Self) -> Self:
        """The pose of a frame that has pose `inner` in a frame of this pose."""
        x, y, z = inner.translation
        turned = np.array([x, y]) @ rotation(self.yaw)
        yaw = math.remainder(self.yaw + inner.yaw, 2 * math.pi)
        return type(self)(self.translation + np.array([*turned, z]), yaw)

    def relative_to(self, outer: Self) -> Self:
        """This pose as seen from a frame of pose `outer`."""
        x, y, z = self.translation - outer.translation
        turned = np.array([x, y]) @ rotation(-outer.yaw)
        return type(self)(np.array([*turned, z]), math.remainder(self.yaw - outer.yaw, 2 * math.pi))


IDENTITY = Pose(np.zeros(3))


def frame_pose(frame: Frame) -> Pose:
    """The pose of a frame relative to its parent; `X` is that of a root, `Q` that of any other frame.

    Raises:
        InputError: the pose cannot be read, or tilts the frame; with file and line.
    """
    key = "Q" if "Q" in frame.attributes else "X"
    if key not in frame.attributes:
        return IDENTITY
    if key == "X" and frame.parent is not None:
        raise InputError(frame.places[key], f"{frame.name}: X is only read in a frame without parent; use Q")
    value, where = frame.attributes[key], f"{frame.places[key]}: {frame.name}"
    if isinstance(value, str):
        return _product(value, where)
    numbers = frame.numbers(key, (3, 7))
    return Pose(np.array(numbers[:3]), _quaternion_yaw(numbers[3:], where) if len(numbers) == 7 else 0.0)


def _product(text: str, where: str) -> Pose:
    # Single blanks: several in a row could be matched in many ways.
    text = " ".join(text.split())
    if text.count("(") > MAX_FACTORS:
        raise InputError(where, f"pose <{text[:60]}…>: more than {MAX_FACTORS} factors")
    pose, end = IDENTITY, 0
    while end < len(text):
        match = _FACTOR.match(text, end)
        if match is None:
            raise InputError(where, f"pose <{text[:60]}>: factors t(x y z), q(w x y z), d(angle x y z), r(angle x y z)")
        kind, end = match.group(1), match.end()
        try:
            numbers = [float(number) for number in re.split(r"[\s,]+", match.group(2).strip())]
        except ValueError:
            numbers = []
        if len(numbers) != (3 if kind == "t" else 4) or not all(map(math.isfinite, numbers)):
            raise InputError(
                where, f"pose <{text[:60]}>: {kind}({match.group(2)[:40]}) has no {3 + (kind != 't')} numbers"
            )
        factor = Pose(np.array(numbers)) if kind == "t" else Pose(np.zeros(3), _YAW[kind](numbers, where))
        pose = pose @ factor
    return pose


def _quaternion_yaw(numbers: Sequence[float], where: str) -> float:
    norm = math.hypot(*numbers)
    if norm < _UPRIGHT:
        raise InputError(where, "the quaternion must not be zero")
    w, x, y, z = (number / norm for number in numbers)
    if max(abs(x), abs(y)) > _UPRIGHT:
        raise InputError(where, "the rotation tilts the frame; only rotations about z are allowed")
    yaw = math.remainder(2 * math.atan2(z, w), 2 * math.pi)
    return 0.0 if abs(yaw) < 1e-12 else yaw


def _angle_axis_yaw(numbers: Sequence[float], unit: float, where: str) -> float:
    angle, axis = numbers[0] * unit, numbers[1:]
    length = math.hypot(*axis)
    if length < _UPRIGHT:
        raise InputError(where, "the axis of a rotation must not be zero")
    s = math.sin(angle / 2) / length
    return _quaternion_yaw([math.cos(angle / 2), *(s * component for component in axis)], where)


_YAW: dict[str, Callable[[Sequence[float], str], float]] = {
    "q": _quaternion_yaw,
    "d": lambda numbers, where: _angle_axis_yaw(numbers, math.pi / 180, where),
    "r": lambda numbers, where: _angle_axis_yaw(numbers, 1.0, where),
}
