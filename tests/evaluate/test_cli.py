"""The command line: what it prints and writes, and how it refuses bad input."""

import json
import operator
import os
import re
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from converter.formats import read_scene, write_scene
from converter.plan import Plan, read_plan, write_plan
from converter.scene import Body, Scene
from converter.shape import Part
from evaluate.cli import app
from evaluate.commands import solve as solve_command
from evaluate.store import FILE_NAME
from pcg.request import Request
from planner import METHODS
from planner import PRESETS as SETTINGS

LEVELS = """\
; corridor
#######
#@ $ .#
#######

; stuck
#######
#@ .#$#
#######

; mirrored
#######
#. $ @#
#######
"""

NO_PLAYER = """\
####
#$.#
####
"""

Run = Callable[..., Result]


@pytest.fixture
def folder(tmp_path: Path, small_room: Scene, small_plan: Plan, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working folder of the commands, with one input of each kind, good and bad."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "levels.txt").write_text(LEVELS)
    (tmp_path / "no-player.xsb").write_text(NO_PLAYER)
    write_scene(tmp_path / "room.yaml", small_room)
    write_scene(tmp_path / "other" / "room.yaml", small_room)
    blocked = small_room.objects[0].at(np.array([1.0, 0.0]))
    write_scene(tmp_path / "blocked.yaml", replace(small_room, objects=(blocked, small_room.objects[1])))
    write_scene(tmp_path / "strict.yaml", replace(small_room, tolerance=0.0))
    (tmp_path / "broken.yaml").write_text("format: 1\nname: [")
    (tmp_path / "file").write_text("")
    write_plan(tmp_path / "plan.json", replace(small_plan, scene_data=None))
    write_plan(tmp_path / "complete.json", replace(small_plan, scene_data=small_room))
    write_plan(tmp_path / "wrong.json", replace(small_plan, segments=small_plan.segments[:2]))
    return tmp_path


@pytest.fixture
def run(folder: Path) -> Run:
    """Runs a command in `folder`."""
    assert folder.is_dir()
    return lambda *arguments: CliRunner().invoke(app, list(arguments))


def document(result: Result) -> Any:
    """The one JSON document on stdout."""
    return json.loads(result.stdout)


def test_solve_writes_a_plan_that_verify_accepts(run: Run, folder: Path):
    """The contract of solve's document, the plan's file name, and the way to verify."""
    solved = run("solve", "room.yaml", "--out", "plans", "--seed", "3", "--json")
    assert solved.exit_code == 0
    (result,) = document(solved)["results"]
    assert result["plan"] == os.path.join("plans", "room-Rnd+FPR-3.json")  # noqa: PTH118  # as printed
    plan = read_plan(folder / result["plan"])
    assert result == {
        "scene": "room",
        "method": "Rnd+FPR",
        "seed": 3,
        "status": "solved",
        "time_s": plan.time_s,
        "plan": result["plan"],
        "verified": True,
        "path_length_m": plan.path_length,
        "pick_places": plan.pick_places,
        "certificate": None,
    }
    verified = run("verify", "room.yaml", result["plan"], "--json")
    assert (verified.exit_code, document(verified)) == (0, {"valid": True, "violations": []})


def test_solve_improves_plans(run: Run, folder: Path):
    """The plan is as good or better, still valid, and says how long it was improved."""
    (first,) = document(run("solve", "room.yaml", "--out", "plans", "--json"))["results"]
    improved = run("solve", "room.yaml", "--out", "improved", "--improve", "0.2", "--json")
    assert improved.exit_code == 0
    (result,) = document(improved)["results"]
    assert (result["pick_places"], result["path_length_m"]) < (first["pick_places"], first["path_length_m"])
    plan = read_plan(folder / result["plan"])
    assert plan.settings["improve"] == 0.2
    assert plan.counters["improve_time_s"] >= 0.2


def test_push_needs_a_level(run: Run, folder: Path):
    """Method Push solves converted levels, and refuses other scenes before any work."""
    run("convert", "levels.txt", "--out", "scenes")
    solved = run("solve", "scenes/corridor.yaml", "--method", "Push", "--out", "plans", "--json")
    (result,) = document(solved)["results"]
    assert (result["verified"], result["pick_places"]) == (True, 1)
    refused = run("solve", "room.yaml", "--method", "Push", "--out", "o")
    assert (refused.exit_code, refused.stdout) == (2, "")
    assert refused.stderr.startswith("error: room.yaml: method Push needs a scene converted from a level")
    assert not (folder / "o").exists()


def test_what_is_not_solved_has_no_plan(run: Run, folder: Path):
    """A goal behind walls: exit status 1, no plan, nothing verified, no file."""
    box = "{name: %s, position: [%s, %s, 0.1], size: [%s, %s, 0.2]}"
    fence = [
        ("a", -1.0, 1.2, 0.7, 0.02),
        ("b", -1.0, 1.8, 0.7, 0.02),
        ("c", -1.3, 1.5, 0.02, 0.7),
        ("d", -0.7, 1.5, 0.02, 0.7),
    ]
    text = (folder / "room.yaml").read_text()
    walls = "".join(f"- {box % wall}\n" for wall in fence)
    (folder / "fenced.yaml").write_text(text.replace("walls:\n", f"walls:\n{walls}"))
    result = run("solve", "fenced.yaml", "--out", "plans", "--time-limit", "1", "--json")
    assert result.exit_code == 1
    (row,) = document(result)["results"]
    assert row["status"] in {"exhausted", "timeout", "infeasible"}
    assert [row[key] for key in ("plan", "verified", "path_length_m", "pick_places")] == [None] * 4
    assert list((folder / "plans").iterdir()) == []


def test_what_is_proven_to_have_no_plan_says_why(run: Run, folder: Path):
    """Walls around the agent: the certificate stands below the table."""
    scene = read_scene(folder / "room.yaml")
    x, y = scene.agent.position
    fence = [
        Body(f"fence {i}", np.array([x + dx, y + dy, 0.1]), 0.2, (Part.box((0.1 + abs(dy) * 2, 0.1 + abs(dx) * 2)),))
        for i, (dx, dy) in enumerate([(0.3, 0), (-0.3, 0), (0, 0.3), (0, -0.3)])
    ]
    write_scene(folder / "shut.yaml", replace(scene, walls=(*scene.walls, *fence)))
    result = run("solve", "shut.yaml", "--out", "plans")
    assert result.exit_code == 1
    assert "\nshut is infeasible: the agent can touch no object\n0 of 1 scene solved" in result.stdout


def test_verify_lists_violations(run: Run):
    """An incomplete plan: exit status 1, and where it fails."""
    result = run("verify", "room.yaml", "wrong.json", "--json")
    assert result.exit_code == 1
    found = document(result)
    assert found["valid"] is False
    (violation,) = found["violations"]
    assert set(violation) == {"kind", "segment", "where", "amount", "message"}
    assert violation["kind"] == "goal_missed"
    assert violation["where"] == pytest.approx([-1.2, 0.8])


def test_verify_with_another_tolerance(run: Run, folder: Path):
    """A plan of a looser scene is refused with the option that verifies it, and then verified."""
    assert run("solve", "room.yaml", "--out", str(folder)).exit_code == 0
    refused = run("verify", "strict.yaml", "room-Rnd+FPR-0.json")
    assert refused.exit_code == 2
    assert "--tolerance 0.001" in refused.stderr
    assert run("verify", "strict.yaml", "room-Rnd+FPR-0.json", "--tolerance", "0.001").exit_code == 0


def test_levels_reports_all(run: Run):
    """The contract of the document of levels; one that cannot be solved makes it negative."""
    result = run("levels", "levels.txt", "--json")
    assert result.exit_code == 1
    found = document(result)
    by_name = {level["name"]: level for level in found["levels"]}
    assert by_name["corridor"] == {
        "name": "corridor",
        "solvable": True,
        "pushes": 2,
        "moves": 3,
        "solution": "rRR",
        "crates": 1,
        "targets": 1,
        "walls": 0,
        "regions": 1,
        "occluded": False,
        "duplicate_of": None,
    }
    assert [by_name["stuck"][key] for key in ("solvable", "pushes", "solution")] == [False, None, None]
    assert by_name["mirrored"]["duplicate_of"] == "corridor"
    assert found["summary"]["levels"] == 3


def test_generated_levels_go_through(run: Run, folder: Path):
    """What generate writes, levels, convert and render read; scenes are named after levels."""
    options = ["--count", "2", "--seed", "5", "--rows", "5", "--columns", "6", "--crates", "1", "--min-pushes", "4"]
    generated = run("generate", *options, "--out", "set", "--json")
    assert generated.exit_code == 0
    names = [level["name"] for level in document(generated)["levels"]]
    assert len(names) == 2
    assert all(level["pushes"] >= 4 for level in document(generated)["levels"])
    assert run("levels", "set").exit_code == 0
    converted = run("convert", "set", "--out", "scenes", "--json")
    assert [scene["scene"] for scene in document(converted)["scenes"]] == names
    checked = run("check", *(scene["file"] for scene in document(converted)["scenes"]), "--json")
    assert (checked.exit_code, [scene["valid"] for scene in document(checked)["scenes"]]) == (0, [True, True])
    rendered = run("render", "set/levels.xsb", "--out", "pictures", "--json")
    assert [picture["name"] for picture in document(rendered)["pictures"]] == names
    assert all((folder / picture["file"]).stat().st_size > 0 for picture in document(rendered)["pictures"])


def test_convert_changes_the_geometry(run: Run, folder: Path):
    """A scene becomes one of the other preset; the name of a level is made safe for its file."""
    result = run("convert", "room.yaml", "--preset", "clear", "--tolerance", "0", "--out", "scenes")
    assert result.exit_code == 0
    text = (folder / "scenes" / "room.yaml").read_text()
    assert "preset: clear" in text
    assert "tolerance: 0.0\n" in text
    (folder / "evil.xsb").write_text(LEVELS.replace("; corridor", "; ../../corridor"))
    names = [scene["scene"] for scene in document(run("convert", "evil.xsb", "--out", "scenes", "--json"))["scenes"]]
    assert names == ["_.._corridor", "stuck", "mirrored"]


def test_check_lists_problems(run: Run):
    """An object in a wall: exit status 1 and the problem with its place."""
    result = run("check", "blocked.yaml", "room.yaml", "--json")
    assert result.exit_code == 1
    blocked, room = document(result)["scenes"]
    assert (blocked["scene"], blocked["valid"], blocked["reachable"]) == ("blocked", False, [])
    assert (room["scene"], room["valid"], room["problems"]) == ("room", True, [])
    assert "overlap" in [problem["kind"] for problem in blocked["problems"]]


def test_render_draws_every_kind(run: Run, folder: Path):
    """Levels, scenes and plans as pictures, plans as animations too, with the scene inside or beside them."""
    assert run("render", "levels.txt", "room.yaml", "complete.json", "--out", "p").exit_code == 0
    assert run("render", "plan.json", "--scene", "room.yaml", "--format", "gif", "--out", "p").exit_code == 0
    signatures = {path.name: path.read_bytes()[:4] for path in (folder / "p").iterdir()}
    pngs = dict.fromkeys(["corridor.png", "stuck.png", "mirrored.png", "room.png", "complete.png"], b"\x89PNG")
    assert signatures == pngs | {"plan.gif": b"GIF8"}


def test_study_reports_and_resumes(run: Run, folder: Path):
    """The contract of the document of study, and its table; run again, nothing is left to do."""
    (folder / "spec.yaml").write_text("name: s\nscenes: [room.yaml]\nmethods: [Rnd+R]\nseeds: 2\n")
    first = document(run("study", "spec.yaml", "--out", "study", "--json"))
    assert [first[key] for key in ("trials", "run", "skipped", "solved")] == [2, 2, 0, 2]
    assert first["by_method"]["Rnd+R"]["solved"] == 2
    assert "| room |" in (folder / "study" / "table.md").read_text()
    again = run("study", "spec.yaml", "--out", "study")
    assert again.exit_code == 0
    assert "2 trials: 0 run, 2 skipped, 2 solved" in again.stdout


def test_a_study_without_trials_is_refused(run: Run, folder: Path):
    """Where no method suits any scene there is nothing to run, which is said before anything is written."""
    (folder / "spec.yaml").write_text("name: s\nscenes: [room.yaml]\nmethods: [Push]\nseeds: 2\n")
    result = run("study", "spec.yaml", "--out", "study")
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr == "error: spec.yaml: methods: none of them suits any of the scenes\n"
    assert not (folder / "study").exists()


def test_workers_that_cannot_start_are_one_line(run: Run, folder: Path, monkeypatch: pytest.MonkeyPatch):
    """Too little memory for a worker, here stood in for by a preparation that fails, ends the study clearly."""
    monkeypatch.setattr("evaluate.study.prepare", operator.truediv)
    (folder / "spec.yaml").write_text("name: s\nscenes: [room.yaml]\nmethods: [Rnd+R]\nseeds: 2\nmemory_mb: 4096\n")
    result = run("study", "spec.yaml", "--out", "study")
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr == (
        "error: spec.yaml: worker processes cannot be prepared: TypeError: truediv expected 2 arguments, got 1; "
        "memory_mb may be too small\n"
    )


def test_tables_are_whole_in_a_pipe(run: Run):
    """Without a terminal no column is cut, headings keep their units, and nothing but results is on stdout."""
    result = run("solve", "room.yaml", "--out", "plans")
    heading = next(line for line in result.stdout.splitlines() if "scene" in line)
    assert re.split(r"\s{2,}", heading.strip()) == [
        "scene", "status", "time [s]", "verified", "path [m]", "pick-places",
    ]  # fmt: skip
    assert result.stdout.endswith("\n1 of 1 scene solved by Rnd+FPR with seed 0; plans in plans\n")
    assert max(map(len, result.stdout.splitlines())) <= 80
    assert result.stderr == ""


BAD_INPUT = {
    "missing file": (["solve", "missing.yaml", "--out", "o"], "missing.yaml: no such file"),
    "missing level": (["levels", "missing.xsb"], "missing.xsb: no such file"),
    "broken YAML": (["solve", "broken.yaml", "--out", "o"], "broken.yaml, line 3: not a YAML file"),
    "object in a wall": (["solve", "blocked.yaml", "--out", "o"], "blocked.yaml: object 'obj' overlaps 'wall'"),
    "no player": (["levels", "no-player.xsb"], "no-player.xsb: line 1: the level has no players"),
    "no level": (["convert", "file", "--out", "o"], "file: no level found"),
    "not a scene": (["check", "levels.txt"], "levels.txt: not a scene file: the suffix must be"),
    "not a plan": (["verify", "room.yaml", "room.yaml"], "room.yaml: not a plan: a plan is a .json file"),
    "plan of another scene": (["verify", "blocked.yaml", "plan.json"], "plan.json: plan of another scene"),
    "plan without a scene": (["render", "plan.json", "--out", "o"], "plan.json: the file holds no scene"),
    "unknown method": (["solve", "room.yaml", "--out", "o", "--method", "X"], "method: found 'X', allowed are Rnd+FPR"),
    "unknown settings": (["solve", "room.yaml", "--out", "o", "--settings", "X"], "settings: found 'X', allowed are fast"),
    "unknown preset": (["convert", "levels.txt", "--out", "o", "--preset", "X"], "--preset: found 'X', allowed are "),
    "unknown agent": (["generate", "--out", "o", "--agent", "m36"], "--agent: found 'm36', allowed are random, m0 ... m35"),
    "unknown scene format": (["convert", "room.yaml", "--out", "o", "--to", "stl"], "--to: found 'stl', allowed are yaml, g"),
    "unknown picture format": (["render", "room.yaml", "--out", "o", "--format", "bmp"], "--format: found 'bmp', allowed are png, svg, gif, mp4, html"),
    "animated scene": (["render", "room.yaml", "--out", "o", "--format", "gif"], "room.yaml: gif shows plans in motion"),
    "negative seed": (["solve", "room.yaml", "--out", "o", "--seed", "-1"], "Invalid value for '--seed'"),
    "no time": (["solve", "room.yaml", "--out", "o", "--time-limit", "0"], "time limit: found 0.0, must be a finite number of seconds > 0"),
    "infinite time": (["solve", "room.yaml", "--out", "o", "--time-limit", "inf"], "Invalid value for '--time-limit'"),
    "negative time": (["solve", "room.yaml", "--out", "o", "--improve", "-1"], "Invalid value for '--improve'"),
    "tolerance that is no number": (["check", "room.yaml", "--tolerance", "nan"], "Invalid value for '--tolerance'"),
    "more targets than crates": (["generate", "--out", "o", "--targets", "3"], "options: 2 crates cannot cover 3"),
    "one name twice": (["solve", "room.yaml", "other/room.yaml", "--out", "o"], "scenes: two inputs would be written as 'room'"),
    "one level twice": (["convert", "levels.txt", "levels.txt", "--out", "o"], "inputs: two inputs would be written as "),
    "unwritable folder": (["solve", "room.yaml", "--out", "file"], "file: cannot be written: "),
    "unwritable parent": (["convert", "levels.txt", "--out", "file/o"], "file/o: cannot be written: "),
    "no such command": (["dance"], "No such command 'dance'"),
    "no such option": (["check", "room.yaml", "--fast"], "No such option: --fast"),
    "missing argument": (["check"], "Missing argument 'SCENE"),
    "missing specification": (["study", "missing.yaml", "--out", "o"], "missing.yaml: no such file"),
}  # fmt: skip


@pytest.mark.parametrize("as_json", [False, True])
@pytest.mark.parametrize(("arguments", "message"), BAD_INPUT.values(), ids=list(BAD_INPUT))
def test_bad_input_is_one_line(run: Run, folder: Path, arguments: list[str], message: str, *, as_json: bool):
    """Exit status 2, one line on stderr, nothing on stdout, and no work begun."""
    result = run(*arguments, *(["--json"] if as_json and arguments != ["dance"] else []))
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith(f"error: {message}")
    assert result.stderr.count("\n") == 1
    assert not (folder / "o").exists()


def test_bugs_are_not_hidden(run: Run, monkeypatch: pytest.MonkeyPatch):
    """An error that is not the user's fault keeps its traceback."""
    monkeypatch.setattr("evaluate.scene_check.check_scene", lambda _: np.zeros(2).reshape(3))
    assert isinstance(run("check", "room.yaml").exception, ValueError)


def test_finished_results_are_kept(run: Run, folder: Path, monkeypatch: pytest.MonkeyPatch):
    """An error in the second scene leaves the first one's plan."""
    solve = solve_command.run_trial

    def failing(scene: Scene, *arguments: Any) -> Any:
        if scene.name == "second":
            raise KeyboardInterrupt
        return solve(scene, *arguments)

    monkeypatch.setattr(solve_command, "run_trial", failing)
    (folder / "second.yaml").write_text((folder / "room.yaml").read_text())
    assert run("solve", "room.yaml", "second.yaml", "--out", "o").exit_code == 130
    assert [path.name for path in (folder / "o").iterdir()] == ["room-Rnd+FPR-0.json"]


def test_help_says_what_is_true(run: Run):
    """Every command has an example; methods and defaults are those of the packages."""
    commands = re.findall(r"^  (\w+) ", run("--help").stdout.partition("Commands:")[2], re.MULTILINE)
    assert {"generate", "levels", "convert", "check", "solve", "verify", "render", "study"} <= set(commands)
    for command in commands:
        assert f"Example:  manipuzzle {command}" in run(command, "--help").stdout
    solve, generate = (" ".join(run(command, "--help").stdout.split()) for command in ("solve", "generate"))
    assert all(name in solve for name in (*METHODS, *SETTINGS))
    defaults = Request()
    values = {name: getattr(defaults, name) for name in ("rows", "columns", "crates", "targets")}
    for name, value in {**values, "min-pushes": defaults.pushes[0]}.items():
        assert re.search(rf"--{name} N [^[]*\[default: \({value}\b", generate)


def test_version_and_bare_call(run: Run):
    """The version is that of the package; without a command the help is shown."""
    assert re.fullmatch(r"\d+\.\d+\.\d+\n", run("--version").stdout)
    assert "Commands:" in run().stdout


def program(*arguments: str, **options: Any) -> subprocess.Popen[str]:
    """Starts the program as a user would."""
    command = [sys.executable, "-c", "from evaluate.cli import main; main()", *arguments]
    return subprocess.Popen(command, stderr=subprocess.PIPE, text=True, **options)  # noqa: S603  # our own program


def test_a_closed_pipe_is_no_error(folder: Path):
    """`manipuzzle levels ... | head` ends quietly, with the status that shells give a closed pipe."""
    reading, writing = os.pipe()
    os.close(reading)
    with program("levels", str(folder / "levels.txt"), stdout=writing) as process:
        os.close(writing)
        assert process.stderr is not None
        assert process.stderr.read() == ""
    assert process.returncode == 141


def test_interrupted_study_keeps_its_trials(folder: Path):
    """Ctrl-C in a terminal reaches all processes: exit status 130, one line, rows kept, nothing left running."""
    (folder / "spec.yaml").write_text("name: s\nscenes: [room.yaml]\nmethods: [Rnd+FPR]\nseeds: 100000\n")
    arguments = ["study", str(folder / "spec.yaml"), "--out", str(folder / "study"), "--workers", "2"]
    with program(*arguments, stdout=subprocess.PIPE, start_new_session=True) as process:
        deadline = time.monotonic() + 60
        while _rows(folder / "study" / FILE_NAME) < 3 and time.monotonic() < deadline:
            time.sleep(0.05)
        os.killpg(process.pid, signal.SIGINT)
        stdout, stderr = process.communicate()
    assert (process.returncode, stdout) == (130, "")
    assert re.fullmatch(r"interrupted: the finished trials are in .*, the same command continues\n", stderr)
    assert _rows(folder / "study" / FILE_NAME) >= 3
    deadline = time.monotonic() + 20
    while _is_running(process.pid) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not _is_running(process.pid)


def _is_running(group: int) -> bool:
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


def _rows(path: Path) -> int:
    if not path.exists():
        return 0
    connection = sqlite3.connect(path)
    try:
        return int(connection.execute("SELECT count(*) FROM trial").fetchone()[0])
    except sqlite3.OperationalError:
        return 0
    finally:
        connection.close()
