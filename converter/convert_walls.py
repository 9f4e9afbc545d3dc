"""The walls of a converted level: outer walls, and blocks where its cells are walls.

Blocks are called `block_{column}_{row}` as in the authors' scenes: columns from the left and rows from the bottom,
counted from 1, so the names grow with x and y. A merged block has the names of its lower left and upper right cell:
`block_2_3_to_5_3`.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from converter.formats.body_document import MAX_PARTS
from converter.merge_walls import Rectangle, merged
from converter.preset import BLOCK_PREFIX, OUTER_WALL_SIDES, Preset
from converter.scene import OUTER_WALL_PREFIX, Body
from converter.shape import FloatArray, Part, denoised
from pcg.arrays import BoolArray
from pcg.grid import Cell

FLOOR_MARGIN = 0.05
"""How far the floor and the outer walls reach beyond the border of the grid [m]."""


@dataclass(frozen=True)
class Grid:
    """Where the cells of a level are: rows and columns, and the side of a cell [m]; the middle is the origin."""

    shape: Cell
    cell: float

    @property
    def border(self) -> FloatArray:
        """(2, 2) [m]: lower and upper corner of the grid."""
        rows, columns = self.shape
        return denoised(np.outer([-0.5, 0.5], [columns * self.cell, rows * self.cell]))

    @property
    def floor(self) -> FloatArray:
        """(2, 2) [m]: lower and upper corner of the floor, which reaches to the outer faces of the outer walls."""
        return self.border + FLOOR_MARGIN * np.array([[-1.0], [1.0]])

    def centre(self, cell: tuple[float, float]) -> FloatArray:
        """(2,) [m]: the centre of a cell; row 0 has the largest y. Half a row or column is the border of two."""
        (rows, columns), (row, column) = self.shape, cell
        return denoised(np.array([column - (columns - 1) / 2, (rows - 1) / 2 - row]) * self.cell)


def outer_walls(grid: Grid, height: float, preset: Preset) -> list[Body]:
    """Walls whose outer faces are at the edge of the floor and whose inner faces are where the preset wants them."""
    size = np.ptp(grid.border, axis=0)
    walls = []
    for side, (axis, direction) in OUTER_WALL_SIDES.items():
        extent = size + 2 * FLOOR_MARGIN
        extent[axis] = FLOOR_MARGIN + preset.outer_wall_overhang
        position = np.array([0.0, 0.0, height / 2])
        position[axis] = direction * (size[axis] / 2 + FLOOR_MARGIN - extent[axis] / 2)
        part = Part.box(denoised(extent), preset.outer_wall_edge_radius)
        walls.append(Body(OUTER_WALL_PREFIX + side, denoised(position), height, (part,)))
    return walls


def blocks(is_wall: BoolArray, grid: Grid, height: float, edge_radius: float, *, merge: bool) -> list[Body]:
    """Bodies that fill the wall cells, from left to right and from the bottom to the top.

    Args:
        is_wall: (rows, columns) mask.
        grid: Where the cells are.
        height: [m].
        edge_radius: Of the block of a cell [m].
        merge: Whether to make few bodies that fill the same space. With sharp edges these are larger boxes; the notches
            between rounded blocks fit no larger box, so these stay as they are, several to a body.
    """
    rectangles = merged(is_wall) if merge else [Rectangle(*cell, *cell) for cell in np.argwhere(is_wall).tolist()]
    if edge_radius > 0:
        rectangles = [piece for rectangle in rectangles for piece in rectangle.pieces(MAX_PARTS)]
    rectangles.sort(key=lambda rectangle: (rectangle.left, -rectangle.bottom))
    return [_block(rectangle, grid, height, edge_radius) for rectangle in rectangles]


def _block(rectangle: Rectangle, grid: Grid, height: float, edge_radius: float) -> Body:
    middle = grid.centre(((rectangle.top + rectangle.bottom) / 2, (rectangle.left + rectangle.right) / 2))
    return Body(
        _name(rectangle, grid.shape[0]),
        np.array([*middle, height / 2]),
        height,
        tuple(_parts(rectangle, grid, middle, edge_radius)),
    )


def _parts(rectangle: Rectangle, grid: Grid, middle: FloatArray, edge_radius: float) -> Iterator[Part]:
    """One box, or the rounded blocks of all cells, relative to the middle (2,) [m] of the rectangle."""
    if edge_radius == 0:
        rows, columns = rectangle.shape
        yield Part.box(denoised([columns * grid.cell, rows * grid.cell]))
        return
    block = Part.box((grid.cell, grid.cell), edge_radius)
    for cell in rectangle.cells:
        yield Part(denoised(block.core + grid.centre(cell) - middle), edge_radius)


def _name(rectangle: Rectangle, rows: int) -> str:
    first = f"{BLOCK_PREFIX}{rectangle.left + 1}_{rows - rectangle.bottom}"
    return first if rectangle.shape == (1, 1) else f"{first}_to_{rectangle.right + 1}_{rows - rectangle.top}"
