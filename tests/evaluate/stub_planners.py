"""Stand-ins for the planner that worker processes can import: quick, and troublesome on demand."""

import os
import signal
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from evaluate.record import failed_row
from evaluate.trial import Trial
from evaluate.trial_row import TrialRow
from evaluate.workers import Failure, Job

TIMES_OUT, CRASHES, RAISES, UNSOLVED = range(4)
HAS_ITS_PARENT_KILLED = 5
"""Seeds with which there is trouble."""


def job(run: Callable[[Trial], TrialRow], seconds: float = 2.0) -> Job[Trial, TrialRow]:
    """What workers do with a stand-in for the planner."""
    return Job(run, failed_row, lambda _: seconds)


def quick(trial: Trial) -> TrialRow:
    """Solves anything in a millisecond."""
    row = failed_row(trial, Failure("error", "stands in", 0.001))
    return replace(row, status="solved", verified=True, message=None, path_length_m=1.0, pick_places=1)


def troubled(trial: Trial) -> TrialRow:
    """Overruns, crashes, raises or fails, depending on the seed; solves the rest."""
    if trial.seed == TIMES_OUT:
        time.sleep(600)
    if trial.seed == CRASHES:
        os._exit(3)
    if trial.seed == RAISES:
        raise RuntimeError("a bug\nof two lines")
    row = quick(trial)
    return replace(row, status="exhausted", verified=None) if trial.seed == UNSOLVED else row


def troubled_once(folder: str, trial: Trial) -> TrialRow:
    """As `troubled`, but first seed 5 has its parent killed: on a cluster that is the Dask worker."""
    killed = Path(folder, "killed")
    if trial.seed == HAS_ITS_PARENT_KILLED and not killed.exists():
        killed.touch()
        os.kill(os.getppid(), signal.SIGKILL)
        time.sleep(600)
    return troubled(trial)


def forbidden(trial: Trial) -> TrialRow:
    """Must not be called."""
    raise AssertionError(f"{trial.scene.name} was run again")
