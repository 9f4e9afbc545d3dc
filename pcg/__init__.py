"""Grid levels of Sokoban-like puzzles: files, rules, an exact solver, measures, symmetries and generation.

A `Level` is a grid of tiles; `read_level_set` and `read_levels` read them, `solve` finds a solution with the least
number of pushes, `random_levels` makes new ones and `write_level_set` keeps them with a manifest. Importing this package
needs NumPy and Pydantic only.
"""

from pathlib import Path

from pcg.compile_cache import forget_stale_code, provide_compile_cache
from pcg.dependency import has_dependency
from pcg.errors import InputError
from pcg.frozen import FrozenTiles, read_frozen
from pcg.generate import generated_levels, random_levels
from pcg.level import Level, Tile
from pcg.level_set import (
    GeneratedLevel,
    ManifestEntry,
    read_level_set,
    read_manifest,
    write_level_set,
)
from pcg.metrics import LevelStatistics, occluded, statistics
from pcg.random_source import RandomSource
from pcg.report import LevelReport, LevelsSummary, report_levels, summarise
from pcg.request import LevelSource, Proposal, Rejection, Request
from pcg.sokoban import IllegalMoveError, apply_moves, is_solved
from pcg.solver import Solution, SolverStatus, goal_crate_of, solve
from pcg.symmetry import canonical, content_hash, symmetries, tiles_hash
from pcg.xsb import format_level, parse_levels, read_levels, write_levels

__all__ = [
    "FrozenTiles",
    "GeneratedLevel",
    "IllegalMoveError",
    "InputError",
    "Level",
    "LevelReport",
    "LevelSource",
    "LevelStatistics",
    "LevelsSummary",
    "ManifestEntry",
    "Proposal",
    "RandomSource",
    "Rejection",
    "Request",
    "Solution",
    "SolverStatus",
    "Tile",
    "apply_moves",
    "canonical",
    "content_hash",
    "format_level",
    "generated_levels",
    "goal_crate_of",
    "has_dependency",
    "is_solved",
    "occluded",
    "parse_levels",
    "random_levels",
    "read_frozen",
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

provide_compile_cache()
forget_stale_code(Path(__file__).parent)
