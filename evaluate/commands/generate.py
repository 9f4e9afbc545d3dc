"""`manipuzzle generate`: solvable levels as a level set."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any

from evaluate.inputs import require_writable
from evaluate.output import print_json, print_line, print_table, progress
from pcg.agents import agent_named
from pcg.errors import InputError
from pcg.frozen import read_frozen
from pcg.generate import RANDOM_AGENT, generated_levels
from pcg.level_set import GeneratedLevel, manifest_entry, write_level_set
from pcg.policy_source import source_of
from pcg.random_source import RandomSource
from pcg.request import LevelSource, Request

Band = tuple[float | None, float | None]
"""Ends of a band; None for the default's."""


def request_of(
    agent: str,
    frozen: Path | None = None,
    pushes: Band = (None, None),
    wall_density: Band = (None, None),
    **others: Any,
) -> Request:
    """What the options ask for: the request of the agent, changed where an option is given.

    Args:
        agent: Name of the agent, or `random`.
        frozen: File with frozen tiles, which decide on rows and columns.
        pushes: Band of the pushes.
        wall_density: Band of the wall density.
        others: Further fields of the request; None for the agent's.

    Raises:
        InputError: there is no such agent, the options contradict each other, or the file of frozen tiles is no such.
    """
    request = Request() if agent == RANDOM_AGENT else agent_named(agent).request
    given = {name: value for name, value in others.items() if value is not None}
    given["pushes"] = _filled(pushes, request.pushes)
    given["wall_density"] = _filled(wall_density, request.wall_density)
    if frozen is not None:
        tiles = read_frozen(frozen)
        given = {**given, "frozen": tiles, "rows": tiles.shape[0], "columns": tiles.shape[1]}
    try:
        return replace(request, **given)
    except ValueError as error:
        raise InputError("options", str(error)) from None


def _filled(band: Band, default: tuple[float, float]) -> tuple[float, ...]:
    return tuple(end if given is None else given for given, end in zip(band, default, strict=True))


def source_named(agent: str) -> LevelSource:
    """The source of an agent's levels.

    Raises:
        InputError: there is no such agent, or its policy cannot be read.
    """
    return RandomSource() if agent == RANDOM_AGENT else source_of(agent_named(agent))


def generate(count: int, seed: int, request: Request, folder: Path, agent: str = RANDOM_AGENT) -> list[GeneratedLevel]:
    """Generates levels and writes the level set; interrupted, it writes those that it has.

    Raises:
        InputError: the generator finds no more levels, or the folder cannot be written.
    """
    levels: list[GeneratedLevel] = []
    stream = islice(generated_levels(source_named(agent), request, seed, agent), count)
    try:
        with progress() as bar:
            # What was appended before an interrupt stays in the list.
            levels.extend(bar.track(stream, total=count, description="levels"))
    finally:
        if levels:
            write_level_set(folder, levels)
    return levels


def run(agent: str, count: int, seed: int, request: Request, out: Path, *, as_json: bool) -> bool:
    """Runs the command; see `evaluate.cli.generate`."""
    require_writable(out)
    levels = generate(count, seed, request, out, agent)
    entries = [manifest_entry(level) for level in levels]
    if as_json:
        names = ("name", "solvable", "pushes", "moves", "occluded", "dependency", "goal_crate")
        rows = [{name: entry.model_dump()[name] for name in names} for entry in entries]
        print_json({"agent": agent, "levels": rows, **_effort(levels), "out": str(out)})
    else:
        rows_of_table = [(e.name, e.pushes, e.moves, e.statistics.walls, e.occluded, e.dependency) for e in entries]
        print_table(["level", "pushes", "moves", "walls", "occluded", "dependency"], rows_of_table)
        effort = _effort(levels)
        reasons = ", ".join(f"{n} {reason}" for reason, n in effort["rejected"].items()) or "none"
        print_line(f"{len(levels)} levels written to {out}; attempts: {effort['attempts']}, thrown away: {reasons}")
    return True


def _effort(levels: Sequence[GeneratedLevel]) -> dict[str, Any]:
    """What the levels cost: failures are counted, repairs too, of which there are none."""
    rejected: Counter[str] = Counter()
    for level in levels:
        rejected.update(level.rejected)
    return {
        "attempts": len(levels) + rejected.total(),
        "rejected": dict(rejected),
        "repaired": 0,
        "steps": sum(level.steps for level in levels),
    }
