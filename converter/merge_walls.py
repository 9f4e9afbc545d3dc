"""Walls of a grid as the fewest boxes: a partition of wall cells into as few rectangles as possible.

The classic argument (Ohtsuki 1982; Ferrari, Sankar and Sklansky 1984): every inner corner of the walls has to be
resolved by a cut along one of its two edges. A cut that joins two inner corners, a *chord*, resolves both at once, so
the fewest rectangles come from the most chords that do not meet, not even at their ends. Horizontal chords meet only
vertical ones, so these are a largest independent set of a bipartite graph, which a largest matching yields (König).
Every other inner corner gets a cut of its own, to the next edge or cut.

Rectangles of grid cells are exactly what their cells are, so walls with sharp edges may become larger boxes. Blocks
with rounded edges may not: between two of them the outline has a notch down to where the arcs begin, and a line from
the arc of one block to an arc of another on the same side runs outside, so no convex part can reach round two corners
on one side, and no union of fewer parts equals that of the blocks. Such blocks become one body of several parts.

Cells are (row, column). The lattice point (i, j) is the lower right corner of cell (i, j) of the grid with a border.
"""

from collections import defaultdict
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from pcg.arrays import BoolArray
from pcg.grid import Cell

Point = tuple[int, int]


@dataclass(frozen=True, order=True)
class Rectangle:
    """Cells of a grid from (`top`, `left`) to (`bottom`, `right`), both included."""

    top: int
    left: int
    bottom: int
    right: int

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.bottom - self.top + 1, self.right - self.left + 1

    @property
    def cells(self) -> list[Cell]:
        """All cells in reading order."""
        rows, columns = range(self.top, self.bottom + 1), range(self.left, self.right + 1)
        return [(row, column) for row in rows for column in columns]

    def pieces(self, most: int) -> list["Rectangle"]:
        """The rectangle in pieces of at most `most` cells each, `most` >= 1."""
        columns = min(self.shape[1], most)
        rows = max(1, most // columns)
        return [
            Rectangle(top, left, min(top + rows - 1, self.bottom), min(left + columns - 1, self.right))
            for top in range(self.top, self.bottom + 1, rows)
            for left in range(self.left, self.right + 1, columns)
        ]


def merged(is_wall: BoolArray) -> list[Rectangle]:
    """The fewest disjoint rectangles whose cells are those of the (rows, columns) mask, in reading order."""
    cuts = _Cuts(is_wall)
    corners = _inner_corners(cuts.walls)
    horizontal, vertical = _chords(cuts, corners)
    resolved: set[Point] = set()
    for chord in _most_apart(horizontal, vertical):
        cuts.along(chord)
        resolved |= {chord[0], chord[-1]}
    for corner, direction in corners.items():
        if corner not in resolved:
            cuts.along(cuts.until_the_next(corner, direction))
    return cuts.rectangles()


class _Cuts:
    """A grid of walls with cuts between its cells.

    Attributes:
        walls: (rows + 2, columns + 2) mask: the cells with a border of free ones.
        above: Whether there is a cut or an edge of the walls between a cell and that above it; `left` likewise.
    """

    def __init__(self, is_wall: BoolArray) -> None:
        self.walls = np.pad(np.asarray(is_wall, dtype=np.bool_), 1)
        self.above = ~(self.walls & np.roll(self.walls, 1, axis=0))
        self.left = ~(self.walls & np.roll(self.walls, 1, axis=1))

    def inside(self, point: Point, step: int, axis: int) -> bool:
        """Whether the unit of the lattice from `point` by `step` along `axis` runs inside walls, with no cut on it."""
        i, j = point
        if axis == 1:
            return not self.above[i + 1, j + 1 if step > 0 else j]
        return not self.left[i + 1 if step > 0 else i, j + 1]

    def until_the_next(self, corner: Point, step: int) -> list[Point]:
        """Lattice points from `corner` along its row by `step` until an edge or a cut is met."""
        points = [corner]
        while self.inside(points[-1], step, 1):
            i, j = points[-1]
            points.append((i, j + step))
            if not (self.inside(points[-1], 1, 0) and self.inside(points[-1], -1, 0)):
                break
        return points

    def along(self, points: list[Point]) -> None:
        """Adds a cut through consecutive lattice points."""
        for (i, j), (k, m) in pairwise(points):
            if i == k:
                self.above[i + 1, max(j, m)] = True
            else:
                self.left[max(i, k), j + 1] = True

    def rectangles(self) -> list[Rectangle]:
        """What the cuts leave, in reading order: every piece begins where there are edges above and to the left."""
        found = []
        for top, left in np.argwhere(self.walls & self.above & self.left).tolist():
            right, bottom = left, top
            while not self.left[top, right + 1]:
                right += 1
            while not self.above[bottom + 1, left]:
                bottom += 1
            found.append(Rectangle(top - 1, left - 1, bottom - 1, right - 1))
        return found


def _inner_corners(walls: BoolArray) -> dict[Point, int]:
    """Lattice points with walls on three sides, and in which direction the row through them enters the walls."""
    quarters = walls[:-1, :-1], walls[:-1, 1:], walls[1:, :-1], walls[1:, 1:]
    count = np.sum(quarters, axis=0)
    free_on_the_right = ~quarters[1] | ~quarters[3]
    return {(i, j): -1 if free_on_the_right[i, j] else 1 for i, j in np.argwhere(count == 3).tolist()}


def _chords(cuts: _Cuts, corners: dict[Point, int]) -> tuple[list[list[Point]], list[list[Point]]]:
    """Horizontal and vertical chords as lattice points: inside walls, from an inner corner to the next one."""
    found: tuple[list[list[Point]], list[list[Point]]] = ([], [])
    for axis, chords in zip((1, 0), found, strict=True):
        for corner in corners:
            points = [corner]
            while cuts.inside(points[-1], 1, axis):
                i, j = points[-1]
                points.append((i, j + 1) if axis == 1 else (i + 1, j))
                if points[-1] in corners:
                    chords.append(points)
                    break
    return found


def _most_apart(horizontal: list[list[Point]], vertical: list[list[Point]]) -> list[list[Point]]:
    """The most chords of which no two share a lattice point.

    The bipartite graph of chords that meet has a largest independent set that follows from a largest matching: with H
    all horizontal chords without partner and everything that alternating paths reach from them, it is the horizontal
    chords in H and the vertical ones outside of it.
    """
    through: defaultdict[Point, list[int]] = defaultdict(list)
    for v, chord in enumerate(vertical):
        for point in chord:
            through[point].append(v)
    meets = [sorted({v for point in chord for v in through[point]}) for chord in horizontal]
    matching = _Matching({}, {})
    unmatched = [h for h in range(len(horizontal)) if not matching.enlarged(h, meets)]
    reached_h, reached_v = set(unmatched), set[int]()
    while unmatched:
        for v in meets[unmatched.pop()]:
            if v not in reached_v:
                reached_v.add(v)
                reached_h.add(matching.of_vertical[v])
                unmatched.append(matching.of_vertical[v])
    return [
        *(chord for h, chord in enumerate(horizontal) if h in reached_h),
        *(chord for v, chord in enumerate(vertical) if v not in reached_v),
    ]


@dataclass(frozen=True)
class _Matching:
    """Pairs of chords that meet: each chord's partner, by its number among the vertical and the horizontal ones."""

    of_vertical: dict[int, int]
    of_horizontal: dict[int, int]

    def enlarged(self, start: int, meets: list[list[int]]) -> bool:
        """Whether an alternating path from the horizontal chord `start` gave all on it a partner.

        Breadth first and without recursion, because paths may be as long as there are chords.
        """
        came_from: dict[int, int] = {}
        queue = [start]
        for h in queue:
            for v in meets[h]:
                if v in came_from:
                    continue
                came_from[v] = h
                if v not in self.of_vertical:
                    self._swap(v, came_from)
                    return True
                queue.append(self.of_vertical[v])
        return False

    def _swap(self, end: int, came_from: dict[int, int]) -> None:
        following: int | None = end
        while following is not None:
            v, h = following, came_from[following]
            following = self.of_horizontal.get(h)
            self.of_vertical[v], self.of_horizontal[h] = h, v
