"""`manipuzzle export`: plans as tables over time, or as PDDL."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from converter.formats.pddl import DOMAIN, plan_text, problem_text
from converter.formats.plan_tables import write_csv, write_npz
from converter.plan import Plan
from converter.scene import Scene
from converter.trajectory import SpeedProfile, TimedPlan
from evaluate.commands.options import PLANS_HELP, Json, Out, SceneOfPlans, application
from evaluate.inputs import read_scene_file, require_choice, require_writable
from evaluate.names import require_distinct, safe_name
from evaluate.output import counted, print_json, print_line, print_table, progress
from evaluate.plan_source import read_plans
from pcg.files import write_text

app = application()

FORMATS = ("csv", "npz", "pddl")

Writer = Callable[[Path, str, Scene, Plan], list[Path]]
"""Writes a plan into a folder under a name and returns its files."""


@app.command()
def run(
    plans: Annotated[list[Path], typer.Argument(metavar="PLAN", help=PLANS_HELP)],
    *,
    out: Out,
    to: Annotated[str, typer.Option(metavar="NAME", help="csv, npz (NumPy) or pddl.")] = "csv",
    speed: Annotated[float, typer.Option(metavar="M/S", help="Full speed of the agent.")] = 0.5,
    acceleration: Annotated[
        float, typer.Option(metavar="M/S2", min=0, help="Between way-points; 0 for constant speed without stops.")
    ] = 1.0,
    grasp_time: Annotated[float, typer.Option(metavar="SECONDS", help="Rest at each grasp and each release.")] = 0.0,
    step: Annotated[float, typer.Option(metavar="SECONDS", help="Time between rows; way-points are rows too.")] = 0.02,
    scene: SceneOfPlans = None,
    json: Json = False,
) -> bool:
    """Export plans to DIR/{name}.csv or .npz, or as PDDL to {name}-domain.pddl, {name}-problem.pddl and {name}.plan.

    Example:  manipuzzle export out/plans/*.json --to npz --speed 0.5 --step 0.02 --out out/trajectories
    """
    profile = profile_of(speed, acceleration, grasp_time)
    require_choice("--to", to, FORMATS)
    given = None if scene is None else read_scene_file(scene)
    found = list(read_plans(plans))
    of_scenes = [(each.scene(given), each.plan) for each in found]
    names = [safe_name(each.name) for each in found]
    require_distinct(names, "plans", [each.where for each in found])
    require_writable(out)
    write = write_pddl if to == "pddl" else table_writer(to, profile, step)
    results: list[tuple[str, list[Path]]] = []
    with progress() as bar:
        for name, (of_plan, plan) in zip(names, bar.track(of_scenes, description="plans"), strict=True):
            results.append((name, write(out, name, of_plan, plan)))
    if json:
        print_json({"plans": [{"plan": name, "files": [str(file) for file in files]} for name, files in results]})
    else:
        print_table(["plan", "file"], [(name, str(file)) for name, files in results for file in files])
        print_line(f"{counted(len(results), 'plan')} exported to {out}")
    return True


def profile_of(speed: float, acceleration: float, grasp_time: float) -> SpeedProfile:
    """The profile of the command's options; acceleration 0 stands for constant speed.

    Raises:
        InputError: a value is not allowed.
    """
    return SpeedProfile(speed, acceleration if acceleration != 0 else math.inf, grasp_time)


def table_writer(to: str, profile: SpeedProfile, step: float) -> Writer:
    """Writes `{name}.csv` or `{name}.npz`."""
    write = {"csv": write_csv, "npz": write_npz}[to]

    def write_table(folder: Path, name: str, scene: Scene, plan: Plan) -> list[Path]:
        file = folder / f"{name}.{to}"
        write(file, TimedPlan(scene, plan, profile).rows(step))
        return [file]

    return write_table


def write_pddl(folder: Path, name: str, scene: Scene, plan: Plan) -> list[Path]:
    """Writes `{name}-domain.pddl`, `{name}-problem.pddl` and `{name}.plan`."""
    texts = {
        f"{name}-domain.pddl": DOMAIN,
        f"{name}-problem.pddl": problem_text(scene),
        f"{name}.plan": plan_text(scene, plan),
    }
    files = []
    for file_name, text in texts.items():
        write_text(folder / file_name, text)
        files.append(folder / file_name)
    return files
