"""`manipuzzle subgoals`."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from converter.formats import write_scene
from converter.scene import Scene
from evaluate.cli import app
from evaluate.commands.subgoals import proposal_at_start
from pcg.errors import InputError
from planner.settings import Settings


def run(*arguments: str) -> tuple[int, str, str]:
    """Exit status, stdout and stderr of the command."""
    result = CliRunner().invoke(app, ["subgoals", *arguments])
    return result.exit_code, result.stdout, result.stderr


@pytest.fixture
def room_file(tmp_path: Path, small_room: Scene) -> str:
    """The file of a small scene."""
    write_scene(tmp_path / "room.yaml", small_room)
    return str(tmp_path / "room.yaml")


@pytest.mark.parametrize("method", ["Rnd+FPR", "Btl+FPR", "Rnd+R"])
def test_the_document_and_the_picture(room_file: str, tmp_path: Path, method: str):
    """Counts, positions and one picture, named after scene, method, object and seed; the seed fixes all of it."""
    arguments = [room_file, "--object", "obstacle", "--method", method, "--seed", "3", "--json", "--out"]
    (status, stdout, _), (_, again, _) = (run(*arguments, str(tmp_path / folder)) for folder in ("a", "b"))
    assert status == 0
    found, repeated = json.loads(stdout), json.loads(again)
    picture, other = Path(found.pop("file")), Path(repeated.pop("file"))
    assert picture == tmp_path / "a" / f"room-{method}-obstacle-3.png"
    assert picture.read_bytes() == other.read_bytes()
    assert found == repeated
    assert (found["scene"], found["object"]) == ("room", "obstacle")
    assert 0 < len(found["subgoals"]) <= found["passed"] <= found["candidates"]
    assert (found["passed"] < found["candidates"]) == ("F" in method)


def test_the_goal_object_is_the_default(room_file: str, tmp_path: Path):
    """For people there is one line with the counts and the file."""
    status, stdout, _ = run(room_file, "--out", str(tmp_path))
    assert status == 0
    assert stdout.startswith("obj: ")
    assert "room-Rnd+FPR-obj-0.png" in stdout


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--object", "box"], "--object: found 'box', allowed are obj, obstacle"),
        (["--method", "MBTS"], "--method: MBTS proposes no subgoals; Rnd, Btl, Hum do"),
        (["--method", "Hum+R"], "method Hum needs a demonstration"),
    ],
)
def test_bad_usage_is_one_line(room_file: str, tmp_path: Path, options: list[str], message: str):
    """What does not exist is named with what does; nothing is written."""
    status, stdout, stderr = run(room_file, *options, "--out", str(tmp_path / "pictures"))
    assert (status, stdout) == (2, "")
    assert message in stderr
    assert not (tmp_path / "pictures").exists()


def test_an_object_out_of_reach_has_no_subgoals(small_room: Scene):
    """In a search it would be skipped, so there is nothing to draw."""
    far = replace(small_room, agent=replace(small_room.agent, position=np.array([1.6, 0.0])))
    wall = small_room.walls[0]
    closed = replace(far, walls=(wall, *(replace(wall, name=f"{y}").at(np.array([1.0, y])) for y in (-1.9, 1.9))))
    with pytest.raises(InputError, match="the agent cannot reach object 'obj'"):
        proposal_at_start(closed, Settings(), "obj", 0)


def test_vectors_and_other_colours(room_file: str, tmp_path: Path):
    """SVG in the theme that was asked for; formats of animations are refused."""
    options = ["--format", "svg", "--theme", "colorblind", "--out", str(tmp_path)]
    assert run(room_file, *options)[0] == 0
    assert (tmp_path / "room-Rnd+FPR-obj-0.svg").read_text().startswith("<svg ")
    assert "--format: found 'gif', allowed are png, svg" in run(room_file, "--format", "gif", "--out", "o")[2]
