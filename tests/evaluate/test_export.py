import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from converter.formats import write_scene
from converter.plan import Plan, Status, write_plan
from converter.scene import Scene
from evaluate.cli import app


def invoke(*arguments: object) -> Any:
    """The result of a command."""
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture
def plan_file(tmp_path: Path, small_room: Scene, small_plan: Plan) -> Path:
    """A plan file that holds its scene."""
    path = tmp_path / "plan a.json"
    write_plan(path, replace(small_plan, scene_data=small_room))
    return path


@pytest.mark.parametrize(
    ("to", "names"),
    [
        ("csv", ["plan_a.csv"]),
        ("npz", ["plan_a.npz"]),
        ("pddl", ["plan_a-domain.pddl", "plan_a-problem.pddl", "plan_a.plan"]),
    ],
)
def test_files_are_called_after_the_plan(tmp_path: Path, plan_file: Path, to: str, names: list[str]):
    """Each format writes its files and names them."""
    result = invoke("export", plan_file, "--to", to, "--out", tmp_path / "out", "--json")
    assert result.exit_code == 0, result.stderr
    (plan,) = json.loads(result.stdout)["plans"]
    assert [Path(file).name for file in plan["files"]] == names
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == sorted(names)


def test_speed_acceleration_and_rests_count(tmp_path: Path, plan_file: Path, small_plan: Plan):
    """Constant speed takes the length over the speed, and each grasp and release its rest."""
    options = ["--speed", 2, "--acceleration", 0, "--grasp-time", 0.25, "--step", 0.5]
    assert invoke("export", plan_file, "--to", "npz", "--out", tmp_path, *options).exit_code == 0
    with np.load(tmp_path / "plan_a.npz") as arrays:
        assert arrays["t"][-1] == pytest.approx(small_plan.path_length / 2 + 4 * 0.25)


def test_a_plan_without_its_scene_needs_one(tmp_path: Path, small_room: Scene, small_plan: Plan):
    """The scene is named by an option, and must be the plan's."""
    plan, scene = tmp_path / "plan.json", tmp_path / "room.yaml"
    write_plan(plan, small_plan)
    write_scene(scene, small_room)
    result = invoke("export", plan, "--out", tmp_path)
    assert (result.exit_code, result.stdout) == (2, "")
    assert "plan.json: the file holds no scene; name the scene's file by --scene" in result.stderr
    assert invoke("export", plan, "--scene", scene, "--out", tmp_path).exit_code == 0
    write_scene(scene, replace(small_room, tolerance=0.0))
    result = invoke("export", plan, "--scene", scene, "--out", tmp_path)
    assert result.exit_code == 2
    assert "made with tolerance 0.001 m" in result.stderr


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--to", "xml"], "--to: found 'xml', allowed are csv, npz, pddl"),
        (["--step", "0"], "step: 0.0 s must be positive"),
        (["--speed", "nan"], "speed: nan m/s must be from"),
        (["--grasp-time", "-1"], "grasp_time: -1.0 s must be from 0"),
    ],
)
def test_bad_options_are_named(tmp_path: Path, plan_file: Path, options: list[str], message: str):
    """One line on stderr, status 2."""
    result = invoke("export", plan_file, "--out", tmp_path, *options)
    assert (result.exit_code, result.stdout) == (2, "")
    assert message in result.stderr
    assert result.stderr.count("\n") == 1


def test_a_plan_without_solution_is_refused(tmp_path: Path, small_room: Scene, small_plan: Plan):
    """There is no motion to export."""
    path = tmp_path / "plan.json"
    write_plan(path, replace(small_plan, status=Status.TIMEOUT, segments=(), scene_data=small_room))
    for to in ("csv", "pddl"):
        result = invoke("export", path, "--to", to, "--out", tmp_path)
        assert result.exit_code == 2
        assert "status: timeout" in result.stderr
