"""Level sets: a folder with the levels as XSB text and a manifest of what is known about each.

`manifest.jsonl` holds one JSON object a line, one line a level, in the order of `levels.xsb`; `ManifestEntry` lists its
fields. XSB cannot say which crate has to reach the goal, the manifest can: whoever reads the levels gets it from there.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

from pydantic import Field

from pcg import json_text
from pcg.dependency import has_dependency, movable_critical
from pcg.errors import InputError
from pcg.files import iter_lines, write_text
from pcg.grid import Cell
from pcg.level import Level
from pcg.metrics import LevelStatistics, occluded, statistics
from pcg.solver import Solution, goal_crate_of, solve
from pcg.swept_disc import disc_occluded
from pcg.symmetry import content_hash, tiles_hash
from pcg.validation import Document, validated
from pcg.xsb import iter_levels, write_levels

LEVELS_FILE = "levels.xsb"
MANIFEST_FILE = "manifest.jsonl"

Split = Literal["train", "test"]


@dataclass(frozen=True)
class GeneratedLevel:
    """A level and where it came from.

    Attributes:
        level: Named; with its goal crate.
        solution: The solver's result for it.
        agent: Name of the generator.
        seed: Seed of the run that made it.
        representation: Of a learned agent, how it edits levels (narrow, turtle, wide, flip).
        weights_hash: Of a learned agent, the hash of its weights.
        control_targets: What was asked of the generator for this level, by name.
        rejected: Attempts thrown away before this level was found, by reason.
        steps: Edits of tiles in all of these attempts and in the one that gave the level.
        split: Of a corpus, the part that the level belongs to.
    """

    level: Level
    solution: Solution
    agent: str
    seed: int
    representation: str | None = None
    control_targets: Mapping[str, float] = field(default_factory=dict)
    rejected: Mapping[str, int] = field(default_factory=dict)
    steps: int = 0
    weights_hash: str | None = None
    split: Split | None = None


class ManifestEntry(Document):
    """A line of `manifest.jsonl`.

    Attributes:
        format: Version of the format.
        name: Name of the level in the XSB file.
        agent: Name of the generator.
        seed: Seed of the run that made it.
        representation: Of a learned agent, how it edits levels (narrow, turtle, wide, flip).
        weights_hash: Of a learned agent, the hash of its weights.
        control_targets: What was asked of the generator for this level, by name.
        rejected: Attempts thrown away before this level was found, by reason.
        steps: Edits of tiles in all of these attempts and in the one that gave the level.
        split: Of a corpus, the part that the level belongs to: train or test.
        statistics: What the level holds.
        occluded: Whether a wall or another crate hides the goal crate from the player.
        disc_occluded: Whether they are in the way of a robot that drives straight to the goal crate.
        dependency: Whether another crate has to move before the goal crate can reach its target; null if the solver
            gave up, or the level is not solvable.
        movable_critical: Whether the goal crate reaches its target if the other crates are ignored, and does not if they
            are walls; null if the solver gave up.
        solvable: Whether Sokoban pushes bring the goal crate to its target; null if the solver gave up.
        solvable_by_any: Whether they do if any crate may go to the target; null likewise.
        pushes: Least number of pushes, null without a solution; the next two likewise.
        moves: Length of the solution.
        solution: The solution in LURD notation.
        goal_crate: Row and column of the crate that has to reach the first target, inner cells counted from 0.
        content_hash: Hash of the tiles, the same for all eight symmetries.
        tiles_hash: Hash of the tiles as they are; `goal_crate` holds only for a level with this hash.
    """

    format: Literal[1] = 1
    name: str
    agent: str
    seed: int
    representation: str | None = None
    weights_hash: str | None = None
    control_targets: dict[str, float] = Field(default_factory=dict)
    rejected: dict[str, int] = Field(default_factory=dict)
    steps: int = 0
    split: Split | None = None
    statistics: LevelStatistics
    occluded: bool
    disc_occluded: bool | None = None
    dependency: bool | None = None
    movable_critical: bool | None = None
    solvable: bool | None
    solvable_by_any: bool | None = None
    pushes: int | None = None
    moves: int | None = None
    solution: str | None = None
    goal_crate: tuple[int, int]
    content_hash: str
    tiles_hash: str


def manifest_entry(generated: GeneratedLevel) -> ManifestEntry:
    """What the manifest says about a level."""
    level, solution = generated.level, generated.solution
    goal_crate = goal_crate_of(level, solution)
    level = replace(level, goal_crate=goal_crate)
    return ManifestEntry(
        name=level.name,
        agent=generated.agent,
        seed=generated.seed,
        representation=generated.representation,
        weights_hash=generated.weights_hash,
        control_targets=dict(generated.control_targets),
        rejected=dict(generated.rejected),
        steps=generated.steps,
        split=generated.split,
        statistics=statistics(level),
        occluded=occluded(level, goal_crate),
        disc_occluded=disc_occluded(level, goal_crate),
        dependency=has_dependency(level) if solution.solved else None,
        movable_critical=movable_critical(level),
        solvable=solution.solvable,
        solvable_by_any=solve(replace(level, goal_crate=None)).solvable,
        pushes=solution.pushes,
        moves=solution.moves,
        solution=solution.lurd,
        goal_crate=goal_crate,
        content_hash=content_hash(level),
        tiles_hash=tiles_hash(level),
    )


def write_level_set(folder: Path, levels: Iterable[GeneratedLevel]) -> None:
    """Writes `levels.xsb` and `manifest.jsonl` into `folder`, which is made if it is missing.

    Raises:
        ValueError: there is no level, or two have the same name or none.
        InputError: a file cannot be written.
    """
    levels = list(levels)
    if not levels or not all(generated.level.name for generated in levels):
        raise ValueError("a level set needs at least one level, and every level a name")
    lines = [manifest_entry(generated).model_dump_json() + "\n" for generated in levels]
    write_levels(folder / LEVELS_FILE, (generated.level for generated in levels))
    write_text(folder / MANIFEST_FILE, "".join(lines))


def read_level_set(path: Path) -> list[Level]:
    """The levels of a level set's folder or of an XSB file, with the goal crates that the manifest records.

    A `manifest.jsonl` beside an XSB file counts for those levels that it names and that have not changed since; an
    edited or turned level has no goal crate any more.

    Raises:
        InputError: naming file, line and reason.
    """
    return list(iter_level_set(path))


def iter_level_set(path: Path) -> Iterator[Level]:
    """The levels of `read_level_set` one by one; of the manifest only goal crates and hashes are held.

    Raises:
        InputError: naming file, line and reason, when that line is reached.
    """
    levels_path = path / LEVELS_FILE if path.is_dir() else path
    manifest_path = levels_path.parent / MANIFEST_FILE
    recorded = _recorded_goals(manifest_path) if manifest_path.exists() else {}
    for level in iter_levels(levels_path):
        goal_crate, expected_hash = recorded.get(level.name, (None, None))
        if expected_hash != tiles_hash(level):
            yield level
            continue
        try:
            yield replace(level, goal_crate=goal_crate)
        except ValueError as error:
            raise InputError(str(manifest_path), f"level {level.name!r}: goal_crate: {error}") from None


def read_manifest(path: Path) -> list[ManifestEntry]:
    """Reads the lines of a manifest.

    Raises:
        InputError: naming file, line, field and reason; also if two lines name the same level.
    """
    return list(_entries(path))


def _recorded_goals(path: Path) -> dict[str, tuple[Cell, str]]:
    """Goal crate of each level by name, and the hash of the tiles for which it holds."""
    return {entry.name: (entry.goal_crate, entry.tiles_hash) for entry in _entries(path)}


def _entries(path: Path) -> Iterator[ManifestEntry]:
    names: set[str] = set()
    for number, line in iter_lines(path):
        if not line.strip():
            continue
        where = f"{path}: line {number}"
        entry = validated(ManifestEntry, json_text.parse(line, where), where)
        if entry.name in names:
            raise InputError(where, f"name: a line before names the level {entry.name!r} too")
        names.add(entry.name)
        yield entry
