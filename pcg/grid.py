"""Four-connected grids: directions, reachable cells, regions and shortest walks.

Cells are (row, column) with row 0 at the top. Masks are (rows, columns) booleans. What lies outside a mask is closed.
"""

from collections import deque
from collections.abc import Iterable

import numpy as np

from pcg.arrays import BoolArray

Cell = tuple[int, int]

DIRECTIONS: dict[str, Cell] = {"l": (0, -1), "u": (-1, 0), "r": (0, 1), "d": (1, 0)}
"""Row and column steps by their letter in LURD notation."""


def cells_of(mask: BoolArray) -> list[Cell]:
    """The cells where `mask` holds, in reading order."""
    return [(row, column) for row, column in np.argwhere(mask).tolist()]


def reachable(passable: BoolArray, starts: Iterable[Cell]) -> BoolArray:
    """The cells that can be walked to from any of `starts`; a start that is not passable reaches nothing."""
    width = passable.shape[1] + 2
    unvisited = _padded(passable)
    for row, column in starts:
        _visit(unvisited, (row + 1) * width + column + 1, width)
    left = np.frombuffer(unvisited, dtype=np.bool_).reshape(-1, width)[1:-1, 1:-1]
    return passable & ~left


def count_regions(passable: BoolArray) -> int:
    """The number of four-connected regions of passable cells."""
    width = passable.shape[1] + 2
    unvisited = _padded(passable)
    regions = 0
    while (start := unvisited.find(1)) >= 0:
        _visit(unvisited, start, width)
        regions += 1
    return regions


def shortest_walk(passable: BoolArray, start: Cell, end: Cell) -> str | None:
    """A shortest walk in lower-case LURD letters, None if there is none.

    The same arguments always give the same of several shortest walks.
    """
    if start == end:
        return ""
    width = passable.shape[1] + 2
    free = _padded(passable)
    first, last = ((row + 1) * width + column + 1 for row, column in (start, end))
    steps = {letter: row * width + column for letter, (row, column) in DIRECTIONS.items()}
    arrived: dict[int, str] = {first: ""}
    queue = deque([first])
    while queue and last not in arrived:
        cell = queue.popleft()
        for letter, step in steps.items():
            if free[cell + step] and cell + step not in arrived:
                arrived[cell + step] = letter
                queue.append(cell + step)
    if last not in arrived:
        return None
    letters = []
    while letter := arrived[last]:
        letters.append(letter)
        last -= steps[letter]
    return "".join(reversed(letters))


def _padded(passable: BoolArray) -> bytearray:
    # A closed border spares every bounds check below.
    padded = np.zeros((passable.shape[0] + 2, passable.shape[1] + 2), dtype=np.bool_)
    padded[1:-1, 1:-1] = passable
    return bytearray(padded.tobytes())


def _visit(unvisited: bytearray, start: int, width: int) -> None:
    if not unvisited[start]:
        return
    unvisited[start] = 0
    stack = [start]
    while stack:
        cell = stack.pop()
        for neighbour in (cell - 1, cell - width, cell + 1, cell + width):
            if unvisited[neighbour]:
                unvisited[neighbour] = 0
                stack.append(neighbour)
