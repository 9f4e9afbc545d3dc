"""Folders of studies, written row by row without any planning."""

import json
import zlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from converter.plan import Plan, plan_document
from converter.scene import Scene
from evaluate.store import TrialStore
from evaluate.study_record import StudyRecord
from evaluate.trial_row import TrialRow


@dataclass(frozen=True)
class Run:
    """One trial of a made-up study; without a time it is not solved."""

    scene: str
    method: str
    seed: int
    time_s: float | None
    pick_places: int = 2
    subgoal_time_s: float = 0.0
    accepted: int | None = None
    settings: str = ""


MakeStudy = Callable[[Iterable[Run]], Path]


@pytest.fixture
def make_study(tmp_path: Path, small_room: Scene, small_plan: Plan) -> MakeStudy:
    """Writes runs into a study's folder; all scenes have the geometry of `small_room`, moved apart by their names."""

    def make(runs: Iterable[Run]) -> Path:
        runs, folder = list(runs), tmp_path / "study"
        names = list(dict.fromkeys(run.scene for run in runs))
        scenes = {name: replace(small_room, name=name, tolerance=1e-3 * (1 + i)) for i, name in enumerate(names)}
        methods = dict.fromkeys((run.method, run.method + run.settings) for run in runs)
        with TrialStore(folder) as store:
            store.add_scenes(scenes.values())
            for run in runs:
                store.add(_row(run, scenes[run.scene], small_plan))
            store.set_study(
                StudyRecord(
                    "A study",
                    tuple((scene.name, scene.geometry_hash) for scene in scenes.values()),
                    tuple(methods),
                    tuple(sorted({run.seed for run in runs})),
                    len(runs),
                )
            )
        return folder

    return make


def _row(run: Run, scene: Scene, plan: Plan) -> TrialRow:
    solved = run.time_s is not None
    document = plan_document(replace(plan, scene=scene.name, scene_hash=scene.geometry_hash, method=run.method))
    counters = {"subgoal_time_s": run.subgoal_time_s}
    return TrialRow(
        key=f"{run.scene}/{run.method}/{run.seed}/{run.settings}",
        scene=run.scene,
        scene_hash=scene.geometry_hash,
        method=run.method,
        seed=run.seed,
        settings=json.dumps({"time_limit": 10.0, "preset": "fast", "name": run.settings}),
        settings_hash=run.method + run.settings,
        status="solved" if solved else "timeout",
        verified=True if solved else None,
        time_s=10.0 if run.time_s is None else run.time_s,
        path_length_m=3.0 + run.seed if solved else None,
        pick_places=run.pick_places if solved else None,
        counters=json.dumps(counters if run.accepted is None else {**counters, "accepted": run.accepted}),
        message=None,
        plan=zlib.compress(json.dumps(document).encode()) if solved else None,
        versions='{"manipuzzle": "0"}',
        machine="a machine",
        started="2026-01-01T10:00:00.000+00:00",
        finished="2026-01-01T11:00:00.000+00:00",
    )


@pytest.fixture
def make_run() -> type[Run]:
    """What `make_study` takes."""
    return Run


@pytest.fixture
def two_methods(make_study: MakeStudy) -> Path:
    """Scene `wall`: A solves both runs, Btl one of two; `corner`: A solves none, Btl both; `open`: only A is run."""
    return make_study(
        [
            Run("wall", "A", 0, 1.0),
            Run("wall", "A", 1, 3.0, pick_places=1),
            Run("wall", "Btl", 0, 4.0, subgoal_time_s=3.0),
            Run("wall", "Btl", 1, None),
            Run("corner", "A", 0, None, accepted=1),
            Run("corner", "A", 1, None, accepted=0),
            Run("corner", "Btl", 0, 0.5, subgoal_time_s=0.25),
            Run("corner", "Btl", 1, 0.7, subgoal_time_s=0.25),
            Run("open", "A", 0, 0.1),
        ]
    )
