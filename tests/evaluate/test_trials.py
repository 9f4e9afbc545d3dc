"""The command lines of results folders: trials, merge, diff."""

import json
import zlib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from converter.plan import read_plan
from converter.scene import Scene
from evaluate.cli import app
from evaluate.method import Method
from evaluate.record import run_recorded
from evaluate.store import TrialStore
from evaluate.study import Study, run_study
from evaluate.trial import Trial
from evaluate.trial_row import TrialRow
from planner import Settings

Run = Callable[..., Result]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Runs the program in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    return lambda *arguments: CliRunner().invoke(app, arguments)


@pytest.fixture
def folder(tmp_path: Path, small_room: Scene) -> Path:
    """A study of two methods with two seeds; the second method's plans are wrong, though they passed."""
    methods = tuple(Method(name, Settings(method="Rnd+R")) for name in ("good", "bad"))
    study = Study("s", (small_room,), methods, range(2))

    def done(trial: Trial) -> TrialRow:
        row = run_recorded(trial)
        return spoilt(row) if trial.method.name == "bad" else row

    with TrialStore(tmp_path / "study") as store:
        run_study(study, store, lambda _, tasks: ((task, done(task)) for task in tasks))
    return tmp_path / "study"


def spoilt(row: TrialRow) -> TrialRow:
    """The row with a plan that forgets its last carry."""
    assert row.plan is not None
    document = json.loads(zlib.decompress(row.plan))
    while document["segments"].pop()["mode"] != "carry":
        pass
    return replace(row, plan=zlib.compress(json.dumps(document).encode()))


def test_trials_are_listed_and_chosen(run: Run, folder: Path):
    """By method, seed, status and beginning of the key."""
    assert folder.is_dir()
    every = json.loads(run("trials", "study", "--json").stdout)["trials"]
    assert [(trial["method"], trial["seed"]) for trial in every] == [("good", 0), ("bad", 0), ("good", 1), ("bad", 1)]
    for options, expected in {
        ("--method", "good", "--seed", "1"): [every[2]],
        ("--trial", every[1]["trial"][:9]): [every[1]],
        ("--scene", "small-room", "--status", "solved"): every,
    }.items():
        assert json.loads(run("trials", "study", *options, "--json").stdout)["trials"] == expected
    nothing = run("trials", "study", "--status", "timeout")
    assert (nothing.exit_code, nothing.stderr) == (2, "error: study: holds no such trial\n")


def test_plans_are_written_with_their_scene(run: Run, folder: Path, small_room: Scene):
    """A plan's file is complete: it can be drawn and verified like one that solve wrote."""
    document = json.loads(run("trials", "study", "--method", "good", "--out", "plans", "--json").stdout)
    files = [Path(trial["plan"]) for trial in document["trials"]]
    assert len(set(files)) == 2
    plan = read_plan(folder.parent / files[0])
    assert (plan.method, plan.seed) == ("good", 0)
    assert plan.scene_data is not None
    assert plan.scene_data.geometry_hash == small_room.geometry_hash
    assert run("render", str(files[0]), "--out", "pictures").exit_code == 0


def test_plans_are_verified_anew(run: Run, folder: Path):
    """What does not hold is found, said and ends with status 1."""
    assert folder.is_dir()
    assert run("trials", "study", "--method", "good", "--verify").exit_code == 0
    result = run("trials", "study", "--verify", "--json")
    assert result.exit_code == 1
    assert [trial["verified"] for trial in json.loads(result.stdout)["trials"]] == [True, False, True, False]
    assert result.stderr.count("the verdict was True, now it is False") == 2


def test_merge_and_diff(run: Run, folder: Path):
    """Merged with itself a folder stays what it was, and does not differ from it."""
    assert folder.is_dir()
    merged = json.loads(run("merge", "study", "study", "--out", "all", "--json").stdout)
    assert merged == {"out": "all", "trials": 4, "added": 4, "repeated": 4}
    result = run("diff", "study", "all", "--json")
    assert result.exit_code == 0
    document = json.loads(result.stdout)
    assert (document["agree"], document["first_alone"], document["second_alone"]) == (True, 0, 0)
    assert document["methods"]["good"]["same_plans"] == document["methods"]["good"]["both"] == 2
    assert "good" in run("diff", "study", "all").stdout
    wrong = run("merge", "study", "--out", "study")
    assert (wrong.exit_code, wrong.stderr) == (2, "error: --out: study is one of the folders to be merged\n")
    assert run("diff", "study", "nowhere").stderr.startswith("error: nowhere: no study: there is no file")
