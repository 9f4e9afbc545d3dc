"""Measures of a level: what it holds, and whether the player sees the goal crate."""

from dataclasses import dataclass

import numpy as np

from pcg.arrays import BoolArray
from pcg.grid import Cell, count_regions
from pcg.level import Level


@dataclass(frozen=True)
class LevelStatistics:
    """What a level holds.

    Attributes:
        rows: Inner rows.
        columns: Inner columns.
        players: Players, on targets or not.
        crates: Crates, on targets or not.
        targets: Targets, covered or not.
        walls: Inner wall cells, without the outer wall.
        regions: Four-connected regions of cells without wall; players and crates do not divide them.
        wall_density: Walls by inner cells, 0 to 1.
    """

    rows: int
    columns: int
    players: int
    crates: int
    targets: int
    walls: int
    regions: int
    wall_density: float


def statistics(level: Level) -> LevelStatistics:
    """Counts what `level` holds."""
    rows, columns = level.shape
    walls = int(level.is_wall.sum())
    return LevelStatistics(
        rows=rows,
        columns=columns,
        players=int(level.is_player.sum()),
        crates=int(level.is_crate.sum()),
        targets=int(level.is_target.sum()),
        walls=walls,
        regions=count_regions(~level.is_wall),
        wall_density=walls / level.tiles.size,
    )


def occluded(level: Level, goal_crate: Cell) -> bool:
    """Whether a wall or another crate hides the goal crate from the player.

    The ray joins the cell centres of player and goal crate. It is blocked where it meets the interior of a wall cell,
    or of another crate: a square half a cell wide in the middle of its cell. To touch a corner or an edge is no
    blocking. All in integers, so the answer is exact.

    Raises:
        ValueError: the level has not exactly one player, or `goal_crate` is no crate.
    """
    if goal_crate not in level.crates:
        raise ValueError(f"goal crate {goal_crate} is not a crate; there are {level.crates}")
    player = level.player
    others = level.is_crate.copy()
    others[goal_crate] = False
    return _meets(player, goal_crate, level.is_wall, half_width=2) or _meets(player, goal_crate, others, half_width=1)


def _meets(start: Cell, end: Cell, mask: BoolArray, half_width: int) -> bool:
    """Whether the segment meets the interior of a square around the centre of a cell of `mask`.

    A segment and an open square are apart if and only if one of three axes separates them: the two of the grid and
    the normal of the segment. Lengths are in quarters of a cell, so that all of them are integers.
    """
    p, q = 4 * np.array(start, dtype=np.int64), 4 * np.array(end, dtype=np.int64)
    centres = 4 * np.argwhere(mask).astype(np.int64)
    apart: BoolArray = np.zeros(len(centres), dtype=np.bool_)
    for axis in (0, 1):
        low, high = min(p[axis], q[axis]), max(p[axis], q[axis])
        apart |= (centres[:, axis] - half_width >= high) | (centres[:, axis] + half_width <= low)
    normal = np.array([q[1] - p[1], p[0] - q[0]])
    apart |= np.abs((centres - p) @ normal) >= half_width * np.abs(normal).sum()
    return not apart.all()
