"""From a level to a scene: cells become blocks, crates become objects, the first target becomes the goal.

What differs between the two geometry presets comes from `converter.preset`, sizes and other choices from
`converter.convert_options`. Level row 0 has the largest y.
"""

import logging
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from converter.convert_options import ConversionSettings
from converter.convert_walls import Grid, blocks, outer_walls
from converter.formats.scene_yaml import MAX_BODIES
from converter.occlusion import occluded
from converter.preset import OUTER_WALL_SIDES, Preset, preset_named
from converter.scene import Agent, Body, Goal, Scene
from converter.shape import FloatArray, Part, denoised
from pcg.errors import InputError
from pcg.grid import Cell
from pcg.level import Level
from pcg.metrics import occluded as level_occluded
from pcg.solver import SolverStatus, goal_crate_of, solve
from pcg.symmetry import tiles_hash
from pcg.xsb import format_level

__all__ = ["ConversionSettings", "convert_level"]

GOAL_OBJECT = "obj"
GOAL_OBJECT_COLOR = (0.0, 0.0, 1.0)

_logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class _Choice:
    """The crate that becomes the goal-object: its cell, who chose it, and whether the level is solvable if known."""

    crate: Cell
    by: str
    solvable: bool | None


def convert_level(level: Level, settings: ConversionSettings | None = None) -> Scene:
    """The scene of a level.

    The goal-object is the crate that the settings or else the level name; or else the crate that the solver brings to
    the first target in reading order; or else, with a logged warning, the first crate.

    Args:
        level: One player, and at least one crate and one target.
        settings: Sizes and choices; by default those of `ConversionSettings()`.

    Raises:
        InputError: the level lacks something, or is too large for a scene file.
    """
    settings = settings or ConversionSettings()
    level.require_playable(level.name or "level")
    if level.is_wall.sum() + len(OUTER_WALL_SIDES) > MAX_BODIES:
        raise InputError(level.name or "level", f"more than {MAX_BODIES} walls, the most that a scene may have")
    asked = _with_one_target(level) if settings.drop_targets or settings.drop_crates else level
    choice = _choose_goal_crate(asked, settings)
    if settings.drop_crates:
        # Who solves a level of several crates also solves it without the others, but not the other way round.
        asked, choice = _with_one_crate(asked, choice.crate), replace(choice, solvable=choice.solvable or None)
    preset = preset_named(settings.preset)
    scene = _scene(asked, choice.crate, _footprints(level, settings), settings, preset)
    return replace(scene, source=_source(level, asked, choice, settings, scene))


def _with_one_target(level: Level) -> Level:
    return Level.of(
        level.is_wall,
        players=level.players,
        crates=level.crates,
        targets=level.targets[:1],
        name=level.name,
        goal_crate=level.goal_crate,
    )


def _with_one_crate(level: Level, crate: Cell) -> Level:
    return Level.of(
        level.is_wall,
        players=level.players,
        crates=[crate],
        targets=level.targets,
        name=level.name,
        goal_crate=None if level.goal_crate is None else crate,
    )


def _choose_goal_crate(level: Level, settings: ConversionSettings) -> _Choice:
    if settings.goal_crate is not None:
        return _Choice(_crate_numbered(level, settings.goal_crate), "option", solvable=None)
    if level.goal_crate is not None:
        return _Choice(level.goal_crate, "level", solvable=None)
    solution = solve(level)
    crate = goal_crate_of(level, solution)
    if solution.solved:
        return _Choice(crate, "solution", solvable=True)
    unsolvable = solution.status is SolverStatus.UNSOLVABLE
    reason = "the level is unsolvable" if unsolvable else "the solver gave up"
    _logger.warning("%s: %s, so the first crate becomes the goal-object", level.name or "level", reason)
    return _Choice(crate, "first crate", solvable=False if unsolvable else None)


def _crate_numbered(level: Level, number: int) -> Cell:
    if number > len(level.crates):
        raise InputError(f"level {level.name!r}", f"goal_crate: {number}, but the level has only {len(level.crates)}")
    return level.crates[number - 1]


@dataclass(frozen=True, eq=False)
class _Footprint:
    """What a crate becomes: sides (2,) [m] before `yaw` [rad]."""

    size: FloatArray
    yaw: float


def _footprints(level: Level, settings: ConversionSettings) -> dict[Cell, _Footprint]:
    """The footprints of all crates, by cell.

    Every crate takes the same draws whatever the options are. They are shortened to tenths of millimetres and of
    milliradians, towards zero, so that what the options allow is kept.
    """
    rng = np.random.default_rng([settings.seed, int(tiles_hash(level), 16)])
    most = np.array([settings.object_size * settings.size_jitter] * 2 + [settings.yaw_jitter])
    found = {}
    for cell in level.crates:
        *longer, yaw = np.trunc(most * rng.uniform(-1, 1, 3) * 1e4) / 1e4
        found[cell] = _Footprint(denoised(settings.object_size + np.array(longer)), float(yaw) + 0.0)
    return found


def _scene(
    level: Level, goal_crate: Cell, footprints: dict[Cell, _Footprint], settings: ConversionSettings, preset: Preset
) -> Scene:
    grid = Grid(level.shape, settings.cell)
    others = [cell for cell in level.crates if cell != goal_crate]
    names = [GOAL_OBJECT, *(f"{GOAL_OBJECT}{i}" for i in range(1, len(others) + 1))]
    height = settings.object_height or settings.object_size
    objects = [
        Body(
            name,
            np.array([*grid.centre(cell), height / 2]),
            height,
            (Part.box(footprints[cell].size, preset.object_edge_radius),),
            footprints[cell].yaw,
        )
        for name, cell in zip(names, [goal_crate, *others], strict=True)
    ]
    objects[0] = replace(objects[0], color=GOAL_OBJECT_COLOR)
    radius = preset.agent_radius if settings.agent_radius is None else settings.agent_radius
    inner = blocks(level.is_wall, grid, settings.wall_height, preset.block_edge_radius, merge=settings.merge_walls)
    return Scene(
        name=level.name or "level",
        bounds=grid.floor,
        tolerance=preset.tolerance,
        agent=Agent(grid.centre(level.player), radius, settings.agent_height),
        walls=(*outer_walls(grid, settings.wall_height, preset), *inner),
        objects=tuple(objects),
        goal=Goal(GOAL_OBJECT, grid.centre(level.targets[0]), np.full(2, settings.goal_size)),
        preset=preset.name,
    )


def _source(given: Level, level: Level, choice: _Choice, settings: ConversionSettings, scene: Scene) -> dict[str, Any]:
    """Where the scene came from. `xsb` is the level that the scene shows; `dropped` is what the given one has besides."""
    dropped = {
        "crates": [list(cell) for cell in given.crates if cell not in level.crates],
        "targets": [list(cell) for cell in given.targets if cell not in level.targets],
    }
    return {
        "level": level.name,
        "rows": level.shape[0],
        "columns": level.shape[1],
        "xsb": format_level(replace(level, name="")),
        **({"dropped": dropped} if any(dropped.values()) else {}),
        "goal_crate": list(choice.crate),
        "goal_crate_from": choice.by,
        "solvable": choice.solvable,
        "occluded": {"level": level_occluded(level, choice.crate), "scene": occluded(scene)},
        "settings": settings.as_recorded(preset_named(settings.preset)),
    }
