"""The command `convert`: what `--to` writes."""

import json
from pathlib import Path

import mujoco
import pytest
from typer.testing import CliRunner

from converter.formats import read_scene
from evaluate.cli import app

WALL = Path(__file__).parents[2] / "data" / "puzzles" / "wall.yaml"


def converted(folder: Path, to: str) -> Path:
    """The file that the puzzle Wall becomes."""
    result = CliRunner().invoke(app, ["convert", str(WALL), "--to", to, "--out", str(folder), "--json"])
    assert result.exit_code == 0, result.stderr
    (row,) = json.loads(result.stdout)["scenes"]
    return Path(row["file"])


@pytest.mark.parametrize(("to", "name"), [("yaml", "wall.yaml"), ("g", "wall.g")])
def test_scene_formats_are_read_back(tmp_path: Path, to: str, name: str):
    """The same geometry in a file of the format's suffix."""
    file = converted(tmp_path, to)
    assert file.name == name
    assert read_scene(file).geometry_hash == read_scene(WALL).geometry_hash


@pytest.mark.parametrize(("to", "mocap"), [("mjcf", 0), ("mjcf-mocap", 1)])
def test_models_load_in_mujoco(tmp_path: Path, to: str, mocap: int):
    """With a free object, or with one that a program moves."""
    file = converted(tmp_path, to)
    assert file.name == "wall.xml"
    assert mujoco.MjModel.from_xml_path(str(file)).nmocap == mocap


def test_other_formats_are_refused(tmp_path: Path):
    """The allowed ones are listed."""
    result = CliRunner().invoke(app, ["convert", str(WALL), "--to", "urdf", "--out", str(tmp_path)])
    assert result.exit_code == 2
    assert "--to: found 'urdf', allowed are yaml, g, mjcf, mjcf-mocap" in result.stderr
