import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from converter.formats.rai_pose import IDENTITY, Pose, frame_pose
from converter.formats.rai_text import read_frames
from pcg.errors import InputError

COORDINATES = st.floats(-5, 5)
POSES = st.builds(
    lambda x, y, z, yaw: Pose(np.array([x, y, z]), yaw), COORDINATES, COORDINATES, COORDINATES, st.floats(-3, 3)
)


def pose(folder: Path, attribute: str) -> Pose:
    """The pose of a frame with this attribute."""
    path = folder / "scene.g"
    path.write_text(f"a (world) {{ {attribute} }}")
    return frame_pose(read_frames(path)["a"])


@pytest.mark.parametrize(
    ("attribute", "translation", "yaw"),
    [
        ("", (0, 0, 0), 0),
        ("Q:[1 2 3]", (1, 2, 3), 0),
        ("Q:[1, 2, 3, -1, 0, 0, 0]", (1, 2, 3), 0),
        ("Q:[0 0 20 6.12323e-17 0 0 1]", (0, 0, 20), math.pi),
        ("Q:[0 0 0 0.707107 0 0 0.707107]", (0, 0, 0), math.pi / 2),
        ("Q:[0 0 0 2 0 0 -2]", (0, 0, 0), -math.pi / 2),
        ("Q:<t(1 2 .3)>", (1, 2, 0.3), 0),
        ("Q:<T t(1, 2, .3) d(90 0 0 1)>", (1, 2, 0.3), math.pi / 2),
        ("Q:'d(90 0 0 2) t(1 0 0)'", (0, 1, 0), math.pi / 2),
        ("Q:<r(1 0 0 -1)>", (0, 0, 0), -1),
        ("Q:<d(360 1 0 0) t(0 0 1)>", (0, 0, 1), 0),
        ("Q:<q(1 0 0 0)>", (0, 0, 0), 0),
    ],
)
def test_every_spelling_of_a_pose(tmp_path: Path, attribute: str, translation: tuple[float, ...], yaw: float):
    """Numbers, quaternions of either sign and length, and products of factors."""
    made = pose(tmp_path, attribute)
    np.testing.assert_allclose(made.translation, translation, atol=1e-6)
    assert abs(math.remainder(made.yaw - yaw, 2 * math.pi)) < 1e-6


@pytest.mark.parametrize(
    ("attribute", "problem"),
    [
        ("Q:[0 0 0 0.7 0.7 0 0]", "a: the rotation tilts the frame"),
        ("Q:[0 0 0 0 1 0 0]", "a: the rotation tilts the frame"),
        ("Q:<d(90 1 0 0)>", "a: the rotation tilts the frame"),
        ("Q:<d(90 0 0 0)>", "a: the axis of a rotation must not be zero"),
        ("Q:[0 0 0 0 0 0 0]", "a: the quaternion must not be zero"),
        ("Q:[1 2]", "a: Q needs 3 or 7 numbers"),
        ("Q:<t(1 2)>", "a: pose <t(1 2)>: t(1 2) has no 3 numbers"),
        ("Q:<t(1 2 x)>", "a: pose <t(1 2 x)>: t(1 2 x) has no 3 numbers"),
        ("Q:<t(1 2 inf)>", "a: pose <t(1 2 inf)>: t(1 2 inf) has no 3 numbers"),
        ("Q:<s(1 2 3)>", "a: pose <s(1 2 3)>: factors t(x y z)"),
        ("X:[0 0 0]", "a: X is only read in a frame without parent"),
    ],
)
def test_a_pose_that_cannot_be_used_is_refused(tmp_path: Path, attribute: str, problem: str):
    """The message names the line."""
    with pytest.raises(InputError, match=re.escape(f"line 1: {problem}")):
        pose(tmp_path, attribute)


@given(POSES, POSES, POSES)
def test_poses_are_a_group(a: Pose, b: Pose, c: Pose):
    """Composition is associative, has a neutral element, and `relative_to` inverts it."""
    for left, right in (((a @ b) @ c, a @ (b @ c)), (a @ IDENTITY, a), ((a @ b).relative_to(a), b)):
        np.testing.assert_allclose(left.translation, right.translation, atol=1e-9)
        assert abs(math.remainder(left.yaw - right.yaw, 2 * math.pi)) < 1e-9
