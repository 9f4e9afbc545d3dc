"""The database of a study."""

import sqlite3
from dataclasses import replace
from pathlib import Path

import pytest

from converter.scene import Scene
from evaluate.method import method_named
from evaluate.record import failed_row, plan_of, run_recorded
from evaluate.store import FILE_NAME, StoredTrials, TrialStore
from evaluate.study_record import StudyRecord
from evaluate.trial import Trial
from evaluate.trial_row import TrialRow
from evaluate.workers import Failure
from pcg.errors import InputError
from planner import Settings


@pytest.fixture
def trial(small_room: Scene) -> Trial:
    """A trial that is easy to solve."""
    return Trial(small_room, method_named("Rnd+FPR", Settings()), 0)


@pytest.fixture
def row(trial: Trial) -> TrialRow:
    """The row of a trial that was stopped."""
    return failed_row(trial, Failure("timeout", "stopped", 2.5))


def test_rows_come_back_as_they_were(tmp_path: Path, trial: Trial, row: TrialRow):
    """Every field survives, those without a value and the compressed plan included."""
    solved = run_recorded(trial)
    rows = [row, replace(solved, key="a"), replace(solved, key="b", verified=False)]
    with TrialStore(tmp_path) as store:
        for each in rows:
            store.add(each)
    with TrialStore(tmp_path) as store:
        assert list(store.rows()) == rows
        assert row.key in store
        assert "c" not in store
        assert len(store) == 3
        assert store.find("a") == [rows[1]]
        assert [each.plan for each in store.rows(plans=False)] == [None, None, None]


def test_a_solved_trial_is_recorded_completely(trial: Trial):
    """The row holds plan, cost, counters, versions and times; the plan is the one that was verified."""
    row = run_recorded(trial)
    plan = plan_of(row)
    assert (row.status, row.verified) == ("solved", True)
    assert plan is not None
    assert (plan.path_length, plan.pick_places) == (row.path_length_m, row.pick_places)
    assert plan.scene_hash == row.scene_hash
    assert row.started <= row.finished
    assert '"manipuzzle"' in row.versions


def test_a_failure_is_a_row_too(trial: Trial, row: TrialRow):
    """A trial that was stopped has no plan, but says what happened and when."""
    assert (row.key, row.status, row.verified, row.time_s, row.message) == (trial.key, "timeout", None, 2.5, "stopped")
    assert plan_of(row) is None
    assert row.started < row.finished


def test_one_writer_at_a_time(tmp_path: Path):
    """A second study in the same folder is refused while the first runs, and allowed afterwards."""
    with TrialStore(tmp_path), pytest.raises(InputError, match="another study is running"):
        TrialStore(tmp_path)
    with TrialStore(tmp_path):
        pass


def test_readers_see_finished_rows_meanwhile(tmp_path: Path, row: TrialRow):
    """A row can be read by others as soon as it is added."""
    with TrialStore(tmp_path) as store, StoredTrials(tmp_path) as reader:
        assert list(reader.rows()) == []
        store.add(row)
        assert list(reader.rows()) == [row]


def test_folders_that_may_only_be_read(tmp_path: Path, row: TrialRow, monkeypatch: pytest.MonkeyPatch):
    """Somebody else's results are read without a file being made beside them; a log that is there is read too."""
    with TrialStore(tmp_path) as store:
        store.add(row)
        # Whoever runs this test may be allowed everything.
        monkeypatch.setattr("os.access", lambda _path, _mode: False)
        with StoredTrials(tmp_path) as reader:
            assert list(reader.rows()) == [row]
    before = sorted(tmp_path.iterdir())
    with StoredTrials(tmp_path) as reader:
        assert list(reader.rows()) == [row]
        assert sorted(tmp_path.iterdir()) == before


def test_readers_need_a_study(tmp_path: Path):
    """A folder without a database is refused, and stays as it was."""
    with pytest.raises(InputError, match=r"no study: there is no file trials\.sqlite"):
        StoredTrials(tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_scenes_and_study_are_stored(tmp_path: Path, small_room: Scene, row: TrialRow):
    """Scenes come back with name and geometry, each once; the study of the last run replaces the one before."""
    other = replace(small_room, name="other", tolerance=0.0)
    study = StudyRecord("first", (("small-room", row.scene_hash),), (("Rnd+FPR", row.settings_hash),), (0, 3), 2)
    with TrialStore(tmp_path) as store:
        assert store.study() is None
        store.add_scenes([small_room, other])
        store.add_scenes([small_room])
        store.set_study(replace(study, name="zeroth"))
        store.set_study(study)
    with StoredTrials(tmp_path) as stored:
        found = [(scene.name, scene.geometry_hash) for scene in stored.scenes()]
        assert found == [("small-room", small_room.geometry_hash), ("other", other.geometry_hash)]
        assert stored.study() == study
    assert study.includes(row)
    for changed in ({"seed": 1}, {"scene_hash": "x"}, {"method": "x"}, {"settings_hash": "x"}, {"scene": "x"}):
        assert not study.includes(replace(row, **changed))


def test_files_that_are_no_database(tmp_path: Path):
    """Another file under the name, or the database of another version, is refused in one line."""
    (tmp_path / FILE_NAME).write_text("not a database, but long enough to be taken for one")
    with pytest.raises(InputError, match="not usable as a study's database"):
        TrialStore(tmp_path)
    (tmp_path / FILE_NAME).unlink()
    connection = sqlite3.connect(tmp_path / FILE_NAME)
    connection.execute("PRAGMA user_version = 99")
    connection.close()
    with pytest.raises(InputError, match="a database of version 99, allowed is 2"):
        TrialStore(tmp_path)


def test_folders_that_cannot_be_made(tmp_path: Path):
    """A file where the folder should be is refused."""
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        TrialStore(tmp_path / "file")
