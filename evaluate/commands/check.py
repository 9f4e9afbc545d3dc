"""`manipuzzle check`: scenes in the physics preview."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from converter.image_file import write_png
from converter.plan import Plan
from converter.preview.picture import report_drawing, summary
from converter.preview.report import SceneReport
from converter.raster import paint
from converter.scene import Scene
from evaluate.commands.options import Json, Preset, SceneFiles, Tolerance, Workers, application
from evaluate.inputs import read_scenes, require_writable
from evaluate.names import safe_name
from evaluate.output import counted, print_json, print_line, print_table, progress
from evaluate.parallel import in_order
from evaluate.plan_source import read_plans
from evaluate.scene_check import check
from pcg.errors import InputError
from planner.verify import require_same_scene

app = application()

PICTURE_WIDTH_PX = 600


@dataclass(frozen=True)
class Request:
    """What to find out about every scene.

    Attributes:
        static: Only whether the scene can be set up and begun.
        push: How far to drive against every object from four sides [m]; None for not at all.
        picture: Folder for a picture of each scene; None for no pictures.
    """

    static: bool = False
    push: float | None = None
    picture: Path | None = None


@app.command()
def run(
    scenes: SceneFiles,
    *,
    plan: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="PLAN",
            help="Play a plan of one of the scenes back, or those of a folder; repeat for more.",
            show_default=False,
        ),
    ] = None,
    push: Annotated[
        float | None,
        typer.Option(
            metavar="METRES",
            min=0,
            max=100,
            help="Also drive this far against every object, from four sides.",
            show_default=False,
        ),
    ] = None,
    static: Annotated[bool, typer.Option("--static", help="Only check the scenes at rest.")] = False,
    picture: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Draw what was found to DIR/{scene}.png.", show_default=False)
    ] = None,
    preset: Preset = None,
    tolerance: Tolerance = None,
    workers: Workers = 1,
    json: Json = False,
) -> bool:
    """Check scenes in a 2D physics preview: at rest, driving to every object and into the goal, playing plans back.

    At rest nothing may overlap or move. A disc that is told how fast to go then follows the exact planner's shortest
    way to each object and into the goal; contacts and what it pushes are reported. In a plan that is played back nothing
    but the carried object may move by more than a millimetre.

    Exit status 1 if a scene is not valid, the disc does not arrive at the end of its way, or a plan does not play back.
    That no way leads to an object is reported but no flaw, for others may have to be carried away first.

    Example:  manipuzzle check out/scenes --picture out/checks --workers 2
    """
    request = Request(static=static, push=push, picture=picture)
    found = list(read_scenes(scenes, preset, tolerance).values())
    tasks = list(zip(found, _plans_of(found, plan or []), strict=True))
    if picture is not None:
        require_writable(picture)
    with progress() as bar:
        results = in_order(partial(_checked, request), tasks, workers)
        reports = list(bar.track(results, total=len(tasks), description="scenes"))
    if json:
        print_json({"scenes": [report.document() for report in reports]})
    else:
        print_table(["scene", "all well", "found"], [(r.scene, r.all_well, summary(r)) for r in reports])
        print_line(f"{sum(report.valid for report in reports)} of {counted(len(reports), 'scene')} valid")
    return all(report.all_well for report in reports)


def _checked(request: Request, task: tuple[Scene, Plan | None]) -> SceneReport:
    scene, plan = task
    report = check(scene, plan, drives=not request.static, push_distance=request.push)
    if request.picture is not None:
        image = paint(report_drawing(scene, report), PICTURE_WIDTH_PX)
        write_png(request.picture / f"{safe_name(scene.name)}.png", image)
    return report


def _plans_of(scenes: Sequence[Scene], paths: Sequence[Path]) -> list[Plan | None]:
    """The plan of each scene, if there is one.

    Raises:
        InputError: a plan belongs to none of the scenes, or two belong to one.
    """
    found: dict[str, Plan] = {}
    hashes = {scene.geometry_hash for scene in scenes}
    for named in read_plans(paths):
        plan, where = named.plan, named.where
        if plan.scene_hash not in hashes:
            if len(scenes) == 1:
                require_same_scene(scenes[0], plan, where)
            raise InputError(where, f"plan of a scene that is not given: {plan.scene!r} ({plan.scene_hash})")
        if plan.scene_hash in found:
            raise InputError(where, f"a second plan for {plan.scene!r}; check one at a time")
        if not plan.solved:
            raise InputError(where, f"no plan to play back: its status is {plan.status}")
        found[plan.scene_hash] = plan
    return [found.get(scene.geometry_hash) for scene in scenes]
