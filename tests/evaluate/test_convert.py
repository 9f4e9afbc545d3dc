"""The command `convert`: its options arrive in the scenes, in one process and in several."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from converter.formats import read_scene
from evaluate.cli import app

LEVELS = """\
; one
########
#@ $  .#
# ## $ #
# ##   #
########

; two
#######
#@ $ .#
#   ###
#######
"""
OPTIONS = [
    *("--cell", "0.5", "--agent-radius", "0.2", "--agent-height", "0.3", "--object-size", "0.25", "--goal-size", "0.3"),
    *(
        "--object-height",
        "0.15",
        "--wall-height",
        "0.6",
        "--merge-walls",
        "--size-jitter",
        "0.2",
        "--yaw-jitter",
        "0.3",
    ),
    *("--seed", "4", "--goal-crate", "1", "--drop-crates", "--drop-targets"),
]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working folder, with two levels."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "levels.xsb").write_text(LEVELS)
    return tmp_path


def test_every_option_arrives(folder: Path):
    """The scene records them all, and looks like it."""
    result = CliRunner().invoke(app, ["convert", "levels.xsb", "--out", "scenes", "--json", *OPTIONS])
    assert result.exit_code == 0
    assert [row["scene"] for row in json.loads(result.stdout)["scenes"]] == ["one", "two"]
    scene = read_scene(folder / "scenes" / "one.yaml")
    assert scene.source["settings"] == {
        "preset": "clear",
        "cell": 0.5,
        "wall_height": 0.6,
        "object_size": 0.25,
        "object_height": 0.15,
        "goal_size": 0.3,
        "agent_radius": 0.2,
        "agent_height": 0.3,
        "merge_walls": True,
        "size_jitter": 0.2,
        "yaw_jitter": 0.3,
        "seed": 4,
        "goal_crate": 1,
        "drop_targets": True,
        "drop_crates": True,
    }
    assert (len(scene.walls), len(scene.objects)) == (4 + 1, 1)
    assert scene.goal_object.yaw != 0


def test_workers_write_the_same_files(folder: Path):
    """Byte for byte, in the same order."""
    one, two = (
        CliRunner().invoke(app, ["convert", "levels.xsb", "--out", out, "--workers", workers])
        for out, workers in (("a", "1"), ("b", "2"))
    )
    assert one.stdout.replace("a/", "b/").replace("to a", "to b") == two.stdout
    for name in ("one.yaml", "two.yaml"):
        assert (folder / "a" / name).read_bytes() == (folder / "b" / name).read_bytes()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["levels.xsb", "--goal-crate", "2", "--workers", "2"], "level 'two': goal_crate: 2, but the level has only 1"),
        (["levels.xsb", "--goal-crate", "2"], "level 'two': goal_crate: 2, but the level has only 1"),
        (["levels.xsb", "--size-jitter", "1.5"], "size_jitter: 1.5 must be at least 0 and less than 1"),
        (["a/one.yaml", "--merge-walls"], "a/one.yaml: sizes and choices apply to levels only"),
    ],
)
def test_what_is_refused(folder: Path, arguments: list[str], message: str):
    """One line and exit status 2."""
    assert folder.is_dir()
    CliRunner().invoke(app, ["convert", "levels.xsb", "--out", "a"])
    result = CliRunner().invoke(app, ["convert", *arguments, "--out", "out"])
    assert result.exit_code == 2
    assert result.stderr.startswith(f"error: {message}")
