"""From a level to a scene: cells become blocks, crates become objects, the first target becomes the goal.

The defaults are the sizes of the authors' generated scenes [L]; what differs between the two geometry presets comes
from `converter.preset`. Level row 0 has the largest y. Blocks are called `block_{column}_{row}` as in those scenes:
columns from the left and rows from the bottom, counted from 1, so the names grow with x and y.

[L] Levit, Ortiz-Haro, Toussaint: Solving Sequential Manipulation Puzzles by Finding Easier Subproblems, ICRA 2024.
"""

import logging
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from converter.formats.body_document import MAX_LENGTH, MIN_LENGTH
from converter.formats.scene_yaml import MAX_BODIES
from converter.occlusion import occluded
from converter.preset import BLOCK_PREFIX, CLEAR, OUTER_WALL_SIDES, Preset, preset_named
from converter.scene import OUTER_WALL_PREFIX, Agent, Body, Goal, Scene
from converter.shape import FloatArray, Part, denoised
from pcg.errors import InputError
from pcg.grid import Cell
from pcg.level import Level
from pcg.metrics import occluded as level_occluded
from pcg.solver import SolverStatus, goal_crate_of, solve
from pcg.xsb import format_level

FLOOR_MARGIN = 0.05
"""How far the floor and the outer walls reach beyond the border of the grid [m]."""

GOAL_OBJECT = "obj"
GOAL_OBJECT_COLOR = (0.0, 0.0, 1.0)

_logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class ConversionSettings:
    """Sizes of the scene that a level becomes, in metres.

    Attributes:
        preset: Geometry preset, `clear` or `published`.
        cell: Side of a cell.
        wall_height: Height of blocks and outer walls.
        object_size: Side of the cubes that crates become; at most a cell.
        goal_size: Side of the goal square.
        agent_radius: Radius of the agent; None takes that of the preset.
        agent_height: Height of the agent.
    """

    preset: str = CLEAR.name
    cell: float = 0.4
    wall_height: float = 0.4
    object_size: float = 0.2
    goal_size: float = 0.35
    agent_radius: float | None = None
    agent_height: float = 0.2

    def __post_init__(self) -> None:
        preset = preset_named(self.preset)
        for name, value in asdict(self).items():
            if name != "preset" and value is not None and not MIN_LENGTH <= value <= MAX_LENGTH:
                raise InputError(name, f"{value} m must be between {MIN_LENGTH:g} and {MAX_LENGTH:g}")
        if not 2 * preset.block_edge_radius < self.cell:
            raise InputError("cell", f"{self.cell} m must be more than two edge radii of {preset.block_edge_radius}")
        if not 2 * preset.object_edge_radius < self.object_size <= self.cell:
            radius = preset.object_edge_radius
            raise InputError(
                "object_size", f"{self.object_size} m must fit a cell and exceed two edge radii of {radius}"
            )


@dataclass(frozen=True)
class _Choice:
    """The crate that becomes the goal-object: its cell, who chose it, and whether the level is solvable if known."""

    crate: Cell
    by: str
    solvable: bool | None


def convert_level(level: Level, settings: ConversionSettings | None = None) -> Scene:
    """The scene of a level.

    The goal-object is the crate that the level names; or else the crate that the solver brings to the first target in
    reading order; or else, with a logged warning, the first crate.

    Args:
        level: One player, and at least one crate and one target.
        settings: Sizes; by default those of `ConversionSettings()`.

    Raises:
        InputError: the level lacks something, or is too large for a scene file.
    """
    settings = settings or ConversionSettings()
    level.require_playable(level.name or "level")
    if level.is_wall.sum() + len(OUTER_WALL_SIDES) > MAX_BODIES:
        raise InputError(level.name or "level", f"more than {MAX_BODIES} walls, the most that a scene may have")
    choice = _choose_goal_crate(level)
    scene = _scene(level, choice.crate, settings, preset_named(settings.preset))
    return replace(scene, source=_source(level, choice, settings, scene))


def _choose_goal_crate(level: Level) -> _Choice:
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


def _scene(level: Level, goal_crate: Cell, settings: ConversionSettings, preset: Preset) -> Scene:
    grid = _Grid(level.shape, settings.cell)
    others = [cell for cell in level.crates if cell != goal_crate]
    names = [GOAL_OBJECT, *(f"{GOAL_OBJECT}{i}" for i in range(1, len(others) + 1))]
    side = settings.object_size
    cube = Part.box((side, side), preset.object_edge_radius)
    objects = [
        Body(name, np.array([*grid.centre(cell), side / 2]), side, (cube,))
        for name, cell in zip(names, [goal_crate, *others], strict=True)
    ]
    objects[0] = replace(objects[0], color=GOAL_OBJECT_COLOR)
    radius = preset.agent_radius if settings.agent_radius is None else settings.agent_radius
    return Scene(
        name=level.name or "level",
        bounds=grid.border + FLOOR_MARGIN * np.array([[-1.0], [1.0]]),
        tolerance=preset.tolerance,
        agent=Agent(grid.centre(level.player), radius, settings.agent_height),
        walls=(*_outer_walls(grid, settings.wall_height, preset), *_blocks(level, grid, settings.wall_height, preset)),
        objects=tuple(objects),
        goal=Goal(GOAL_OBJECT, grid.centre(level.targets[0]), np.full(2, settings.goal_size)),
        preset=preset.name,
    )


@dataclass(frozen=True)
class _Grid:
    """Where the cells of a level are: rows and columns, and the side of a cell [m]; the middle is the origin."""

    shape: Cell
    cell: float

    @property
    def border(self) -> FloatArray:
        """(2, 2) [m]: lower and upper corner of the grid."""
        rows, columns = self.shape
        return denoised(np.outer([-0.5, 0.5], [columns * self.cell, rows * self.cell]))

    def centre(self, cell: Cell) -> FloatArray:
        """(2,) [m]: the centre of a cell; row 0 has the largest y."""
        (rows, columns), (row, column) = self.shape, cell
        return denoised(np.array([column - (columns - 1) / 2, (rows - 1) / 2 - row]) * self.cell)


def _outer_walls(grid: _Grid, height: float, preset: Preset) -> list[Body]:
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


def _blocks(level: Level, grid: _Grid, height: float, preset: Preset) -> list[Body]:
    rows, columns = level.shape
    part = Part.box((grid.cell, grid.cell), preset.block_edge_radius)
    return [
        Body(
            f"{BLOCK_PREFIX}{column + 1}_{rows - row}",
            np.array([*grid.centre((row, column)), height / 2]),
            height,
            (part,),
        )
        for column in range(columns)
        for row in reversed(range(rows))
        if level.is_wall[row, column]
    ]


def _source(level: Level, choice: _Choice, settings: ConversionSettings, scene: Scene) -> dict[str, Any]:
    return {
        "level": level.name,
        "rows": level.shape[0],
        "columns": level.shape[1],
        "xsb": format_level(replace(level, name="")),
        "goal_crate": list(choice.crate),
        "goal_crate_from": choice.by,
        "solvable": choice.solvable,
        "occluded": {"level": level_occluded(level, choice.crate), "scene": occluded(scene)},
        "settings": {**asdict(settings), "agent_radius": scene.agent.radius},
    }
