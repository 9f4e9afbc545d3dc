"""Frozen tiles: the parts of a level that a generator has to keep.

They are written like a level in XSB text, with `?` for the cells that are left open:

    ############
    #??????????#
    #??##  ##??#
    #?????.????#
    ...
    ############

The outer wall belongs to the text; floor is a space, or `-` or `_`.
"""

from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

import numpy as np

from pcg.arrays import BoolArray
from pcg.errors import InputError
from pcg.files import read_text
from pcg.grid import Cell
from pcg.level import Level, Tile, TileArray
from pcg.xsb import MAX_SIDE, TILE_OF_CHARACTER

OPEN = 255
"""Of a cell that is not frozen."""

OPEN_CHARACTER = "?"


@dataclass(frozen=True, eq=False)
class FrozenTiles:
    """Tiles that are fixed, and cells that are open.

    Attributes:
        tiles: (rows, columns) `Tile` values of the inner cells, `OPEN` where anything may stand; a read-only copy.
    """

    tiles: TileArray

    def __post_init__(self) -> None:
        tiles = np.asarray(self.tiles)
        if tiles.ndim != 2 or tiles.size == 0 or not np.isin(tiles, [*Tile, OPEN]).all():
            raise ValueError("frozen tiles need rows and columns of Tile values or OPEN")
        tiles = tiles.astype(np.uint8)
        tiles.flags.writeable = False
        object.__setattr__(self, "tiles", tiles)

    @classmethod
    @cache
    def none(cls, rows: int, columns: int) -> "FrozenTiles":
        """All cells open."""
        return cls(np.full((rows, columns), OPEN, dtype=np.uint8))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, FrozenTiles) and np.array_equal(self.tiles, other.tiles)

    def __hash__(self) -> int:
        return hash((self.shape, self.tiles.tobytes()))

    @property
    def shape(self) -> Cell:
        """Inner rows and columns."""
        rows, columns = self.tiles.shape
        return rows, columns

    @cached_property
    def is_open(self) -> BoolArray:
        """(rows, columns) mask of the cells where anything may stand."""
        return np.asarray(self.tiles == OPEN, dtype=np.bool_)

    def kept_by(self, level: Level) -> bool:
        """Whether the level has the frozen tiles where they belong."""
        return level.shape == self.shape and bool((self.is_open | (level.tiles == self.tiles)).all())


def read_frozen(path: Path) -> FrozenTiles:
    """Reads frozen tiles; lines before the first wall and after the last, and blank ones, do not count.

    Raises:
        InputError: naming file, line and reason.
    """
    lines = enumerate(read_text(path).split("\n"), start=1)
    rows = [(number, line.rstrip()) for number, line in lines if line.strip()]
    walls = [i for i, (_, line) in enumerate(rows) if line.startswith("#")]
    rows = rows[walls[0] : walls[-1] + 1] if walls else []
    if len(rows) < 3:
        raise InputError(str(path), "no frozen tiles found: at least three lines have to begin with a wall '#'")
    width = len(rows[0][1])
    if max(len(rows), width) > MAX_SIDE:
        raise InputError(str(path), f"{len(rows)} x {width} cells; at most {MAX_SIDE} x {MAX_SIDE} are read")
    tiles = [_row(f"{path}: line {number}", line, width) for number, line in rows]
    for (number, line), is_edge in zip(rows, [True, *[False] * (len(rows) - 2), True], strict=True):
        if line[0] + line[-1] != "##" or (is_edge and set(line) != {"#"}):
            raise InputError(f"{path}: line {number}", "the outer wall has a gap; every row begins and ends with '#'")
    inner = np.array(tiles, dtype=np.uint8)[1:-1, 1:-1]
    if inner.size == 0:
        raise InputError(str(path), "the walls enclose no cell")
    return FrozenTiles(inner)


def _row(where: str, line: str, width: int) -> list[int]:
    if len(line) != width:
        raise InputError(where, f"{len(line)} characters, but the first line has {width}")
    allowed = {**TILE_OF_CHARACTER, OPEN_CHARACTER: OPEN}
    if unknown := set(line) - allowed.keys():
        column = min(map(line.index, unknown))
        problem = f"column {column + 1} holds {line[column]!r}; allowed are # @ + $ * . ? and, for floor, space - _"
        raise InputError(where, problem)
    return [allowed[character] for character in line]
