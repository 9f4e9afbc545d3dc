"""`manipuzzle convert`: levels and scenes to scene files."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from converter.convert import ConversionSettings, convert_level
from converter.formats import write_scene
from converter.preset import CLEAR, PRESETS
from converter.scene import Scene
from evaluate.inputs import (
    adapted,
    is_scene,
    read_playable_levels,
    read_scene_file,
    require_choice,
    require_writable,
)
from evaluate.names import require_distinct, safe_name
from evaluate.output import print_json, print_line, print_table, progress
from pcg.level import Level

FORMATS = {"yaml": ".yaml", "mjcf": ".xml"}
"""Suffix of the files of each format."""


def scene_of(level: Level, preset: str | None = None, tolerance: float | None = None) -> Scene:
    """The scene of a level, called as its file will be.

    Args:
        level: A playable level.
        preset: Geometry preset, `clear` by default.
        tolerance: Penetration that counts as touching [m]; None takes the preset's.

    Raises:
        InputError: the level cannot be converted.
    """
    scene = convert_level(level, ConversionSettings(preset=preset or CLEAR.name))
    return adapted(replace(scene, name=safe_name(level.name)), None, tolerance)


def run(
    inputs: Sequence[Path], out: Path, *, to: str, preset: str | None, tolerance: float | None, as_json: bool
) -> bool:
    """Runs the command; see `evaluate.cli.convert`."""
    require_choice("--to", to, list(FORMATS))
    if preset is not None:
        require_choice("--preset", preset, list(PRESETS))
    jobs = [job for path in inputs for job in _jobs(path, preset, tolerance)]
    require_distinct([name for name, _ in jobs], "inputs")
    require_writable(out)
    results = []
    with progress() as bar:
        for name, scene in bar.track(jobs, description="scenes"):
            file = out / f"{name}{FORMATS[to]}"
            write_scene(file, scene())
            results.append((name, str(file)))
    if as_json:
        print_json({"scenes": [{"scene": name, "file": file} for name, file in results]})
    else:
        print_table(["scene", "file"], results)
        print_line(f"{len(results)} scenes written to {out}")
    return True


def _jobs(path: Path, preset: str | None, tolerance: float | None) -> list[tuple[str, Callable[[], Scene]]]:
    """The scenes to be written: their names, and functions that make them; reading is done, conversion is not."""
    if is_scene(path):
        scene = read_scene_file(path, preset, tolerance)
        return [(safe_name(scene.name), lambda: scene)]
    return [
        (safe_name(level.name), partial(scene_of, level, preset, tolerance)) for level in read_playable_levels(path)
    ]
