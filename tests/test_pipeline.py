"""The whole way from a random level to a verified plan and its pictures, through the command line."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from converter.formats import read_scene
from converter.plan import Plan, read_plan
from converter.scene import Scene
from evaluate import demo
from evaluate.cli import app
from pcg.level_set import read_level_set
from pcg.sokoban import apply_moves, is_solved

COUNT = 5
PUZZLES = Path(__file__).parents[1] / "data" / "puzzles"


def run(*arguments: str) -> Any:
    """The JSON document of a command that succeeds."""
    result = CliRunner().invoke(app, [*arguments, "--json"])
    assert result.exit_code == 0, result.stderr
    return json.loads(result.stdout)


def end_of_goal_object(scene: Scene, plan: Plan) -> np.ndarray:
    """Where a plan leaves the goal-object, by adding up what each carry moves it."""
    position = scene.goal_object.position[:2].copy()
    for segment in plan.segments:
        if segment.object == scene.goal.object:
            position += segment.path[-1] - segment.path[0]
    return position


def test_from_level_to_pictures(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Every level that pushes solve becomes a valid scene with a verified plan that ends in the goal."""
    monkeypatch.chdir(tmp_path)
    run("generate", "--count", str(COUNT), "--seed", "11", "--out", "levels")
    reports = run("levels", "levels")["levels"]
    levels = read_level_set(Path("levels"))
    assert len(levels) == len(reports) == COUNT
    for level, report in zip(levels, reports, strict=True):
        assert is_solved(apply_moves(level, report["solution"]))

    scenes = [scene["file"] for scene in run("convert", "levels", "--out", "scenes")["scenes"]]
    assert all(scene["valid"] for scene in run("check", *scenes)["scenes"])
    results = run("solve", *scenes, "--out", "plans")["results"]
    for scene_file, result in zip(scenes, results, strict=True):
        assert run("verify", scene_file, result["plan"]) == {"valid": True, "violations": []}
        scene, plan = read_scene(Path(scene_file)), read_plan(Path(result["plan"]))
        assert plan.scene_hash == scene.geometry_hash
        assert np.array_equal(plan.segments[0].path[0], scene.agent.position)
        assert scene.goal.contains(end_of_goal_object(scene, plan))
        assert sum(segment.length for segment in plan.segments) == pytest.approx(result["path_length_m"])

    pictures = run("render", "levels", results[0]["plan"], "--out", "pictures")["pictures"]
    assert len(pictures) == COUNT + 1
    assert all(Path(picture["file"]).read_bytes().startswith(b"\x89PNG") for picture in pictures)


def test_a_seed_fixes_all_files(tmp_path: Path):
    """The same commands write the same levels, scenes and plans, apart from times."""
    for folder in (tmp_path / "a", tmp_path / "b"):
        run("generate", "--count", "2", "--seed", "3", "--out", str(folder))
        scenes = run("convert", str(folder), "--out", str(folder))["scenes"]
        run("solve", *(scene["file"] for scene in scenes), "--seed", "1", "--out", str(folder))
    names = sorted(path.name for path in (tmp_path / "a").iterdir())
    assert len(names) == 2 + 2 + 2
    for name in names:
        first, second = ((tmp_path / folder / name).read_text() for folder in ("a", "b"))
        if name.endswith(".json"):
            first, second = (json.dumps(json.loads(text) | {"time_s": 0}) for text in (first, second))
        assert first == second


def test_the_demo_runs(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """One row for each level and puzzle, pictures of levels, scenes and plans, and a sheet of all plans."""
    demo.run(tmp_path, [PUZZLES / "cube-free.yaml", PUZZLES / "wall-easy.yaml"], levels=1)
    output = capsys.readouterr().out
    rows = [line.split() for line in output.splitlines() if line.startswith(" ")]
    assert {"random-0-0", "cube-free", "wall-easy"} <= {row[0] for row in rows}
    pictures = {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.suffix in {".png", ".gif"}}
    scenes = ("random-0-0", "cube-free", "wall-easy")
    assert pictures == {
        "plans.png",
        "levels/random-0-0.png",
        *(f"scenes/{scene}.png" for scene in scenes),
        *(f"plans/{scene}-Rnd+FPR-0.{format_}" for scene in scenes for format_ in ("png", "gif")),
    }
