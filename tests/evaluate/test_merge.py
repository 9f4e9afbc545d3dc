"""Merging results folders, and comparing two of them."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from converter.scene import Scene
from evaluate.compare import compare, same_plan, without_times
from evaluate.merge import Merged, merge
from evaluate.method import Method
from evaluate.record import run_recorded
from evaluate.store import StoredTrials, TrialStore
from evaluate.study import Study, run_study
from evaluate.trial import Trial
from evaluate.trial_row import TrialRow
from pcg.errors import InputError
from planner import Settings

Run = Callable[..., Path]


@pytest.fixture
def row(small_room: Scene) -> TrialRow:
    """The row of a solved trial."""
    return run_recorded(Trial(small_room, Method("Rnd+R", Settings(method="Rnd+R")), 0))


@pytest.fixture
def run(tmp_path: Path, small_room: Scene, row: TrialRow) -> Run:
    """Makes the folder of a study in which every trial has the same outcome but for some changes."""

    def runner(folder: str, seeds: range, settings: Settings | None = None, **changes: object) -> Path:
        study = Study(folder, (small_room,), (Method("Rnd+R", settings or Settings(method="Rnd+R")),), seeds)

        def done(trial: Trial) -> TrialRow:
            hash_ = trial.method.hash
            return replace(row, key=trial.key, seed=trial.seed, settings_hash=hash_, **changes)

        with TrialStore(tmp_path / folder) as store:
            run_study(study, store, lambda _, tasks: ((task, done(task)) for task in tasks))
        return tmp_path / folder

    return runner


def test_folders_are_united(run: Run, tmp_path: Path):
    """Trials that both hold are taken once, from the first; scenes, seeds and names of both are kept."""
    first, second = run("first", range(3), time_s=1.0), run("second", range(2, 5), time_s=2.0)
    with TrialStore(tmp_path / "all") as target:
        assert merge([first, second], target) == Merged(added=5, repeated=1)
        assert merge([first, second], target) == Merged(added=0, repeated=6)
        assert {row.seed: row.time_s for row in target.rows()} == {0: 1.0, 1: 1.0, 2: 1.0, 3: 2.0, 4: 2.0}
        assert len(list(target.scenes())) == 1
        record = target.study()
        assert record is not None
        assert (record.name, record.seeds, record.trials) == ("first + second", (0, 1, 2, 3, 4), 5)
        assert all(record.includes(row) for row in target.rows())


def test_one_name_stands_for_one_method(run: Run, tmp_path: Path):
    """Folders in which a name has different settings are not united: no table could tell them apart."""
    first = run("first", range(2))
    second = run("second", range(2), settings=Settings(method="Rnd+R", candidates=3))
    with TrialStore(tmp_path / "all") as target:
        with pytest.raises(InputError, match=r"merge: the settings of method 'Rnd\+R' differ"):
            merge([first, second], target)
        assert len(target) == 0


def test_folders_are_compared_by_scene_method_and_seed(run: Run):
    """Verdicts, plans and times of what both hold are counted, whatever the settings; the rest is counted too."""
    first = run("first", range(4), time_s=1.0)
    second = run("second", range(1, 6), settings=Settings(method="Rnd+R", candidates=3), time_s=3.0)
    with StoredTrials(first) as one, StoredTrials(second) as other:
        found = compare(one, other)
    assert (found.first_alone, found.second_alone, found.agree) == (1, 2, True)
    counts = found.methods["Rnd+R"]
    assert (counts.both, counts.solved, counts.only_first, counts.only_second) == (3, [3, 3], 0, 0)
    assert (counts.same_plans, counts.time_ratio) == (3, 3.0)


def test_different_verdicts_are_counted(run: Run):
    """Where only one solved a trial the folders disagree, and their plans differ."""
    first, second = run("first", range(2)), run("second", range(2), verified=None, plan=None, status="timeout")
    with StoredTrials(first) as one, StoredTrials(second) as other:
        found = compare(one, other)
        swapped = compare(other, one)
    counts = found.methods["Rnd+R"]
    assert (counts.only_first, counts.only_second, counts.same_plans, counts.time_ratio) == (2, 0, 0, None)
    assert swapped.methods["Rnd+R"].only_second == 2
    assert not found.agree
    assert not swapped.agree


def test_times_are_no_difference(row: TrialRow, small_room: Scene):
    """A second run of a trial differs in times only, also inside the plan; one with another seed in more."""
    again, other = (run_recorded(Trial(small_room, Method("Rnd+R", Settings(method="Rnd+R")), seed)) for seed in (0, 1))
    assert again.plan != row.plan
    assert without_times(again) == without_times(row)
    assert same_plan(again, row)
    assert not same_plan(other, row)
