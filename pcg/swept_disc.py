"""Line of sight for a disc: can the robot drive straight to the goal crate?

`metrics.occluded` asks whether a ray between the two cell centres is blocked; here a disc as large as the robot sweeps
along it. A level with a free ray and a blocked disc shows the crate through a gap that is too narrow to drive through.
"""

import numpy as np

from pcg.arrays import BoolArray, IntArray
from pcg.grid import Cell
from pcg.level import Level
from pcg.metrics import occluded

UNIT = 32
"""Lengths are in parts of a cell, so that all of them are integers and the answer is exact."""

RADIUS = 15
"""Of the disc: 0.1875 m in cells of 0.4 m, as converted scenes have it, is 15/32 of a cell."""

_HALF_WALL, _HALF_CRATE = UNIT // 2, UNIT // 4
_CORNERS = np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])


def disc_occluded(level: Level, goal_crate: Cell, radius: int = RADIUS) -> bool:
    """Whether a disc that moves straight from player to goal crate meets the interior of a wall or of another crate.

    Crates are squares half a cell wide in the middle of their cells; to touch is no blocking.

    Args:
        level: With one player.
        goal_crate: Inner cell of the crate.
        radius: Of the disc, in 1/32 of a cell.

    Raises:
        ValueError: the level has not exactly one player, or `goal_crate` is no crate.
    """
    if occluded(level, goal_crate):
        return True
    others = level.is_crate.copy()
    others[goal_crate] = False
    return any(
        _is_close(level.player, goal_crate, mask, half_width, radius)
        for mask, half_width in ((level.is_wall, _HALF_WALL), (others, _HALF_CRATE))
    )


def _is_close(start: Cell, end: Cell, mask: BoolArray, half_width: int, radius: int) -> bool:
    """Whether a square of `mask` that the segment does not enter is closer to it than `radius`.

    The shortest way between the two begins at a corner of the square or at an end of the segment.
    """
    p, q = UNIT * np.array(start, dtype=np.int64), UNIT * np.array(end, dtype=np.int64)
    centres: IntArray = UNIT * np.argwhere(mask).astype(np.int64)
    along = q - p
    squared_length = along @ along
    offsets = (centres[:, np.newaxis] + half_width * _CORNERS).reshape(-1, 2) - p
    beside = (offsets @ along >= 0) & (offsets @ along <= squared_length)
    cross = offsets[:, 0] * along[1] - offsets[:, 1] * along[0]
    gaps = np.stack([np.maximum(np.abs(centres - point) - half_width, 0) for point in (p, q)])
    near_end = (gaps**2).sum(axis=2) < radius**2
    return bool((beside & (cross**2 < radius**2 * squared_length)).any() or near_end.any())
