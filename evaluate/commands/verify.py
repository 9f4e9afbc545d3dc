"""`manipuzzle verify`: a plan against its scene."""

from dataclasses import asdict
from pathlib import Path

from converter.plan import read_plan
from evaluate.inputs import read_scene_file
from evaluate.output import print_json, print_line, print_table
from planner.verify import require_same_scene, verify


def run(scene_path: Path, plan_path: Path, *, preset: str | None, tolerance: float | None, as_json: bool) -> bool:
    """Runs the command; see `evaluate.cli.verify`."""
    scene = read_scene_file(scene_path, preset, tolerance)
    plan = read_plan(plan_path)
    require_same_scene(scene, plan, str(plan_path))
    violations = verify(scene, plan)
    if as_json:
        print_json({"valid": not violations, "violations": [asdict(violation) for violation in violations]})
    elif violations:
        columns = ["violation", "segment", "x [m]", "y [m]", "amount [m]", "message"]
        rows = [(v.kind.value, v.segment, *(v.where or (None, None)), v.amount, v.message) for v in violations]
        print_table(columns, rows)
        print_line(f"{plan_path}: not valid, {len(violations)} violations")
    else:
        print_line(f"{plan_path}: valid")
    return not violations
