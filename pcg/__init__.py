"""Grid levels of Sokoban-like puzzles: files, rules, an exact solver, measures, symmetries and generation.

A `Level` is a grid of tiles; `read_level_set` and `read_levels` read them, `solve` finds a solution with the least
number of pushes, `random_levels` makes new ones and `write_level_set` keeps them with a manifest. Importing this package
needs NumPy and Pydantic only.
"""

from pcg.errors import InputError
from pcg.generate import GeneratorSettings, Rejection, generate_random, random_levels
from pcg.level import Level, Tile
from pcg.level_set import (
    GeneratedLevel,
    LevelSet,
    ManifestEntry,
    read_level_set,
    read_manifest,
    write_level_set,
)
from pcg.metrics import LevelStatistics, occluded, statistics
from pcg.report import LevelReport, LevelsSummary, report_levels, summarise
from pcg.sokoban import IllegalMoveError, apply_moves, is_solved
from pcg.solver import Solution, SolverStatus, goal_crate_of, solve
from pcg.symmetry import canonical, content_hash, symmetries, tiles_hash
from pcg.xsb import format_level, parse_levels, read_levels, write_levels

__all__ = [
    "GeneratedLevel",
    "GeneratorSettings",
    "IllegalMoveError",
    "InputError",
    "Level",
    "LevelReport",
    "LevelSet",
    "LevelStatistics",
    "LevelsSummary",
    "ManifestEntry",
    "Rejection",
    "Solution",
    "SolverStatus",
    "Tile",
    "apply_moves",
    "canonical",
    "content_hash",
    "format_level",
    "generate_random",
    "goal_crate_of",
    "is_solved",
    "occluded",
    "parse_levels",
    "random_levels",
    "read_level_set",
    "read_levels",
    "read_manifest",
    "report_levels",
    "solve",
    "statistics",
    "summarise",
    "symmetries",
    "tiles_hash",
    "write_level_set",
    "write_levels",
]
