"""Trials as rows of the store, whatever became of them."""

import functools
import importlib.metadata
import json
import platform
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

from converter.plan import Plan, Status, plan_document, plan_from_document
from evaluate.packed import packed, unpacked
from evaluate.trial import Trial, TrialOutcome
from evaluate.trial_row import TrialRow
from evaluate.workers import Failure

LIBRARIES = ("manipuzzle", "numpy", "numba", "casadi", "ompl", "shapely")
"""What a plan may depend on besides Python."""


def run_recorded(trial: Trial) -> TrialRow:
    """Runs a trial and describes it; the function that study workers call."""
    started = datetime.now(UTC)
    outcome = trial.run()
    plan = outcome.plan
    row = replace(
        _row(trial, plan.status, started, datetime.now(UTC), plan.time_s),
        counters=json.dumps(dict(plan.counters)),
        message=_message(outcome),
    )
    if not plan.solved:
        return row
    return replace(
        row,
        verified=outcome.verified,
        path_length_m=plan.path_length,
        pick_places=plan.pick_places,
        plan=packed(plan_document(plan)),
    )


def failed_row(trial: Trial, failure: Failure) -> TrialRow:
    """The row of a trial that was stopped, crashed or raised."""
    finished = datetime.now(UTC)
    started = finished - timedelta(seconds=failure.time_s)
    return replace(_row(trial, Status(failure.kind), started, finished, failure.time_s), message=failure.message)


def plan_of(row: TrialRow) -> Plan | None:
    """The plan that a row holds; None without one.

    Raises:
        InputError: the stored plan is damaged.
    """
    if row.plan is None:
        return None
    where = f"{row.scene}-{row.method}-{row.seed}"
    return plan_from_document(unpacked(row.plan, where), where)


def _row(trial: Trial, status: Status, started: datetime, finished: datetime, time_s: float) -> TrialRow:
    """The row of a trial without a plan."""
    return TrialRow(
        key=trial.key,
        scene=trial.scene.name,
        scene_hash=trial.scene.geometry_hash,
        method=trial.method.name,
        seed=trial.seed,
        settings=json.dumps(trial.method.document, sort_keys=True),
        settings_hash=trial.method.hash,
        status=status.value,
        verified=None,
        time_s=time_s,
        path_length_m=None,
        pick_places=None,
        counters="{}",
        message=None,
        plan=None,
        versions=_versions(),
        machine=_machine(),
        started=started.isoformat(timespec="milliseconds"),
        finished=finished.isoformat(timespec="milliseconds"),
        preset=trial.scene.preset,
    )


def _message(outcome: TrialOutcome) -> str | None:
    return outcome.violations[0].message if outcome.violations else outcome.plan.certificate


@functools.cache
def _versions() -> str:
    found = {"python": platform.python_version()}
    for library in LIBRARIES:
        try:
            found[library] = importlib.metadata.version(library)
        except importlib.metadata.PackageNotFoundError:
            continue
    return json.dumps(found)


@functools.cache
def _machine() -> str:
    return f"{_processor()}, {platform.system()} {platform.machine()}"


def _processor() -> str:
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.is_file():
        for line in cpuinfo.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or "unknown processor"
