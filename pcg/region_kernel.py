"""Regions of cells without wall, in compiled code: how many there are, and whether a wall at one cell matters.

A map is a (rows, columns) array of `Tile` values. A board is flat with a border of wall, as in `pcg.solver_kernel`.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from pcg.arrays import ByteArray, Int32Array
from pcg.level import Tile, TileArray

WALL = int(Tile.WALL)


class Scratch(NamedTuple):
    """Memory that is used for one map after the other.

    Attributes:
        board: (cells,) tiles with a border of wall.
        width: Cells of a row of the board.
        unvisited: (cells,) flags.
        queue: (cells,) cells.
    """

    board: ByteArray
    width: int
    unvisited: ByteArray
    queue: Int32Array


@njit(cache=True)
def make_scratch(rows: int, columns: int) -> Scratch:
    """Scratch memory for maps of one shape."""
    size = (rows + 2) * (columns + 2)
    board, unvisited = np.full(size, WALL, dtype=np.uint8), np.zeros(size, dtype=np.uint8)
    return Scratch(board, columns + 2, unvisited, np.empty(size, dtype=np.int32))


@njit(cache=True)
def fill(scratch: Scratch, tiles: TileArray) -> None:
    """Copies a map to the board."""
    rows, columns = tiles.shape
    for i in range(rows):
        for j in range(columns):
            scratch.board[(i + 1) * scratch.width + j + 1] = tiles[i, j]


@njit(cache=True)
def visit(cell: int, width: int, unvisited: ByteArray, queue: Int32Array) -> int:
    """Clears the flags of all cells connected to `cell`, lists them in `queue` and returns their number."""
    unvisited[cell] = 0
    queue[0] = cell
    begin, end = 0, 1
    while begin < end:
        cell = queue[begin]
        begin += 1
        for step in (-1, -width, 1, width):
            if unvisited[cell + step]:
                unvisited[cell + step] = 0
                queue[end] = cell + step
                end += 1
    return end


@njit(cache=True)
def count_regions(scratch: Scratch) -> int:
    """The number of four-connected regions of cells without wall on the board."""
    unvisited = scratch.unvisited
    for cell in range(unvisited.size):
        unvisited[cell] = scratch.board[cell] != WALL
    regions = 0
    for cell in range(unvisited.size):
        if unvisited[cell]:
            regions += 1
            visit(cell, scratch.width, unvisited, scratch.queue)
    return regions


@njit(cache=True)
def parts_around(tiles: TileArray, i: int, j: int) -> int:
    """Into how many parts the free neighbours of cell (i, j) fall within the eight cells around it.

    With one part a wall at the cell divides nothing, with none it is alone; with more the rest of the map decides. The
    number is that of Yokoi, Toriwaki and Fukumura (1975) for four-connectivity, which is 0 if all eight are free.
    """
    is_free = _free_around(tiles, i, j)
    neighbours, crossings = 0, 0
    for k in range(0, 8, 2):
        neighbours += is_free[k]
        crossings += is_free[k] - is_free[k] * is_free[k + 1] * is_free[(k + 2) % 8]
    return max(crossings, 1) if neighbours > 0 else 0


@njit(cache=True)
def _free_around(tiles: TileArray, i: int, j: int) -> tuple[int, int, int, int, int, int, int, int]:
    """Flags of the eight cells around (i, j) without wall, from the right one counter-clockwise."""
    return (
        _is_free(tiles, i, j + 1),
        _is_free(tiles, i - 1, j + 1),
        _is_free(tiles, i - 1, j),
        _is_free(tiles, i - 1, j - 1),
        _is_free(tiles, i, j - 1),
        _is_free(tiles, i + 1, j - 1),
        _is_free(tiles, i + 1, j),
        _is_free(tiles, i + 1, j + 1),
    )


@njit(cache=True)
def _is_free(tiles: TileArray, i: int, j: int) -> int:
    inside = 0 <= i < tiles.shape[0] and 0 <= j < tiles.shape[1]
    return 1 if inside and tiles[i, j] != WALL else 0
