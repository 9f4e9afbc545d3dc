"""`manipuzzle verify`: a plan against its scene."""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from converter.plan import read_plan
from evaluate.commands.options import Json, Preset, SceneFile, Tolerance, application
from evaluate.inputs import read_scene_file
from evaluate.output import print_json, print_line, print_table
from planner.verify import require_same_scene, verify

app = application()


@app.command()
def run(
    scene: SceneFile,
    plan: Annotated[Path, typer.Argument(metavar="PLAN", help="Plan file (.json).")],
    *,
    preset: Preset = None,
    tolerance: Tolerance = None,
    json: Json = False,
) -> bool:
    """Check a plan independently of the planner and list every violation. Exit status 1 if there is one.

    Example:  manipuzzle verify data/puzzles/cube-free.yaml out/plans/cube-free-Rnd+FPR-0.json
    """
    setting, checked = read_scene_file(scene, preset, tolerance), read_plan(plan)
    require_same_scene(setting, checked, str(plan))
    violations = verify(setting, checked)
    if json:
        print_json({"valid": not violations, "violations": [asdict(violation) for violation in violations]})
    elif violations:
        columns = ["violation", "segment", "x [m]", "y [m]", "amount [m]", "message"]
        rows = [(v.kind.value, v.segment, *(v.where or (None, None)), v.amount, v.message) for v in violations]
        print_table(columns, rows)
        print_line(f"{plan}: not valid, {len(violations)} violations")
    else:
        print_line(f"{plan}: valid")
    return not violations
