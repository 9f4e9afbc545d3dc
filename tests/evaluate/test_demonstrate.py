"""`manipuzzle demonstrate`."""

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from converter.formats import write_scene
from converter.scene import Scene
from evaluate.cli import app
from evaluate.commands.demonstrate import subgoal_of
from pcg.errors import InputError
from planner.demonstration import read_demonstration


@pytest.fixture
def room_file(tmp_path: Path, small_room: Scene) -> str:
    """The file of a small scene."""
    write_scene(tmp_path / "room.yaml", small_room)
    return str(tmp_path / "room.yaml")


@given(st.text(min_size=1).filter(lambda name: name.strip() == name), st.floats(-9e9, 9e9), st.floats(-9e9, 9e9))
def test_any_name_and_numbers_are_read(name: str, x: float, y: float):
    """The last colon ends the name, so names may hold colons and commas."""
    subgoal = subgoal_of(f" {name}:{x},{y}\n", "line 1")
    assert (subgoal.object, *subgoal.position) == (name, x, y)


@pytest.mark.parametrize("text", ["obj", "obj:", "obj:1", "obj:1,2,3", "obj:1;2", "obj:a,b", "obj:nan,0", ""])
def test_other_forms_are_refused(text: str):
    """The message quotes what was found and shows the form."""
    with pytest.raises(InputError, match=r"^line 4: found .*, wanted is object:x,y in metres$"):
        subgoal_of(text, "line 4")


def test_points_and_lines_give_the_same_file(room_file: str, tmp_path: Path):
    """Options and standard input are two ways to type the same; empty lines do not count."""
    points = ["obj:-1.2,0.8", "obstacle:0,1.5"]
    options = [option for point in points for option in ("--point", point)]
    files = [str(tmp_path / name) for name in ("a.yaml", "b.yaml")]
    typed = CliRunner().invoke(app, ["demonstrate", room_file, *options, "--out", files[0], "--json"])
    piped = CliRunner().invoke(app, ["demonstrate", room_file, "--out", files[1]], input="\n\n".join(points))
    assert (typed.exit_code, piped.exit_code) == (0, 0)
    assert json.loads(typed.stdout) == {"scene": "room", "subgoals": 2, "file": files[0]}
    assert Path(files[0]).read_bytes() == Path(files[1]).read_bytes()
    read = read_demonstration(Path(files[0]))
    assert [(s.object, *s.position) for s in read.subgoals] == [("obj", -1.2, 0.8), ("obstacle", 0.0, 1.5)]


def test_a_recorded_demonstration_suits_the_scene(room_file: str, tmp_path: Path):
    """Places in walls are refused before anything is written."""
    out = tmp_path / "a.yaml"
    result = CliRunner().invoke(app, ["demonstrate", room_file, "--point", "obj:1,0", "--out", str(out)])
    assert result.exit_code == 2
    assert "subgoals[0].position: at [1.0, 0.0] 'obj' is in a wall" in result.stderr
    assert not out.exists()


def test_nothing_typed_is_bad_usage(room_file: str, tmp_path: Path):
    """An empty standard input: the message says how to give subgoals."""
    result = CliRunner().invoke(app, ["demonstrate", room_file, "--out", str(tmp_path / "a.yaml")], input="\n")
    assert result.exit_code == 2
    assert "use --point object:x,y" in result.stderr
