"""Studies: every scene with every method and seed, resumable. `evaluate.specification` says how they are written down."""

import contextlib
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

from converter.scene import Scene
from evaluate.method import Method
from evaluate.record import failed_row, run_recorded
from evaluate.store import TrialStore
from evaluate.study_record import StudyRecord
from evaluate.trial import Trial, prepare
from evaluate.trial_row import TrialRow
from evaluate.workers import Execute, Job

SHORTEST_HARD_LIMIT = 1.0
"""The hard limit is at least this [s], so that a small time limit leaves time to verify."""


@dataclass(frozen=True, eq=False)
class Study:
    """What to run.

    Attributes:
        name: Title of the tables.
        scenes: No two agree in name and preset.
        methods: With different names.
        seeds: Each >= 0.
        hard_limit: A trial is killed after this many times its time limit and its time for improvement together.
        memory_mb: Memory for the data of a worker [MiB]; None for no limit.
        notes: What a person should know before it starts: scenes that are missing.
    """

    name: str
    scenes: tuple[Scene, ...]
    methods: tuple[Method, ...]
    seeds: Sequence[int]
    hard_limit: float = 2.0
    memory_mb: int | None = None
    notes: tuple[str, ...] = ()

    @cached_property
    def pairs(self) -> tuple[tuple[Scene, Method], ...]:
        """Every scene with every method that suits it."""
        return tuple(
            (scene, method)
            for scene in self.scenes
            for method in self.methods
            if method.planner.suits(scene, method.settings)
        )

    @property
    def size(self) -> int:
        """Number of trials."""
        return len(self.pairs) * len(self.seeds)

    def trials(self) -> Iterator[Trial]:
        """Every trial; all scenes with the first seed come first, so an unfinished study is a smaller one."""
        for seed in self.seeds:
            for scene, method in self.pairs:
                yield Trial(scene, method, seed)

    def limit_of(self, trial: Trial) -> float:
        """Wall time after which a trial is killed [s]."""
        settings = trial.method.settings
        return max(SHORTEST_HARD_LIMIT, self.hard_limit * (settings.time_limit + settings.improve))

    def record(self) -> StudyRecord:
        """What the study consists of, for its folder."""
        return StudyRecord(
            name=self.name,
            scenes=tuple((scene.name, scene.geometry_hash) for scene in self.scenes),
            methods=tuple((method.name, method.hash) for method in self.methods),
            seeds=tuple(self.seeds),
            trials=self.size,
        )

    def label(self, name: str, preset: str | None) -> str:
        """The name of a scene in tables: with the preset where the study has several scenes of that name."""
        return f"{name} ({preset})" if self._repeated[name] > 1 else name

    @cached_property
    def _repeated(self) -> Counter[str]:
        return Counter(scene.name for scene in self.scenes)

    def job(self) -> Job[Trial, TrialRow]:
        """What workers have to do."""
        return Job(run_recorded, failed_row, self.limit_of, self.memory_mb, partial(prepare, self.methods))


@dataclass(frozen=True)
class StudySummary:
    """What a study found.

    Attributes:
        trials: Trials of the study.
        run: Trials that this call ran.
        skipped: Trials that had been run before.
        solved: Trials with a verified plan, those of earlier calls included.
    """

    trials: int
    run: int
    skipped: int
    solved: int


def run_study(
    study: Study,
    store: TrialStore,
    execute: Execute,
    *,
    job: Job[Trial, TrialRow] | None = None,
    on_trial: Callable[[TrialRow | None], None] = lambda _: None,
) -> StudySummary:
    """Runs the trials that `store` lacks.

    Args:
        study: What to run.
        store: Gets one row per trial.
        execute: Where: `partial(run_tasks, workers=2)` for processes of this machine.
        job: What workers do; by default that of the study.
        on_trial: Told about every trial: its row, or None if it had been run before.

    Raises:
        InputError: the store cannot be written.
        WorkerStartError: the workers do not start.
    """
    store.add_scenes(study.scenes)
    record = study.record()
    store.set_study(record)
    skipped = finished = 0

    def remaining() -> Iterator[Trial]:
        nonlocal skipped
        for trial in study.trials():
            if trial.key in store:
                skipped += 1
                on_trial(None)
            else:
                yield trial

    # Closing stops the workers even if the interrupt arrives while a row is being written.
    with contextlib.closing(execute(job or study.job(), remaining())) as rows:
        for _, row in rows:
            store.add(row)
            finished += 1
            on_trial(row)
    solved = sum(row.verified is True for row in store.rows(plans=False) if record.includes(row))
    return StudySummary(study.size, finished, skipped, solved)
