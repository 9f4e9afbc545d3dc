"""`manipuzzle generate`: solvable levels as a level set."""

from collections import Counter
from itertools import islice
from pathlib import Path

from evaluate.inputs import require_choice, require_writable
from evaluate.output import print_json, print_line, print_table, progress
from pcg.errors import InputError
from pcg.generate import GeneratorSettings, random_levels
from pcg.level_set import GeneratedLevel, manifest_entry, write_level_set

AGENTS = ("random",)


def settings_of(**values: int) -> GeneratorSettings:
    """The settings of the command's options.

    Raises:
        InputError: they contradict each other.
    """
    try:
        return GeneratorSettings(**values)  # type: ignore[arg-type]  # the options are all integers
    except ValueError as error:
        raise InputError("options", str(error)) from None


def generate(count: int, seed: int, settings: GeneratorSettings, folder: Path) -> list[GeneratedLevel]:
    """Generates levels and writes the level set; interrupted, it writes those that it has.

    Raises:
        InputError: the generator finds no more levels, or the folder cannot be written.
    """
    levels: list[GeneratedLevel] = []
    try:
        with progress() as bar:
            # What was appended before an interrupt stays in the list.
            levels.extend(bar.track(islice(random_levels(seed, settings), count), total=count, description="levels"))
    finally:
        if levels:
            write_level_set(folder, levels)
    return levels


def run(agent: str, count: int, seed: int, settings: GeneratorSettings, out: Path, *, as_json: bool) -> bool:
    """Runs the command; see `evaluate.cli.generate`."""
    require_choice("--agent", agent, AGENTS)
    require_writable(out)
    levels = generate(count, seed, settings, out)
    entries = [manifest_entry(level) for level in levels]
    if as_json:
        rejected: Counter[str] = Counter()
        for level in levels:
            rejected.update(level.rejected)
        names = ("name", "solvable", "pushes", "moves", "occluded", "goal_crate")
        rows = [{name: entry.model_dump()[name] for name in names} for entry in entries]
        print_json({"levels": rows, "rejected": dict(rejected), "out": str(out)})
    else:
        rows_of_table = [(e.name, e.pushes, e.moves, e.statistics.walls, e.occluded) for e in entries]
        print_table(["level", "pushes", "moves", "walls", "occluded"], rows_of_table)
        print_line(f"{len(levels)} levels written to {out}")
    return True
