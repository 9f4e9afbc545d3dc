"""Levels: what stands on the cells of a grid.

Cells are (row, column) of the inner grid, without the outer wall that surrounds every level; row 0 is at the top.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from typing import Self

import numpy as np
import numpy.typing as npt

from pcg.arrays import BoolArray
from pcg.errors import InputError
from pcg.grid import Cell, cells_of

TileArray = npt.NDArray[np.uint8]


class Tile(IntEnum):
    """The content of a cell."""

    FLOOR = 0
    WALL = 1
    PLAYER = 2
    CRATE = 3
    TARGET = 4
    CRATE_ON_TARGET = 5
    PLAYER_ON_TARGET = 6


@dataclass(frozen=True, eq=False)
class Level:
    """A Sokoban-like level; `dataclasses.replace` makes variants.

    A level may be unfinished, with any number of players, crates and targets; `require_playable` refuses such levels.

    Attributes:
        tiles: (rows, columns) `Tile` values of the inner cells, at least one cell; kept as a read-only copy.
        name: One printable line without space around it; may be empty.
        goal_crate: Cell of the crate that has to reach the first target in reading order, None for any crate.
    """

    tiles: TileArray
    name: str = ""
    goal_crate: Cell | None = None

    def __post_init__(self) -> None:
        tiles = np.asarray(self.tiles)
        if tiles.ndim != 2 or tiles.size == 0:
            raise ValueError(f"tiles need rows and columns, found shape {tiles.shape}")
        if tiles.dtype.kind not in "iu" or tiles.min() < 0 or tiles.max() >= len(Tile):
            raise ValueError(f"tiles must be integers from 0 to {len(Tile) - 1}")
        if not self.name.isprintable() or self.name != self.name.strip():
            raise ValueError(f"name {self.name!r} must be one printable line without space around it")
        tiles = tiles.astype(np.uint8)
        tiles.flags.writeable = False
        object.__setattr__(self, "tiles", tiles)
        if self.goal_crate is not None and self.goal_crate not in self.crates:
            raise ValueError(f"goal crate {self.goal_crate} is not a crate; there are {self.crates}")

    @classmethod
    def of(
        cls,
        is_wall: BoolArray,
        *,
        players: Iterable[Cell] = (),
        crates: Iterable[Cell] = (),
        targets: Iterable[Cell] = (),
        name: str = "",
        goal_crate: Cell | None = None,
    ) -> Self:
        """The level with walls where the (rows, columns) mask `is_wall` says, and the given things on its floor.

        Raises:
            ValueError: a thing stands in a wall or on another thing; only a target may be shared.
        """
        tiles = np.where(is_wall, Tile.WALL, Tile.FLOOR).astype(np.uint8)
        for things, on in ((targets, _TARGET_ON), (crates, _CRATE_ON), (players, _PLAYER_ON)):
            for cell in things:
                tile = Tile(tiles[cell])
                if tile not in on:
                    raise ValueError(f"cell {cell} is taken: it holds {tile.name}")
                tiles[cell] = on[tile]
        return cls(tiles, name, goal_crate)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Level):
            return NotImplemented
        return self._identity == other._identity

    def __hash__(self) -> int:
        return hash(self._identity)

    @cached_property
    def _identity(self) -> tuple[Cell, bytes, str, Cell | None]:
        return self.shape, self.tiles.tobytes(), self.name, self.goal_crate

    @property
    def shape(self) -> Cell:
        """Numbers of inner rows and columns."""
        rows, columns = self.tiles.shape
        return rows, columns

    @cached_property
    def is_wall(self) -> BoolArray:
        """(rows, columns) mask of the walls, read-only."""
        return self._mask(Tile.WALL)

    @cached_property
    def is_crate(self) -> BoolArray:
        """(rows, columns) mask of the crates, read-only."""
        return self._mask(Tile.CRATE, Tile.CRATE_ON_TARGET)

    @cached_property
    def is_target(self) -> BoolArray:
        """(rows, columns) mask of the targets, read-only."""
        return self._mask(Tile.TARGET, Tile.CRATE_ON_TARGET, Tile.PLAYER_ON_TARGET)

    @cached_property
    def is_player(self) -> BoolArray:
        """(rows, columns) mask of the players, read-only."""
        return self._mask(Tile.PLAYER, Tile.PLAYER_ON_TARGET)

    @property
    def players(self) -> list[Cell]:
        """Cells of the players in reading order; one in a playable level."""
        return cells_of(self.is_player)

    @property
    def crates(self) -> list[Cell]:
        """Cells of the crates in reading order."""
        return cells_of(self.is_crate)

    @property
    def targets(self) -> list[Cell]:
        """Cells of the targets in reading order."""
        return cells_of(self.is_target)

    @property
    def player(self) -> Cell:
        """Cell of the only player.

        Raises:
            ValueError: there is none, or there are several.
        """
        players = self.players
        if len(players) != 1:
            raise ValueError(f"the level has {len(players)} players, not one")
        return players[0]

    def require_playable(self, where: str) -> None:
        """Refuses a level that cannot be played: one player, a target and at least as many crates are needed.

        Args:
            where: What the level was read from; it begins the message.

        Raises:
            InputError: naming what is missing or too much.
        """
        players, crates, targets = (len(cells) for cells in (self.players, self.crates, self.targets))
        if players != 1:
            raise InputError(where, f"the level has {players or 'no'} players; exactly one is needed")
        if targets == 0:
            raise InputError(where, "the level has no target; at least one is needed")
        if crates < targets:
            raise InputError(where, f"the level has fewer crates ({crates}) than targets ({targets})")

    def _mask(self, *tiles: Tile) -> BoolArray:
        mask = np.isin(self.tiles, tiles)
        mask.flags.writeable = False
        return mask


_TARGET_ON = {Tile.FLOOR: Tile.TARGET}
_CRATE_ON = {Tile.FLOOR: Tile.CRATE, Tile.TARGET: Tile.CRATE_ON_TARGET}
_PLAYER_ON = {Tile.FLOOR: Tile.PLAYER, Tile.TARGET: Tile.PLAYER_ON_TARGET}
