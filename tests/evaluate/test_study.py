"""Studies."""

import itertools
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from converter.scene import Scene
from evaluate.method import Method, method_named
from evaluate.store import TrialStore
from evaluate.study import Study, StudySummary, run_study
from evaluate.trial_frame import read_trials
from evaluate.trial_row import TrialRow
from evaluate.workers import run_tasks
from planner import Settings

Runner = Callable[..., StudySummary]
OWN = (method_named("Rnd+FPR", Settings()),)


@pytest.fixture
def study(small_room: Scene) -> Study:
    """One scene, one method, five seeds."""
    return Study("test", (small_room,), OWN, tuple(range(5)))


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Runner]:
    """Runs a study with a stand-in for the planner, always in the same folder."""
    # Worker processes import the stand-ins from where this process would.
    monkeypatch.syspath_prepend(Path(__file__).parent)

    def runner(study: Study, planner: str, seconds: float = 2.0, **options: object) -> StudySummary:
        import stub_planners  # noqa: PLC0415  # found only now

        job = stub_planners.job(getattr(stub_planners, planner), seconds)
        with TrialStore(tmp_path / "out") as store:
            return run_study(study, store, partial(run_tasks, workers=1), job=job, **options)

    yield runner
    sys.modules.pop("stub_planners", None)


def rows_in(folder: Path) -> list[TrialRow]:
    """All rows of a finished study."""
    with TrialStore(folder) as store:
        return list(store.rows())


def test_every_trial_has_one_row_whatever_happens(study: Study, run: Runner, tmp_path: Path):
    """Overruns, crashes, exceptions and clean failures are rows; the rest of the study is not touched."""
    summary = run(study, "troubled", seconds=1.5)
    assert (summary.trials, summary.run, summary.skipped, summary.solved) == (5, 5, 0, 1)
    found = {row.seed: (row.status, row.verified, row.message) for row in rows_in(tmp_path / "out")}
    assert found == {
        0: ("timeout", None, "stopped at the hard limit of 1.5 s"),
        1: ("error", None, "the worker process ended with exit status 3"),
        2: ("error", None, "RuntimeError: a bug of two lines"),
        3: ("exhausted", None, None),
        4: ("solved", True, None),
    }


def test_finished_trials_are_not_repeated(study: Study, run: Runner):
    """A second run only counts; a grown study runs what is new; the summary covers all."""
    run(study, "quick")
    again = run(study, "forbidden")
    assert (again.run, again.skipped, again.solved) == (0, 5, 5)
    grown = run(replace(study, seeds=tuple(range(7))), "quick")
    assert (grown.run, grown.skipped, grown.solved) == (2, 5, 7)


def test_other_settings_are_other_trials(study: Study, run: Runner, small_room: Scene, tmp_path: Path):
    """Changed settings or geometry run anew, and tables show only what belongs to the study."""
    run(study, "quick")
    for changed in (
        replace(study, methods=(Method("Rnd+FPR", Settings(candidates=50)),)),
        replace(study, scenes=(replace(small_room, tolerance=0.0),)),
    ):
        summary = run(changed, "quick")
        assert (summary.run, summary.skipped, summary.solved) == (5, 0, 5)
    assert run(study, "forbidden").solved == 5
    assert len(rows_in(tmp_path / "out")) == 15
    assert read_trials(tmp_path / "out")["scene"].to_list() == ["small-room"] * 5


def test_an_interrupt_keeps_finished_rows(study: Study, run: Runner, tmp_path: Path):
    """What was finished before Ctrl-C stays, and the next run continues there."""
    seen = []

    def interrupt(row: TrialRow | None) -> None:
        seen.append(row)
        if len(seen) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(study, "quick", on_trial=interrupt)
    assert len(rows_in(tmp_path / "out")) == 2
    summary = run(study, "quick")
    assert (summary.run, summary.skipped) == (3, 2)


def test_large_studies_are_not_listed(small_room: Scene):
    """The first trials of a hundred million are there at once: one seed over all methods, then the next."""
    methods = (*OWN, method_named("Rnd+R", Settings()))
    study = Study("big", (small_room,), methods, range(50_000_000))
    first = [(trial.seed, trial.method.name) for trial in itertools.islice(study.trials(), 3)]
    assert first == [(0, "Rnd+FPR"), (0, "Rnd+R"), (1, "Rnd+FPR")]
    assert study.size == 100_000_000


def test_scenes_in_two_geometries_are_told_apart(study: Study, small_room: Scene):
    """A name that occurs once per preset is shown with it; other names stay as they are."""
    published = replace(small_room, preset="published")
    both = replace(study, scenes=(published, replace(small_room, preset="clear"), replace(published, name="one")))
    labels = [both.label(scene.name, scene.preset) for scene in both.scenes]
    assert labels == ["small-room (published)", "small-room (clear)", "one"]


def test_methods_that_do_not_suit_a_scene_are_left_out(study: Study):
    """Without a demonstration there are no trials of Hum, and without a level none of Push."""
    methods = (*OWN, *(method_named(name, Settings()) for name in ("Hum+R", "Push")))
    assert {trial.method.name for trial in replace(study, methods=methods).trials()} == {"Rnd+FPR"}
    assert replace(study, methods=methods).size == 5


def test_limits_are_those_of_the_method(study: Study):
    """A trial may take its own method's time and time for improvement, twice, and at least a second."""
    methods = (Method("a", Settings(time_limit=10, improve=5)), Method("b", Settings(time_limit=0.1)))
    limits = [study.limit_of(trial) for trial in itertools.islice(replace(study, methods=methods).trials(), 2)]
    assert limits == [30.0, 1.0]


def test_the_folder_says_what_the_study_is(study: Study, run: Runner, tmp_path: Path):
    """Scenes and parts of the study are stored beside its trials."""
    run(study, "quick")
    with TrialStore(tmp_path / "out") as store:
        record = store.study()
        assert record is not None
        assert record == study.record()
        assert [scene.geometry_hash for scene in store.scenes()] == [study.scenes[0].geometry_hash]
        assert sum(record.includes(row) for row in store.rows()) == record.trials == 5
