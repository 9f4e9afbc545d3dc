"""The preview with the planner's paths: every puzzle can be driven, and every plan of one plays back."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from converter.convert import ConversionSettings, convert_level
from converter.formats import read_scene, write_scene
from converter.plan import Plan, write_plan
from converter.preview.picture import report_drawing, summary
from converter.preview.playback import play_back
from converter.raster import paint
from converter.scene import Scene
from evaluate.cli import app
from evaluate.scene_check import check
from pcg.xsb import parse_levels
from planner import settings_for, solve
from planner.verify import verify

PUZZLES = sorted((Path(__file__).parents[2] / "data" / "puzzles").glob("*.yaml"))
LEVEL = """
#########
#@  #   #
# $   $ #
#   #   #
#.  #   #
#########
"""


def planned(scene: Scene, seed: int = 0, time_limit: float = 900.0) -> Plan:
    """A plan by Rnd+FPR."""
    settings = settings_for("fast", method="Rnd+FPR", time_limit=time_limit)
    return solve(scene, settings, np.random.default_rng(seed)).to_plan(scene, settings, seed=seed)


@pytest.mark.parametrize("path", [path for path in PUZZLES if path.stem != "maze"], ids=lambda path: path.stem)
def test_plans_of_the_puzzles_play_back(path: Path):
    """In their own geometry, without clearance: nothing moves that is not carried."""
    scene = read_scene(path)
    plan = planned(scene)
    assert verify(scene, plan) == []
    found = play_back(scene, plan)
    assert found.problems == ()
    assert found.moved < 1e-3
    assert found.slipped < 1e-3


@pytest.mark.slow
def test_a_plan_of_maze_plays_back():
    """The hardest puzzle, with some twenty regrasps of a few centimetres."""
    (path,) = [path for path in PUZZLES if path.stem == "maze"]
    scene = read_scene(path)
    plan = planned(scene)
    assert verify(scene, plan) == []
    assert play_back(scene, plan).problems == ()


@pytest.mark.parametrize("path", PUZZLES, ids=lambda path: path.stem)
def test_the_disc_follows_every_path_in_the_puzzles(path: Path):
    """The engine agrees with the planner, also in corridors as wide as the agent; nothing is pushed on the way."""
    report = check(read_scene(path))
    assert report.all_well
    driven = [approach.drive for approach in report.approaches if approach.drive is not None]
    assert driven
    assert all(drive.reached and drive.moved == () for drive in driven)


@pytest.mark.parametrize("merge", [False, True])
def test_converted_scenes_are_driven_too(merge: bool):  # noqa: FBT001  # a column of the table
    """Turned objects and merged walls; the goal-object can be pushed from the sides that the agent reaches."""
    (level,) = parse_levels(LEVEL, "level.xsb")
    scene = convert_level(level, ConversionSettings(merge_walls=merge, yaw_jitter=0.7, size_jitter=0.3, seed=1))
    report = check(scene, push_distance=0.2)
    assert report.all_well
    assert [approach.target for approach in report.approaches] == ["obj", "obj1", "goal"]
    assert all(approach.drive is not None and approach.drive.reached for approach in report.approaches)
    assert len(report.pushes) == 8
    for push in report.pushes:
        assert push.drive is not None
        moved = next(moved for moved in push.drive.moved if moved.object == push.object)
        along = np.array(moved.end) - np.array(moved.start)
        assert along @ np.array(push.direction) > 0.05


def test_what_no_way_leads_to_is_no_flaw(small_room: Scene):
    """It is reported without a path, and the picture shows it."""
    cage = [replace(small_room.walls[0].at(np.array([x, 1.0])), name=f"side{x}") for x in (-0.5, 0.5)]
    walls = (*small_room.walls, *cage, *(replace(cage[0], name=n, yaw=np.pi / 2).at(np.array(at)) for n, at in
             (("top", [0.0, 2.0]), ("bottom", [0.0, 0.3]))))  # fmt: skip
    report = check(replace(small_room, walls=walls))
    assert report.all_well
    unreached = [approach for approach in report.approaches if approach.path is None]
    assert [approach.target for approach in unreached] == ["obstacle"]
    assert "2 of 3 targets reached" in summary(report)


def test_an_invalid_scene_is_not_driven(small_room: Scene):
    """The problems come first; nothing else is tried."""
    blocked = small_room.objects[0].at(np.array([1.0, 0.0]))
    report = check(replace(small_room, objects=(blocked, small_room.objects[1])), push_distance=0.1)
    assert not report.valid
    assert not report.all_well
    assert (report.approaches, report.pushes) == ((), ())
    assert "overlap" in summary(report)


def test_pictures_are_deterministic(small_room: Scene):
    """Equal reports give equal pictures, and what was found changes them."""
    still, pushed = check(small_room, drives=False), check(small_room, push_distance=0.1)
    images = [paint(report_drawing(small_room, report), 300) for report in (still, pushed, pushed)]
    assert not np.array_equal(images[0], images[1])
    np.testing.assert_array_equal(images[1], images[2])


@pytest.fixture
def folder(tmp_path: Path, small_room: Scene, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working folder, with a scene and its plan."""
    monkeypatch.chdir(tmp_path)
    write_scene(tmp_path / "room.yaml", small_room)
    write_plan(tmp_path / "plan.json", planned(small_room))
    write_scene(tmp_path / "far.yaml", replace(small_room, tolerance=1e-4))
    return tmp_path


def test_the_command_reports_everything(folder: Path):
    """One document; a picture for each scene; the same from several processes."""
    arguments = ["check", "room.yaml", "far.yaml", "--plan", "plan.json", "--push", "0.1", "--picture", "p", "--json"]
    one, two = (CliRunner().invoke(app, [*arguments, "--workers", workers]) for workers in ("1", "2"))
    assert one.exit_code == 0
    assert one.stdout == two.stdout
    room, far = json.loads(one.stdout)["scenes"]
    assert room.keys() == {"scene", "valid", "problems", "reachable", "pushes", "playback"}
    assert (room["playback"]["valid"], room["playback"]["problems"], far["playback"]) == (True, [], None)
    assert [entry["target"] for entry in room["reachable"]] == ["obj", "obstacle", "goal"]
    assert len(room["pushes"]) == 8
    assert {path.name for path in (folder / "p").iterdir()} == {"room.png", "far.png"}


def test_a_plan_that_does_not_play_back_is_a_negative(folder: Path, small_room: Scene):
    """Exit status 1 and what went wrong."""
    plan = planned(small_room)
    write_plan(folder / "bad.json", replace(plan, segments=plan.segments[:1], subgoals=()))
    result = CliRunner().invoke(app, ["check", "room.yaml", "--plan", "bad.json"])
    assert result.exit_code == 1
    assert "outside the goal" in result.stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["far.yaml", "--plan", "plan.json"], "plan.json: made with tolerance 0.001 m"),
        (["room.yaml", "--plan", "plan.json", "--plan", "plan.json"], "plan.json: a second plan for 'small-room'"),
        (["room.yaml", "--push", "-1"], "Invalid value for '--push'"),
    ],
)
def test_what_is_refused(folder: Path, arguments: list[str], message: str):
    """One line and exit status 2."""
    assert folder.is_dir()
    result = CliRunner().invoke(app, ["check", *arguments])
    assert result.exit_code == 2
    assert message in result.stderr
