"""The whole pipeline on a few levels and on the nine puzzles: `python -m evaluate.demo --out out`."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from converter.formats import write_scene
from converter.preview import check_scene
from converter.scene import Scene
from evaluate.commands.convert import scene_of
from evaluate.commands.generate import generate
from evaluate.commands.solve import solve_to_file
from evaluate.inputs import read_scenes, require_writable
from evaluate.output import print_line, print_table
from evaluate.picture_files import draw_to_file
from evaluate.subjects import level_subject, plan_subject, scene_subject
from evaluate.trial import warm_up
from pcg.data_folder import data_folder
from pcg.errors import InputError
from pcg.level_set import manifest_entry
from pcg.request import Request
from planner import Settings, settings_for

LEVELS = 12
TIME_LIMIT = 10.0
SEED = 0

RESULT_COLUMNS = ["valid", "status", "time [s]", "path [m]", "pick-places", "verified"]


def main() -> None:
    """Runs the demo."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("out"), help="folder for the results (default: out)")
    out = parser.parse_args().out
    try:
        run(out, sorted((data_folder() / "puzzles").glob("*.yaml")))
    except InputError as error:
        parser.error(str(error))


def run(out: Path, puzzles: Sequence[Path], levels: int = LEVELS, time_limit: float = TIME_LIMIT) -> None:
    """Runs the pipeline.

    Args:
        out: Folder for the results.
        puzzles: Scene files.
        levels: Number of levels to generate.
        time_limit: For each scene [s].

    Raises:
        InputError: a scene cannot be read, or the folder cannot be written.
    """
    scenes = list(read_scenes(puzzles).values())
    require_writable(out)
    settings = settings_for("fast", time_limit=time_limit)
    warm_up(settings)
    _levels(out, levels, settings)
    _puzzles(out, scenes, settings)
    print_line(f"scenes, plans and pictures are in {out}/")


def _levels(out: Path, count: int, settings: Settings) -> None:
    rows = []
    for generated in generate(count, SEED, Request(), out / "levels"):
        level, entry = generated.level, manifest_entry(generated)
        draw_to_file(level_subject(level), out / "levels" / f"{level.name}.png")
        scene = scene_of(level)
        write_scene(out / "scenes" / f"{scene.name}.yaml", scene)
        rows.append((level.name, entry.pushes, entry.occluded, *_solved(scene, settings, out)))
    print_table(["level", "pushes", "occluded", *RESULT_COLUMNS], rows, title="Generated levels")


def _puzzles(out: Path, scenes: Sequence[Scene], settings: Settings) -> None:
    rows = [(scene.name, *_solved(scene, settings, out)) for scene in scenes]
    print_table(["puzzle", *RESULT_COLUMNS], rows, title=f"Puzzles, {settings.time_limit:g} s each")


def _solved(scene: Scene, settings: Settings, out: Path) -> tuple[object, ...]:
    """Checks, solves, verifies and draws a scene; the values of `RESULT_COLUMNS`."""
    draw_to_file(scene_subject(scene), out / "scenes" / f"{scene.name}.png")
    outcome, result = solve_to_file(scene, settings, SEED, out / "plans")
    if result.plan is not None:
        file = Path(result.plan)
        for suffix in (".png", ".gif", ".html"):
            draw_to_file(plan_subject(file.stem, scene, outcome.plan), file.with_suffix(suffix))
    valid = check_scene(scene).valid
    return valid, result.status, result.time_s, result.path_length_m, result.pick_places, result.verified


if __name__ == "__main__":
    main()
