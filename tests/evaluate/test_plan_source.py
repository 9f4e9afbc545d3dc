"""Folders and trials as arguments: the files and plans that they stand for."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from converter.formats import write_scene
from converter.plan import Plan, write_plan
from converter.scene import Scene
from evaluate.cli import app
from evaluate.inputs import expanded
from evaluate.plan_source import names_plan, read_named_plan, read_plans
from evaluate.store import StoredTrials
from pcg.errors import InputError

STUDY = "name: s\nscenes: [scenes/room.yaml]\nmethods: [Rnd+R]\nseeds: 2\ntime_limit: 10\n"

Run = Callable[..., Result]


@pytest.fixture
def folder(tmp_path: Path, small_room: Scene, small_plan: Plan, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working folder with a folder of scenes and one of plans."""
    monkeypatch.chdir(tmp_path)
    write_scene(tmp_path / "scenes" / "room.yaml", small_room)
    write_scene(tmp_path / "scenes" / "a.yaml", small_room)
    (tmp_path / "scenes" / "notes.txt").write_text("")
    for name in ("one", "two"):
        write_plan(tmp_path / "plans" / f"{name}.json", replace(small_plan, scene_data=small_room))
    (tmp_path / "empty").mkdir()
    return tmp_path


@pytest.fixture
def run(folder: Path) -> Run:
    """Runs a command in `folder`."""
    assert folder.is_dir()
    return lambda *arguments: CliRunner().invoke(app, list(arguments))


def test_a_folder_stands_for_its_files(folder: Path):
    """By name, without files of other kinds; files stay as they are, even missing ones."""
    found = expanded([folder / "scenes", Path("missing.yaml")], (".yaml",))
    assert list(found) == [folder / "scenes" / "a.yaml", folder / "scenes" / "room.yaml", Path("missing.yaml")]


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (["check", "empty"], "error: empty: the folder holds no file *.yaml, *.yml, *.g\n"),
        (["levels", "empty"], "error: empty: no level set: the folder holds no levels.xsb; name files of levels"),
        (["verify", "scenes/room.yaml"], "error: scenes/room.yaml: a scene; name a plan behind it\n"),
        (
            ["export", "scenes/room.yaml", "--out", "o"],
            "error: scenes/room.yaml: not a plan: a plan is a .json file or",
        ),
        (
            ["solve", "scenes", "scenes/a.yaml", "--out", "o"],
            "error: scenes: two inputs would be written as 'a', scenes/a.yaml and scenes/a.yaml; ",
        ),
    ],
)
def test_folders_that_do_not_fit_are_refused(run: Run, arguments: list[str], problem: str):
    """One line that names the folder or both files."""
    result = run(*arguments)
    assert result.exit_code == 2
    assert result.stderr.startswith(problem)


def test_a_level_set_is_no_folder_of_scenes(run: Run):
    """The message says how to get scenes from it."""
    assert run("generate", "--count", "1", "--out", "levels").exit_code == 0
    assert "convert this level set first: manipuzzle convert levels --out DIR" in run("check", "levels").stderr
    assert run("render", "levels", "scenes", "--out", "pictures").exit_code == 0
    assert run("convert", "levels", "--out", "converted").exit_code == 0


def test_commands_take_folders(run: Run, folder: Path):
    """Every file of the folder is used once."""
    assert "2 of 2 scenes valid" in run("check", "scenes", "--static").stdout
    (folder / "scenes" / "a.yaml").unlink()
    assert "1 of 1 scene solved" in run("solve", "scenes", "--out", "solved").stdout
    assert run("solve", "scenes", "--out", "solved", "--seed", "1").exit_code == 0
    assert "2 of 2 plans valid" in run("verify", "solved").stdout
    assert run("render", "plans", "scenes", "--out", "pictures", "--format", "svg").exit_code == 0
    assert sorted(path.stem for path in (folder / "pictures").iterdir()) == ["one", "room", "two"]
    assert run("export", "plans", "--out", "tables").exit_code == 0
    assert len(list((folder / "tables").iterdir())) == 2


def test_one_trial_of_a_study_is_a_plan(run: Run, folder: Path):
    """By the beginning of its key, for verify, render and export; others are refused."""
    (folder / "study.yaml").write_text(STUDY)
    assert run("study", "study.yaml", "--out", "results").exit_code == 0
    with StoredTrials(folder / "results") as store:
        key, other = (row.key for row in store.rows())
    trial = f"results#{key[:12]}"
    assert names_plan(Path(trial))
    assert read_named_plan(Path(trial)).name == f"room-Rnd+R-0-{key[:6]}"
    assert run("verify", trial).stdout == f"{trial}: valid\n"
    assert run("verify", "scenes/room.yaml", trial, f"results#{other}").exit_code == 0
    assert run("render", trial, "--out", "pictures").exit_code == 0
    assert (folder / "pictures" / f"room-Rnd+R-0-{key[:6]}.png").is_file()
    assert "no such trial; `manipuzzle trials results` lists them" in run("verify", "results#none").stderr
    with pytest.raises(InputError, match="not a plan"):
        list(read_plans([Path("elsewhere#1")]))


def test_several_verdicts_are_one_document(run: Run, folder: Path, small_plan: Plan, small_room: Scene):
    """Each with its plan; one that is not valid makes the whole not valid."""
    write_plan(
        folder / "solved" / "wrong.json", replace(small_plan, segments=small_plan.segments[:2], scene_data=small_room)
    )
    assert run("solve", "scenes/room.yaml", "--out", "solved").exit_code == 0
    result = run("verify", "solved")
    assert result.exit_code == 1
    assert "1 of 2 plans valid" in result.stdout
    assert '"valid": false' in run("verify", "solved", "--json").stdout
