"""`manipuzzle render`: pictures of levels, scenes and plans."""

from collections.abc import Callable, Sequence
from pathlib import Path

from converter.animate_plan import plan_frames
from converter.image_file import write_gif, write_png
from converter.plan import Plan, read_plan
from converter.render_level import draw_level
from converter.render_plan import draw_plan
from converter.render_scene import draw_scene
from converter.scene import Scene
from evaluate.inputs import (
    is_plan,
    is_scene,
    read_playable_levels,
    read_scene_file,
    require_choice,
    require_writable,
)
from evaluate.names import require_distinct, safe_name
from evaluate.output import print_json, print_line, print_table, progress
from pcg.errors import InputError
from pcg.level import Level
from planner.verify import require_same_scene

FORMATS = ("png", "gif")
FPS = 20

Painter = Callable[[Path], None]
"""Writes one picture to a path."""


def level_painter(level: Level) -> Painter:
    """Draws a level as PNG."""
    return lambda path: write_png(path, draw_level(level))


def scene_painter(scene: Scene) -> Painter:
    """Draws a scene as PNG."""
    return lambda path: write_png(path, draw_scene(scene))


def plan_painter(scene: Scene, plan: Plan, format_: str) -> Painter:
    """Draws a plan as PNG, or animates it as GIF."""
    if format_ == "gif":
        return lambda path: write_gif(path, plan_frames(scene, plan, fps=FPS), FPS)
    return lambda path: write_png(path, draw_plan(scene, plan))


def run(inputs: Sequence[Path], out: Path, format_: str, scene_path: Path | None, *, as_json: bool) -> bool:
    """Runs the command; see `evaluate.cli.render`."""
    require_choice("--format", format_, FORMATS)
    given = None if scene_path is None else read_scene_file(scene_path)
    jobs = [job for path in inputs for job in _jobs(path, format_, given)]
    require_distinct([name for name, _ in jobs], "inputs")
    require_writable(out)
    results = []
    with progress() as bar:
        for name, paint in bar.track(jobs, description="pictures"):
            file = out / f"{name}.{format_}"
            paint(file)
            results.append((name, str(file)))
    if as_json:
        print_json({"pictures": [{"name": name, "file": file} for name, file in results]})
    else:
        print_table(["name", "file"], results)
        print_line(f"{len(results)} pictures written to {out}")
    return True


def _jobs(path: Path, format_: str, given: Scene | None) -> list[tuple[str, Painter]]:
    """The pictures of an input: their names, and functions that paint them; reading is done, painting is not."""
    if is_plan(path):
        plan = read_plan(path)
        return [(safe_name(path.stem), plan_painter(_scene_of(path, plan, given), plan, format_))]
    if format_ == "gif":
        raise InputError(str(path), "gif shows plans in motion; draw levels and scenes as png")
    if is_scene(path):
        scene = read_scene_file(path)
        return [(safe_name(scene.name), scene_painter(scene))]
    return [(safe_name(level.name), level_painter(level)) for level in read_playable_levels(path)]


def _scene_of(path: Path, plan: Plan, given: Scene | None) -> Scene:
    if given is not None:
        require_same_scene(given, plan, str(path))
        return given
    if plan.scene_data is None:
        raise InputError(str(path), "the file holds no scene; name the scene's file by --scene")
    return plan.scene_data
