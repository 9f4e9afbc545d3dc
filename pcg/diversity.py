"""How different levels are from each other."""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pcg.arrays import FloatArray
from pcg.grid import Cell
from pcg.level import Level
from pcg.solver import goal_crate_of, solve
from pcg.symmetry import images

SYMMETRIES = 8


def mean_hamming_distance(levels: Sequence[Level]) -> float | None:
    """Mean share of cells in which two levels differ, over all pairs; None for fewer than two levels.

    Args:
        levels: Of one shape.
    """
    n = len(levels)
    if n < 2:
        return None
    tiles = np.stack([level.tiles for level in levels]).reshape(n, -1)
    # Of the pairs, those that agree in a cell: counted tile by tile rather than pair by pair.
    equal = sum(((tiles == tile).sum(axis=0) * ((tiles == tile).sum(axis=0) - 1)).sum() for tile in np.unique(tiles))
    return 1.0 - float(equal) / (n * (n - 1) * tiles.shape[1])


def goal_cell_entropy(levels: Sequence[Level]) -> float | None:
    """Shannon entropy of the goal crates' cells in bits; None without levels.

    All in one cell is 0; uniform over 100 cells 6.64, which n levels can reach only to log2(n).
    """
    counts = Counter(level.goal_crate for level in levels)
    n = counts.total()
    return math.fsum(-k / n * math.log2(k / n) for k in counts.values()) if n else None


@dataclass(frozen=True)
class Descriptors:
    """What `distances_to` compares of n levels, for each of the eight symmetries.

    Attributes:
        walls: (8, n, cells) 1 where a wall is.
        places: (8, n, 3, 2) rows and columns of player, goal crate and first target.
        span: Largest distance of two cells by rows and columns.
    """

    walls: FloatArray
    places: FloatArray
    span: float

    @classmethod
    def of(cls, levels: Sequence[Level]) -> "Descriptors":
        """Of levels that are square, of one shape, and playable."""
        walls = np.stack([images(level.is_wall.astype(np.float64)) for level in levels], axis=1)
        marks = [_marked(level, cell) for level in levels for cell in _places(level)]
        places = np.stack([np.argwhere(images(mark))[:, 1:] for mark in marks], axis=1).astype(np.float64)
        n, side = len(levels), levels[0].shape[0]
        return cls(walls.reshape(SYMMETRIES, n, -1), places.reshape(SYMMETRIES, n, 3, 2), 2.0 * (side - 1))

    def distances_to(self, index: int) -> FloatArray:
        """(n,) distance of every level to level `index`, at least 0 and at most 1, the same for symmetric levels.

        One half is the Jaccard distance of the walls, the other the mean distance of player, goal crate and target by
        rows and columns as a share of the largest one; of the eight symmetries the nearest counts. The Jaccard distance
        does not grow with the number of walls, as the Hamming distance would.
        """
        walls, places = self.walls[0, index], self.places[0, index]
        common = self.walls @ walls
        either = self.walls.sum(axis=2) + walls.sum() - common
        jaccard = 1.0 - np.divide(common, either, out=np.ones_like(common), where=either > 0)
        moved = np.abs(self.places - places).sum(axis=3).mean(axis=2) / max(self.span, 1.0)
        return np.asarray((jaccard + moved).min(axis=0) / 2.0, dtype=np.float64)


def _places(level: Level) -> list[Cell]:
    goal = level.goal_crate
    goal = goal_crate_of(level, solve(level)) if goal is None else goal
    return [level.player, goal, level.targets[0]]


def _marked(level: Level, cell: Cell) -> FloatArray:
    mark = np.zeros(level.shape)
    mark[cell] = 1.0
    return mark
