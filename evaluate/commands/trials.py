"""`manipuzzle trials`: the trials of a results folder, their plans as files, and their plans verified anew."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from converter.plan import write_plan
from evaluate.commands.options import Json, application
from evaluate.inputs import require_writable
from evaluate.output import counted, log, print_json, print_line, print_table
from evaluate.plan_source import plan_name
from evaluate.record import plan_of
from evaluate.store import StoredTrials
from evaluate.trial_row import TrialRow
from pcg.errors import InputError
from planner.verify import verify

app = application()


@dataclass(frozen=True)
class Choice:
    """Which trials; None chooses all.

    Attributes:
        key: Beginning of their keys.
        scene: Name of their scene.
        method: Name of their method.
        seed: Their seed.
        status: How they ended.
    """

    key: str | None = None
    scene: str | None = None
    method: str | None = None
    seed: int | None = None
    status: str | None = None

    def includes(self, row: TrialRow) -> bool:
        """Whether a trial is among them."""
        wanted = (self.scene, self.method, self.seed, self.status)
        found = (row.scene, row.method, row.seed, row.status)
        fits = all(want is None or want == has for want, has in zip(wanted, found, strict=True))
        return fits and row.key.startswith(self.key or "")


@app.command()
def run(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Results of a study.")],
    *,
    trial: Annotated[
        str | None, typer.Option(metavar="KEY", help="Beginning of a trial's key.", show_default=False)
    ] = None,
    scene: Annotated[str | None, typer.Option(metavar="NAME", help="Of this scene only.", show_default=False)] = None,
    method: Annotated[str | None, typer.Option(metavar="NAME", help="Of this method only.", show_default=False)] = None,
    seed: Annotated[
        int | None, typer.Option(metavar="N", min=0, help="With this seed only.", show_default=False)
    ] = None,
    status: Annotated[
        str | None, typer.Option(metavar="NAME", help="That ended so: solved, timeout, ...", show_default=False)
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Write the plans into this folder.", show_default=False)
    ] = None,
    verify: Annotated[bool, typer.Option("--verify", help="Verify the plans anew.")] = False,
    json: Json = False,
) -> bool:
    """List the trials of a study; with --out write their plans, scene included.

    verify, render and export also take a trial as DIR#KEY, with the beginning of its key.

    Exit status 1 if --verify finds a plan that is not valid.

    Example:  manipuzzle trials out/study --scene corner --seed 0 --out out/plans
    """
    choice = Choice(key=trial, scene=scene, method=method, seed=seed, status=status)
    with StoredTrials(folder) as store:
        if out is not None:
            require_writable(out)
        plans = verify or out is not None
        found = [_reported(row, out, verified=verify) for row in _chosen(store, choice, plans=plans)]
    if not found:
        raise InputError(str(folder), "holds no such trial")
    if json:
        print_json({"trials": found})
    else:
        columns = ["trial", "scene", "preset", "method", "seed", "status", "time [s]", "verified", "message", "plan"]
        print_table(columns, ([trial[_FIELDS[column]] for column in columns] for trial in found))
        print_line(f"{counted(len(found), 'trial')}, {sum(trial['verified'] is True for trial in found)} solved")
    return not any(trial["verified"] is False for trial in found) if verify else True


_FIELDS = {"time [s]": "time_s"} | {
    name: name for name in ("trial", "scene", "preset", "method", "seed", "status", "verified", "message", "plan")
}


def _chosen(store: StoredTrials, choice: Choice, *, plans: bool) -> Iterator[TrialRow]:
    rows = store.rows(plans=plans) if choice.key is None else iter(store.find(choice.key))
    return (row for row in rows if choice.includes(row))


def _reported(row: TrialRow, out: Path | None, *, verified: bool) -> dict[str, Any]:
    """What is printed about a trial; its plan is written and verified as wanted."""
    file, valid, message = None, row.verified, row.message
    if row.plan is not None and (out is not None or verified):
        plan = plan_of(row)
        assert plan is not None  # noqa: S101  # the row has one
        if verified and plan.scene_data is not None:
            violations = verify(plan.scene_data, plan)
            valid, message = not violations, violations[0].message if violations else None
            if valid != row.verified:
                log(f"{row.key}: the verdict was {row.verified}, now it is {valid}")
        if out is not None:
            file = out / f"{plan_name(row)}.json"
            write_plan(file, plan)
    return {
        "trial": row.key,
        "scene": row.scene,
        "preset": row.preset,
        "method": row.method,
        "seed": row.seed,
        "status": row.status,
        "time_s": row.time_s,
        "verified": valid,
        "message": message,
        "plan": None if file is None else str(file),
    }
