"""`manipuzzle solve`: plans for scenes, verified and written."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from converter.plan import write_plan
from converter.scene import Scene
from evaluate.commands.options import (
    Demonstrations,
    Json,
    Out,
    Preset,
    SceneFiles,
    Seed,
    SettingsName,
    Tolerance,
    application,
)
from evaluate.inputs import read_scenes, require_writable
from evaluate.names import safe_name
from evaluate.output import counted, loading, log, print_json, print_line, print_table, progress
from evaluate.setting_values import assignments, changed
from evaluate.trial import TrialOutcome, require_plannable, run_trial, warm_up
from planner import Settings, settings_for

app = application()


@app.command()
def run(
    scenes: SceneFiles,
    *,
    out: Out,
    method: Annotated[
        str,
        typer.Option(metavar="NAME", help="Rnd+FPR, Rnd+FP, Rnd+FR, Rnd+R, Btl+FPR, Hum+R, MBTS, MBTS-rrt or Push."),
    ] = "Rnd+FPR",
    seed: Seed = 0,
    time_limit: Annotated[float, typer.Option(metavar="SECONDS", max=1e9, help="For each scene.")] = 60.0,
    improve: Annotated[
        float, typer.Option(metavar="SECONDS", min=0, max=1e9, help="Time for improving each plan that is found.")
    ] = 0.0,
    settings: SettingsName = "fast",
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="NAME=VALUE", help="One setting of the planner; repeat for more.", show_default=False
        ),
    ] = None,
    demonstrations: Demonstrations = None,
    preset: Preset = None,
    tolerance: Tolerance = None,
    json: Json = False,
) -> bool:
    """Plan, verify the plan, and write it to DIR/{scene}-{method}-{seed}.json. Exit status 1 if one is not solved.

    Example:  manipuzzle solve data/puzzles/cube-free.yaml --out out/plans
    """
    of_planner = settings_of(
        settings, set_ or [], demonstrations, method=method, time_limit=time_limit, improve=improve
    )
    named = read_scenes(scenes, preset, tolerance)
    for path, scene in named.items():
        require_plannable(scene, of_planner, str(path))
    require_writable(out)
    with loading():
        warm_up(of_planner)
    results: list[SolveResult] = []
    with progress() as bar:
        for scene in bar.track(named.values(), total=len(named), description="scenes"):
            outcome, result = solve_to_file(scene, of_planner, seed, out)
            results.append(result)
            for violation in outcome.violations or ():
                log(f"{scene.name}: {violation.message}")
    if json:
        print_json({"results": [asdict(result) for result in results]})
    else:
        _print(results, out)
    return all(result.verified is True for result in results)


@dataclass(frozen=True)
class SolveResult:
    """One line of the command's output.

    Attributes:
        scene: Name of the scene.
        method: Name of the method.
        seed: Seed of the trial.
        status: How planning ended.
        time_s: Planning time [s].
        plan: The plan's file; None without a plan.
        verified: Whether the plan passed verification; None without a plan.
        path_length_m: Distance that the agent drives [m]; None without a plan.
        pick_places: How often an object is picked and placed; None without a plan.
        certificate: Why there is no plan, if the planner knows.
    """

    scene: str
    method: str
    seed: int
    status: str
    time_s: float
    plan: str | None
    verified: bool | None
    path_length_m: float | None
    pick_places: int | None
    certificate: str | None


def solve_to_file(scene: Scene, settings: Settings, seed: int, folder: Path) -> tuple[TrialOutcome, SolveResult]:
    """Plans, verifies, and writes the plan, if there is one, to `folder`/{scene}-{method}-{seed}.json.

    Raises:
        InputError: the start of the scene is invalid, or the file cannot be written.
    """
    outcome = run_trial(scene, settings, seed)
    plan = outcome.plan
    file = folder / f"{safe_name(scene.name)}-{safe_name(settings.method)}-{seed}.json"
    if plan.solved:
        write_plan(file, plan)
    return outcome, SolveResult(
        scene=scene.name,
        method=settings.method,
        seed=seed,
        status=plan.status.value,
        time_s=plan.time_s,
        plan=str(file) if plan.solved else None,
        verified=outcome.verified,
        path_length_m=plan.path_length if plan.solved else None,
        pick_places=plan.pick_places if plan.solved else None,
        certificate=plan.certificate,
    )


def settings_of(preset: str, changes: Sequence[str], demonstrations: Path | None, **options: Any) -> Settings:
    """The settings that the options of the command stand for.

    Args:
        preset: Name of a preset of settings.
        changes: Texts like `candidates=50`; they come last.
        demonstrations: Folder of demonstrations; None for those that come with the product.
        options: Settings with an option of their own.

    Raises:
        InputError: a setting does not exist, or a value is not allowed.
    """
    if demonstrations is not None:
        options["demonstrations"] = str(demonstrations)
    return changed(settings_for(preset, **options), assignments(changes, "--set"), "--set")


def _print(results: Sequence[SolveResult], out: Path) -> None:
    """A table that fits into 80 columns, then what all lines have in common."""
    columns = ["scene", "status", "time [s]", "verified", "path [m]", "pick-places"]
    rows = [(r.scene, r.status, r.time_s, r.verified, r.path_length_m, r.pick_places) for r in results]
    print_table(columns, rows)
    for r in results:
        if r.certificate is not None:
            print_line(f"{r.scene} is {r.status}: {r.certificate}")
    solved = f"{sum(r.verified is True for r in results)} of {counted(len(results), 'scene')} solved"
    print_line(f"{solved} by {results[0].method} with seed {results[0].seed}; plans in {out}")
