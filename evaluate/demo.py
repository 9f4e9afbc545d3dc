"""The whole pipeline on a few levels and on the nine puzzles: `python -m evaluate.demo --out out`."""

import argparse
from pathlib import Path

from converter.formats import write_scene
from converter.preview import check_scene
from converter.scene import Scene
from evaluate.commands.convert import scene_of
from evaluate.commands.generate import generate
from evaluate.commands.render import level_painter, plan_painter, scene_painter
from evaluate.commands.solve import solve_to_file
from evaluate.inputs import read_scenes, require_writable
from evaluate.output import print_line, print_table
from evaluate.trial import warm_up
from pcg.generate import GeneratorSettings
from pcg.level_set import manifest_entry
from planner import Settings, settings_for

LEVELS = 12
SEED = 0
TIME_LIMIT = 10.0
"""For each scene [s]."""

PUZZLES = Path(__file__).parent.parent / "data" / "puzzles"
"""Scene files that come with the source tree."""

RESULT_COLUMNS = ["valid", "status", "time [s]", "path [m]", "pick-places", "verified"]


def main() -> None:
    """Runs the demo."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("out"), help="folder for the results (default: out)")
    out = parser.parse_args().out
    require_writable(out)
    settings = settings_for("fast", time_limit=TIME_LIMIT)
    warm_up(settings)
    _levels(out, settings)
    _puzzles(out, settings)
    print_line(f"scenes, plans and pictures are in {out}/")


def _levels(out: Path, settings: Settings) -> None:
    rows = []
    for generated in generate(LEVELS, SEED, GeneratorSettings(), out / "levels"):
        level, entry = generated.level, manifest_entry(generated)
        level_painter(level)(out / "levels" / f"{level.name}.png")
        scene = scene_of(level)
        write_scene(out / "scenes" / f"{scene.name}.yaml", scene)
        rows.append((level.name, entry.pushes, entry.occluded, *_solved(scene, settings, out)))
    print_table(["level", "pushes", "occluded", *RESULT_COLUMNS], rows, title="Generated levels")


def _puzzles(out: Path, settings: Settings) -> None:
    scenes = read_scenes(sorted(PUZZLES.glob("*.yaml")))
    rows = [(scene.name, *_solved(scene, settings, out)) for scene in scenes]
    print_table(["puzzle", *RESULT_COLUMNS], rows, title=f"Puzzles, {TIME_LIMIT:g} s each")


def _solved(scene: Scene, settings: Settings, out: Path) -> tuple[object, ...]:
    """Checks, solves, verifies and draws a scene; the values of `RESULT_COLUMNS`."""
    scene_painter(scene)(out / "scenes" / f"{scene.name}.png")
    outcome, result = solve_to_file(scene, settings, SEED, out / "plans")
    if result.plan is not None:
        plan_painter(scene, outcome.plan, "png")(Path(result.plan).with_suffix(".png"))
        plan_painter(scene, outcome.plan, "gif")(Path(result.plan).with_suffix(".gif"))
    valid = check_scene(scene).valid
    return valid, result.status, result.time_s, result.path_length_m, result.pick_places, result.verified


if __name__ == "__main__":
    main()
