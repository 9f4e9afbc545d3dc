"""`manipuzzle render` beyond the pictures that test_cli asks for."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import PIL.Image
import pytest
from typer.testing import CliRunner

from converter.formats import write_scene
from converter.plan import Plan, Status, write_plan
from converter.scene import Scene
from evaluate.cli import app
from evaluate.picture_files import WORTH_A_PROCESS
from evaluate.subjects import TILE_PX

LEVELS = """\
; corridor
#######
#@ $ .#
#######

; stuck
#######
#@ .#$#
#######
"""

Render = Callable[..., tuple[int, list[str], str]]


@pytest.fixture
def render(tmp_path: Path, small_room: Scene, small_plan: Plan, monkeypatch: pytest.MonkeyPatch) -> Render:
    """Runs the command where there is an input of each kind; exit status, files written, and stderr."""
    monkeypatch.chdir(tmp_path)
    Path("levels.xsb").write_text(LEVELS)
    write_scene(Path("room.yaml"), small_room)
    plan = replace(small_plan, scene_data=small_room)
    write_plan(Path("plan.json"), plan)
    write_plan(Path("failed.json"), replace(plan, status=Status.TIMEOUT, segments=()))

    def run(*arguments: str) -> tuple[int, list[str], str]:
        result = CliRunner().invoke(app, ["render", *arguments, "--out", "o", "--json"])
        files = [picture["file"] for picture in json.loads(result.stdout)["pictures"]] if result.stdout else []
        assert all(Path(file).stat().st_size > 0 for file in files)
        return result.exit_code, files, result.stderr

    return run


SIGNATURES = {"png": b"\x89PNG", "svg": b"<svg ", "gif": b"GIF8", "mp4": b"ftyp", "html": b"<!DOCTYPE html>"}


@pytest.mark.parametrize("format_", SIGNATURES)
def test_plans_in_every_format(render: Render, format_: str):
    """One file, which is what its name says, and the same each time."""
    files = []
    for _ in range(2):
        status, [file], _ = render("plan.json", "--format", format_)
        assert (status, file) == (0, f"o/plan.{format_}")
        files.append(Path(file).read_bytes())
    assert SIGNATURES[format_] in files[0][:20]
    assert files[0] == files[1]


def test_levels_and_scenes_as_vectors(render: Render):
    """A file for each level and scene."""
    assert render("levels.xsb", "room.yaml", "--format", "svg")[:2] == (
        0,
        ["o/corridor.svg", "o/stuck.svg", "o/room.svg"],
    )


@pytest.mark.parametrize(
    ("inputs", "texts"),
    [
        (["levels.xsb"], ["corridor", "solvable, 2 pushes", "stuck", "not solvable", "2 levels, 1 solvable"]),
        (["room.yaml"], ["room", "valid", "1 scene, 1 valid"]),
        (["failed.json"], ["failed", "timeout", "1 plan, 0 verified"]),
    ],
)
def test_sheets_give_names_and_verdicts(render: Render, inputs: list[str], texts: list[str]):
    """All inputs on one sheet, each with what the product thinks of it."""
    status, files, _ = render(*inputs, "--sheet", "--format", "svg")
    assert (status, files) == (0, ["o/sheet.svg"])
    text = Path("o/sheet.svg").read_text()
    assert all(f">{expected}</text>" in text for expected in texts)


def test_storyboards_have_names_of_their_own(render: Render):
    """They do not replace the plan's picture."""
    assert render("plan.json", "--storyboard")[:2] == (0, ["o/plan-storyboard.png"])


def test_plans_of_one_scene_share_a_page(render: Render, small_room: Scene, small_plan: Plan):
    """The page is called after the scene; a plan alone on its page gives it its own name."""
    other = replace(small_room, name="other", tolerance=0.0)
    write_plan(
        Path("other-plan.json"), replace(small_plan, scene="other", scene_hash=other.geometry_hash, scene_data=other)
    )
    status, files, _ = render("plan.json", "failed.json", "other-plan.json", "--format", "html")
    assert (status, files) == (0, ["o/small-room.html", "o/other-plan.html"])


def test_widths_and_themes_are_as_asked(render: Render):
    """The width in pixels, and other colours."""
    first, second = (
        PIL.Image.open(render("room.yaml", "--width", "200", "--theme", theme)[1][0]).convert("RGB").tobytes()
        for theme in ("paper", "colorblind")
    )
    assert len(first) == len(second) == 200 * 200 * 3
    assert first != second


def test_large_levels_have_smaller_tiles(render: Render):
    """No default asks for more pixels than a picture may have."""
    inside = "\n".join(f"#{' ' * 200}#" for _ in range(200))
    Path("large.xsb").write_text(f"{'#' * 202}\n#@ $.{' ' * 196}#\n{inside}\n{'#' * 202}\n")
    status, [file], _ = render("large.xsb")
    assert status == 0
    with PIL.Image.open(file) as image:
        assert 10 * 202 <= image.width < TILE_PX * 202


def test_many_pictures_are_made_by_several_processes(render: Render):
    """The files are the same as one by one."""
    count = 2 * WORTH_A_PROCESS
    level = LEVELS.split("\n\n", maxsplit=1)[0].replace("; corridor\n", "")
    Path("many.xsb").write_text("\n\n".join(f"; level {i}\n{level}" for i in range(count)))
    _, [single, _], _ = render("levels.xsb")
    status, files, _ = render("many.xsb")
    assert (status, len(files)) == (0, count)
    assert {Path(file).read_bytes() for file in files} == {Path(single).read_bytes()}


BAD = {
    "scene in motion": (["room.yaml", "--format", "mp4"], "room.yaml: mp4 shows plans in motion; draw scenes as png or svg"),
    "page of levels": (["levels.xsb", "--format", "html"], "levels.xsb: html shows plans in motion"),
    "storyboard of a scene": (["room.yaml", "--storyboard"], "room: a scene has no motion; --storyboard shows plans"),
    "storyboard of a failure": (["failed.json", "--storyboard"], "plan for 'small-room': 0 pick-places"),
    "moving sheet": (["plan.json", "--sheet", "--format", "gif"], "--sheet: makes a picture; --format must be png or svg, found gif"),
    "sheet of storyboards": (["plan.json", "--sheet", "--storyboard"], "--sheet: a sheet shows whole plans"),
    "unknown theme": (["plan.json", "--theme", "dark"], "--theme: found 'dark', allowed are paper, colorblind"),
    "endless animation": (["plan.json", "--format", "gif", "--speed", "0.01"], "animation: "),
    "one name twice": (["plan.json", "plan.json"], "inputs: two inputs would be written as 'plan'"),
}  # fmt: skip


@pytest.mark.parametrize(("arguments", "message"), BAD.values(), ids=list(BAD))
def test_what_does_not_fit_is_one_line(render: Render, arguments: list[str], message: str):
    """Exit status 2 and a line that says what would fit."""
    status, files, stderr = render(*arguments)
    assert (status, files, stderr.count("\n")) == (2, [], 1)
    assert stderr.startswith(f"error: {message}")
