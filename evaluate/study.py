"""Studies: every scene with every method and seed, resumable, with a table at the end.

The specification is a YAML file:

    name: smoke
    scenes: [../puzzles/cube-free.yaml, ../corpus/*.yaml]
    methods: [Rnd+FPR, Rnd+FP]
    seeds: 10              # 0..9; or a list
    settings: fast         # or faithful
    time_limit: 60         # seconds, as of `solve`
    improve: 0             # seconds for improving each plan, as of `solve`
    hard_limit: 2          # a trial is killed after this many times both
    memory_mb: 4096        # memory of a worker; leave out for no limit

Paths are relative to the specification, and may hold `*`, `?` and `**`.
"""

import contextlib
import glob
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, field_validator

from converter.formats import yaml_text
from converter.scene import Scene
from evaluate.inputs import read_scene_file
from evaluate.names import require_distinct
from evaluate.record import failed_row, run_recorded
from evaluate.store import TrialRow, TrialStore
from evaluate.tables import Cell, Result, by_scene_and_method, markdown
from evaluate.trial import Trial, settings_hash
from evaluate.workers import Failure, Limits, run_tasks
from pcg.errors import InputError
from pcg.files import read_text
from pcg.validation import Document, validated
from planner import METHODS, Settings, settings_for

MAX_SEEDS = 1_000_000
SHORTEST_HARD_LIMIT = 1.0
"""The hard limit is at least this [s], so that a small time limit leaves time to verify."""


class _Spec(Document):
    name: Annotated[str, Field(min_length=1, max_length=100)]
    scenes: Annotated[list[str], Field(min_length=1)]
    methods: Annotated[list[str], Field(min_length=1)]
    seeds: Annotated[list[Annotated[int, Field(ge=0)]], Field(min_length=1, max_length=MAX_SEEDS)]
    settings: Literal["fast", "faithful"] = "fast"
    time_limit: Annotated[float, Field(gt=0)] = 60.0
    improve: Annotated[float, Field(ge=0)] = 0.0
    hard_limit: Annotated[float, Field(ge=1)] = 2.0
    memory_mb: Annotated[int, Field(ge=256)] | None = None

    @field_validator("seeds", mode="before")
    @classmethod
    def _counted(cls, value: Any) -> Any:
        is_count = isinstance(value, int) and not isinstance(value, bool)
        return list(range(min(value, MAX_SEEDS + 1))) if is_count else value

    @field_validator("methods")
    @classmethod
    def _known(cls, methods: list[str]) -> list[str]:
        if unknown := [method for method in methods if method not in METHODS]:
            raise ValueError(f"unknown method {unknown[0]!r}, allowed are {', '.join(METHODS)}")
        return methods

    @field_validator("scenes", "methods", "seeds")
    @classmethod
    def _distinct(cls, values: list[Any]) -> list[Any]:
        if len(set(values)) != len(values):
            raise ValueError("an entry is given twice")
        return values


@dataclass(frozen=True, eq=False)
class Study:
    """What to run.

    Attributes:
        name: Title of the table.
        scenes: With different names.
        methods: Names of methods.
        seeds: Each >= 0.
        settings: Settings that the methods share; the method itself is replaced.
        limits: What one trial may use.
    """

    name: str
    scenes: tuple[Scene, ...]
    methods: tuple[str, ...]
    seeds: Sequence[int]
    settings: Settings
    limits: Limits

    @property
    def size(self) -> int:
        """Number of trials."""
        return len(self.scenes) * len(self.methods) * len(self.seeds)

    @cached_property
    def settings_by_method(self) -> dict[str, Settings]:
        """The settings of each method."""
        return {method: replace(self.settings, method=method) for method in self.methods}

    def trials(self) -> Iterator[Trial]:
        """Every trial; all scenes with the first seed come first, so an unfinished study is a smaller one."""
        for seed in self.seeds:
            for scene in self.scenes:
                for settings in self.settings_by_method.values():
                    yield Trial(scene, settings, seed)

    def includes(self, row: TrialRow) -> bool:
        """Whether a row is one of the trials; a folder may also hold those of other settings or scenes."""
        return (
            self._scene_hashes.get(row.scene) == row.scene_hash
            and self._settings_hashes.get(row.method) == row.settings_hash
            and row.seed in self._seed_set
        )

    @cached_property
    def _scene_hashes(self) -> dict[str, str]:
        return {scene.name: scene.geometry_hash for scene in self.scenes}

    @cached_property
    def _settings_hashes(self) -> dict[str, str]:
        return {method: settings_hash(settings) for method, settings in self.settings_by_method.items()}

    @cached_property
    def _seed_set(self) -> frozenset[int]:
        return frozenset(self.seeds)


@dataclass(frozen=True)
class StudySummary:
    """What a study found.

    Attributes:
        trials: Trials of the study.
        run: Trials that this call ran.
        skipped: Trials that had been run before.
        cells: Results by scene and method, of all trials.
    """

    trials: int
    run: int
    skipped: int
    cells: dict[tuple[str, str], Cell]

    @property
    def solved(self) -> int:
        """Trials with a verified plan, those of earlier calls included."""
        return sum(cell.solved for cell in self.cells.values())


def read_study(path: Path) -> Study:
    """Reads a specification and all of its scenes.

    Raises:
        InputError: naming file, field and reason.
    """
    spec = validated(_Spec, yaml_text.parse(read_text(path), str(path)), str(path))
    paths = [scene for pattern in spec.scenes for scene in _matches(path, pattern)]
    scenes = tuple(read_scene_file(scene) for scene in paths)
    require_distinct([scene.name for scene in scenes], f"{path}: scenes")
    return Study(
        name=spec.name,
        scenes=scenes,
        methods=tuple(spec.methods),
        seeds=tuple(spec.seeds),
        settings=settings_for(spec.settings, time_limit=spec.time_limit, improve=spec.improve),
        limits=Limits(max(SHORTEST_HARD_LIMIT, spec.hard_limit * (spec.time_limit + spec.improve)), spec.memory_mb),
    )


def run_study(
    study: Study,
    store: TrialStore,
    workers: int,
    *,
    run: Callable[[Trial], TrialRow] = run_recorded,
    prepare: Callable[[], object] | None = None,
    on_trial: Callable[[TrialRow | None], None] = lambda _: None,
) -> StudySummary:
    """Runs the trials that `store` lacks and returns the results of all.

    Args:
        study: What to run.
        store: Gets one row per trial.
        workers: Number of processes.
        run: Runs one trial in a worker.
        prepare: Called once in each worker before its first trial.
        on_trial: Told about every trial: its row, or None if it had been run before.

    Raises:
        InputError: the store cannot be written.
        WorkerStartError: the workers do not start.
    """
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
    with contextlib.closing(run_tasks(run, remaining(), workers, study.limits, prepare)) as outcomes:
        for trial, outcome in outcomes:
            row = failed_row(trial, outcome) if isinstance(outcome, Failure) else outcome
            store.add(row)
            finished += 1
            on_trial(row)
    return StudySummary(study.size, finished, skipped, results(study, store))


def results(study: Study, store: TrialStore) -> dict[tuple[str, str], Cell]:
    """The results of the study's trials that `store` holds, by scene and method."""
    return by_scene_and_method(
        Result(row.scene, row.method, row.verified is True, row.time_s) for row in store.rows() if study.includes(row)
    )


def study_table(study: Study, cells: dict[tuple[str, str], Cell]) -> str:
    """The Markdown table of a study."""
    note = (
        f"Planning time [s], mean ± standard deviation over the solved runs of {len(study.seeds)} seeds, and the "
        f"percentage solved where it is below 100. A run is solved if its plan passes the independent verification. "
        f"Settings `{study.settings.preset}`, time limit {study.settings.time_limit:g} s; last row: runs solved, with "
        f"the 95 % Wilson interval."
    )
    return markdown(study.name, note, [scene.name for scene in study.scenes], study.methods, cells)


def _matches(spec: Path, pattern: str) -> list[Path]:
    found = sorted(glob.glob(pattern, root_dir=spec.parent, recursive=True))  # noqa: PTH207  # takes absolute patterns
    if not found:
        raise InputError(str(spec), f"scenes: nothing matches {pattern!r} (relative to {spec.parent})")
    return [spec.parent / path for path in found]
