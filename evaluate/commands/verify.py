"""`manipuzzle verify`: plans against their scenes."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from evaluate.commands.options import PLANS_HELP, Json, Preset, Tolerance, application
from evaluate.inputs import adapted, is_scene, read_scene_file
from evaluate.output import counted, print_json, print_line, print_table, progress
from evaluate.plan_source import NamedPlan, read_plans
from pcg.errors import InputError
from planner.verify import Violation, require_same_scene, verify

app = application()


@app.command()
def run(
    inputs: Annotated[
        list[Path],
        typer.Argument(
            metavar="[SCENE] PLAN", help=f"{PLANS_HELP} Before them the scene, if it is not to be the one in the file."
        ),
    ],
    *,
    preset: Preset = None,
    tolerance: Tolerance = None,
    json: Json = False,
) -> bool:
    """Check plans independently of the planner and list every violation. Exit status 1 if there is one.

    Without SCENE each plan is checked in the scene that its file holds.

    Example:  manipuzzle verify data/puzzles/cube-free.yaml out/plans/cube-free-Rnd+FPR-0.json

    Example:  manipuzzle verify out/plans
    """
    scene = inputs[0] if is_scene(inputs[0]) else None
    plans = inputs[scene is not None :]
    if not plans:
        raise InputError(str(scene), "a scene; name a plan behind it")
    given = None if scene is None else read_scene_file(scene, preset, tolerance)
    verdicts = []
    with progress() as bar:
        for plan in bar.track(list(read_plans(plans)), description="plans"):
            setting = given or adapted(plan.scene(None, "before the plan"), preset, tolerance)
            require_same_scene(setting, plan.plan, plan.where)
            verdicts.append(Verdict(plan, tuple(verify(setting, plan.plan))))
    if json:
        print_json(_document(verdicts))
    else:
        _print(verdicts)
    return all(verdict.valid for verdict in verdicts)


@dataclass(frozen=True, eq=False)
class Verdict:
    """A plan and what is wrong with it."""

    plan: NamedPlan
    violations: tuple[Violation, ...]

    @property
    def valid(self) -> bool:
        """Whether nothing is wrong."""
        return not self.violations

    def document(self) -> dict[str, Any]:
        """Plain values."""
        return {"valid": self.valid, "violations": [asdict(violation) for violation in self.violations]}


def _document(verdicts: Sequence[Verdict]) -> dict[str, Any]:
    """Of one plan its verdict, of several all of them."""
    if len(verdicts) == 1:
        return verdicts[0].document()
    plans = [{"plan": verdict.plan.where, **verdict.document()} for verdict in verdicts]
    return {"valid": all(verdict.valid for verdict in verdicts), "plans": plans}


def _print(verdicts: Sequence[Verdict]) -> None:
    for verdict in verdicts:
        if verdict.valid:
            print_line(f"{verdict.plan.where}: valid")
            continue
        columns = ["violation", "segment", "x [m]", "y [m]", "amount [m]", "message"]
        rows = [(v.kind.value, v.segment, *(v.where or (None, None)), v.amount, v.message) for v in verdict.violations]
        print_table(columns, rows)
        print_line(f"{verdict.plan.where}: not valid, {counted(len(verdict.violations), 'violation')}")
    if len(verdicts) > 1:
        print_line(f"{sum(verdict.valid for verdict in verdicts)} of {counted(len(verdicts), 'plan')} valid")
