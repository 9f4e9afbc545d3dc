"""Pictures of levels: one square tile a cell, the outer wall included."""

from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from converter.drawing import Drawing, Inset, Item, Shape, box, disc
from converter.theme import PAPER, Color, Theme, mixed
from pcg.level import Level, Tile, TileArray

GOAL_CRATE = len(Tile)
GOAL_CRATE_ON_TARGET = len(Tile) + 1
"""Kinds of tiles beyond those of a level's cells."""

_CENTER = np.array([0.5, 0.5])


def level_drawing(level: Level, *, theme: Theme = PAPER) -> Drawing:
    """The level as a drawing in which a tile is a unit square."""
    kinds = tile_kinds(level)
    rows, columns = kinds.shape
    tiles = tile_drawings(theme)
    insets = [
        Inset(tiles[kinds[row, column]], np.array([column, rows - 1.0 - row]), 1.0)
        for row in range(rows)
        for column in range(columns)
    ]
    # Where a program smooths the edges of tiles, what is below them shows between walls.
    return Drawing(np.zeros(2), np.array([float(columns), float(rows)]), theme.wall_dark, tuple(insets))


def tile_kinds(level: Level) -> TileArray:
    """(rows + 2, columns + 2): the kind of each tile of the picture, in the numbers of `tile_drawings`."""
    kinds = np.pad(level.tiles, 1, constant_values=Tile.WALL)
    if level.goal_crate is not None:
        row, column = level.goal_crate
        on_target = level.tiles[row, column] == Tile.CRATE_ON_TARGET
        kinds[row + 1, column + 1] = GOAL_CRATE_ON_TARGET if on_target else GOAL_CRATE
    return kinds


@lru_cache(maxsize=4)
def tile_drawings(theme: Theme) -> Mapping[int, Drawing]:
    """The unit square of every kind of tile: those of `Tile`, `GOAL_CRATE` and `GOAL_CRATE_ON_TARGET`."""
    floor = _floor(theme)
    target = [*floor, *_target(theme)]
    crate, goal_crate, player = _crate(theme.crate, theme), _crate(theme.goal_object, theme), _player(theme)
    items: dict[int, list[Item]] = {
        Tile.FLOOR: floor,
        Tile.WALL: _wall(theme),
        Tile.PLAYER: [*floor, *player],
        Tile.CRATE: [*floor, *crate],
        Tile.TARGET: target,
        Tile.CRATE_ON_TARGET: [*target, *crate],
        Tile.PLAYER_ON_TARGET: [*target, *player],
        GOAL_CRATE: [*floor, *goal_crate],
        GOAL_CRATE_ON_TARGET: [*target, *goal_crate],
    }
    return {
        kind: Drawing(
            np.zeros(2), np.ones(2), theme.wall_dark if kind == Tile.WALL else theme.floor_line, tuple(items[kind])
        )
        for kind in items
    }


def _floor(theme: Theme) -> list[Item]:
    return [Shape((box(_CENTER, (0.96, 0.96)),), theme.floor)]


def _wall(theme: Theme) -> list[Item]:
    """A block lit from the upper left; its shaded edges are the tile's background."""
    return [
        Shape((box((0.48, 0.52), (0.94, 0.94), 0.06),), theme.wall_light),
        Shape((box((0.5, 0.5), (0.88, 0.88), 0.06),), theme.wall),
    ]


def _target(theme: Theme) -> list[Item]:
    return [Shape((box(_CENTER, (0.82, 0.82), 0.04),), theme.goal, outline=theme.goal_dark, outline_width=0.03)]


def _player(theme: Theme) -> list[Item]:
    return [Shape((disc(_CENTER, 0.36),), theme.agent, outline=theme.outline, outline_width=0.04)]


def _crate(color: Color, theme: Theme) -> list[Item]:
    """Three planks in a frame."""
    frame, shade = mixed(color, theme.outline, 0.15), mixed(color, theme.outline, 0.45)
    planks = [box((0.5, y), (0.48, 0.14)) for y in (0.34, 0.5, 0.66)]
    return [
        Shape((box(_CENTER, (0.66, 0.66), 0.03),), frame, outline=theme.outline, outline_width=0.04),
        *(Shape((plank,), color, outline=shade, outline_width=0.025) for plank in planks),
    ]
