"""What running a study costs beside its trials: time per trial, memory, and what a second worker brings.

Trials are stood in for: they do nothing, or burn CPU time, and give a row of ordinary size.
"""

import resource
import statistics
import tempfile
import time
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from evaluate.method import method_named
from evaluate.record import failed_row, run_recorded
from evaluate.store import TrialStore
from evaluate.study import Study, run_study
from evaluate.trial import Trial, warm_up_scene
from evaluate.trial_row import TrialRow
from evaluate.workers import Job, run_tasks
from planner import METHODS, Settings

TRIAL_S = 0.2
"""CPU time of a trial when workers are compared [s]."""

SCENES = 1000
"""Scenes of the study in which the coordinator's cost is measured."""


@dataclass(frozen=True)
class StudyBench:
    """What was measured.

    Attributes:
        trials: Trials that did nothing, in one study with one worker.
        trial_s: Wall time of one of them, the worker's start included [s].
        coordinator_s: CPU time that the coordinator spent on one of them [s].
        memory_mb: The most memory that the coordinator had, all of Python included [MiB].
        speedups: Time with one worker by that with two, of each run, on trials of `TRIAL_S`.
    """

    trials: int
    trial_s: float
    coordinator_s: float
    memory_mb: float
    speedups: tuple[float, ...]

    @property
    def speedup(self) -> float | None:
        """Median of the speed-ups; None without runs."""
        return statistics.median(self.speedups) if self.speedups else None


def measure_study(trials: int, burning: int, runs: int) -> StudyBench:
    """Runs a study of `trials` trials that do nothing, and `runs` times one of `burning` trials with one and two workers."""
    row = run_recorded(Trial(warm_up_scene(), method_named("Rnd+R", Settings()), 0))
    study, cpu = study_of(trials), time.process_time()
    wall = run_stand_in(study, partial(done, row), workers=1)
    coordinator = time.process_time() - cpu
    memory_kb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    slow, burn = study_of(burning), partial(done, row, cpu_s=TRIAL_S)
    speedups = tuple(run_stand_in(slow, burn, workers=1) / run_stand_in(slow, burn, workers=2) for _ in range(runs))
    return StudyBench(study.size, wall / study.size, coordinator / study.size, memory_kb / 1024, speedups)


def study_of(trials: int) -> Study:
    """A study of about that many trials: copies of a small scene, several methods, as many seeds as it takes."""
    names = METHODS[:5]
    methods = tuple(method_named(name, Settings()) for name in names)
    scenes = tuple(replace(warm_up_scene(), name=f"scene-{i}") for i in range(min(SCENES, max(1, trials // 5))))
    return Study("bench", scenes, methods, range(max(1, trials // (len(scenes) * len(methods)))))


def run_stand_in(study: Study, function: "partial[TrialRow]", workers: int) -> float:
    """Runs a study with a stand-in for its trials in a folder that is then deleted; its wall time [s]."""
    started = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder, TrialStore(Path(folder)) as store:
        job: Job[Trial, TrialRow] = Job(function, failed_row, study.limit_of)
        run_study(study, store, partial(run_tasks, workers=workers), job=job)
        return time.perf_counter() - started


def done(row: TrialRow, trial: Trial, cpu_s: float = 0.0) -> TrialRow:
    """Burns CPU time and describes the trial by another one's row."""
    end = time.process_time() + cpu_s
    while time.process_time() < end:
        pass
    method, scene = trial.method, trial.scene
    return replace(row, key=trial.key, scene=scene.name, method=method.name, seed=trial.seed, settings_hash=method.hash)
