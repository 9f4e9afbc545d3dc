"""The eight symmetries of the square grid: levels that differ by a turn or a mirror are the same puzzle."""

import hashlib
from dataclasses import replace
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from pcg.grid import Cell, cells_of
from pcg.level import Level

Scalar = TypeVar("Scalar", bound=np.generic)


def symmetries(level: Level) -> tuple[Level, ...]:
    """The level turned by 0, 90, 180 and 270 degrees counter-clockwise, then the same of its mirror image.

    Names stay, goal crates follow. A symmetric level repeats itself among the eight.
    """
    marked = np.zeros(level.shape, dtype=np.bool_)
    if level.goal_crate is not None:
        marked[level.goal_crate] = True
    return tuple(
        replace(level, tiles=tiles, goal_crate=next(iter(cells_of(mark)), None))
        for tiles, mark in zip(images(level.tiles), images(marked), strict=True)
    )


def canonical(level: Level) -> Level:
    """The one of the eight symmetries that represents them all: the same for symmetric levels, but for the name."""
    return min(symmetries(level), key=lambda image: (_key(image.tiles), image.goal_crate or (-1, -1)))


def content_hash(level: Level) -> str:
    """Sixteen hexadecimal digits over the tiles, the same for all eight symmetries.

    Names and goal crates do not count: a level has one hash, whichever crate a scene made of it moves.
    """
    return _digest(min(images(level.tiles), key=_key))


def tiles_hash(level: Level) -> str:
    """Sixteen hexadecimal digits over the tiles as they are; it differs for symmetric levels that look different."""
    return _digest(level.tiles)


def images(array: npt.NDArray[Scalar]) -> list[npt.NDArray[Scalar]]:
    """The eight symmetries of a (rows, columns) array, in the order of `symmetries`."""
    return [np.rot90(image, turns) for image in (array, np.fliplr(array)) for turns in range(4)]


def _digest(tiles: npt.NDArray[np.uint8]) -> str:
    rows, columns = tiles.shape
    return hashlib.sha256(f"{rows} x {columns}: ".encode() + tiles.tobytes()).hexdigest()[:16]


def _key(tiles: npt.NDArray[np.uint8]) -> tuple[Cell, bytes]:
    rows, columns = tiles.shape
    return (rows, columns), tiles.tobytes()
