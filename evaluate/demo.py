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
from evaluate.output import loading, print_line, print_table, progress
from evaluate.picture_files import Picture, Style, draw_to_file, write_pictures
from evaluate.subjects import Subject, level_subject, plan_subject, scene_subject
from evaluate.trial import warm_up
from pcg.data_folder import data_folder
from pcg.errors import InputError
from pcg.level_set import manifest_entry
from pcg.request import Request
from planner import Settings, settings_for

LEVELS = 12
TIME_LIMIT = 30.0
SEED = 0
SHEET = "plans.png"

RESULT_COLUMNS = ["valid", "plan", "time [s]", "path [m]", "pick-places"]


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
    with loading():
        warm_up(settings)
    plans = [*_levels(out, levels, settings), *_puzzles(out, scenes, settings)]
    _draw(out, plans)
    print_line(f"all plans at a glance: {out / SHEET}; pages that play them: {out / 'plans'}/*.html")


def _levels(out: Path, count: int, settings: Settings) -> list[Subject]:
    rows, plans = [], list[Subject]()
    for generated in generate(count, SEED, Request(), out / "levels"):
        level = generated.level
        draw_to_file(level_subject(level), out / "levels" / f"{level.name}.png")
        scene = scene_of(level)
        write_scene(out / "scenes" / f"{scene.name}.yaml", scene)
        result, plan = _solved(scene, settings, out)
        rows.append((level.name, manifest_entry(generated).pushes, *result))
        plans += plan
    print_table(["level", "pushes", *RESULT_COLUMNS], rows, title="Generated levels")
    return plans


def _puzzles(out: Path, scenes: Sequence[Scene], settings: Settings) -> list[Subject]:
    rows, plans = [], list[Subject]()
    with progress() as bar:
        for scene in bar.track(scenes, description="puzzles"):
            result, plan = _solved(scene, settings, out)
            rows.append((scene.name, *result))
            plans += plan
    print_table(["puzzle", *RESULT_COLUMNS], rows, title=f"Puzzles, {settings.time_limit:g} s each")
    return plans


def _solved(scene: Scene, settings: Settings, out: Path) -> tuple[tuple[object, ...], list[Subject]]:
    """Checks, solves and verifies a scene: the values of `RESULT_COLUMNS`, and the plan, if there is one."""
    draw_to_file(scene_subject(scene), out / "scenes" / f"{scene.name}.png")
    outcome, result = solve_to_file(scene, settings, SEED, out / "plans")
    verdict = {None: result.status, True: "verified", False: "refuted"}[result.verified]
    row = check_scene(scene).valid, verdict, result.time_s, result.path_length_m, result.pick_places
    return row, [plan_subject(Path(result.plan).stem, scene, outcome.plan)] if result.plan is not None else []


def _draw(out: Path, plans: Sequence[Subject]) -> None:
    """A picture, an animation and a page of each plan, and a sheet of all."""
    pictures = [
        Picture(out / "plans" / f"{plan.name}.{format_}", (plan,), Style())
        for plan in plans
        for format_ in ("gif", "png", "html")
    ]
    if plans:
        pictures.append(Picture(out / SHEET, tuple(plans), Style(), is_sheet=True))
    with progress() as bar:
        for _ in bar.track(write_pictures(pictures), total=len(pictures), description="pictures"):
            pass


if __name__ == "__main__":
    main()
