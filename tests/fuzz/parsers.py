"""Everything that reads what other people write, as a table: what a file is called, good files, and who reads it.

`test_parsers` mutates the good files blindly, `coverage_guided` by what the parsers do with them. A parser may return,
or raise `InputError` with one line; anything else is a bug.
"""

import contextlib
import json
import sqlite3
import tempfile
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from unittest import mock

import numpy as np

from converter.convert import convert_level
from converter.formats import read_scene
from converter.formats.mjcf import mjcf_text
from converter.formats.pddl import plan_text, problem_text
from converter.formats.rai_g_export import rai_g_text
from converter.formats.scene_yaml import to_document, write_scene_yaml
from converter.plan import Plan, Segment, Status, plan_document, read_plan
from converter.render_scene import scene_drawing
from converter.scene import Agent, Body, Goal, Scene
from converter.shape import Part
from converter.svg import svg_text
from converter.viewer_page import embedded_json, plan_payload
from evaluate.compare import compare, without_times
from evaluate.program import ProgramError, _Exchange, _plan
from evaluate.published import read_times
from evaluate.record import plan_of
from evaluate.references import Reference
from evaluate.specification import read_study
from evaluate.store import FILE_NAME, StoredTrials, TrialStore
from evaluate.study_record import StudyRecord
from evaluate.trial_frame import read_trials, write_parquet
from evaluate.trial_row import TrialRow
from pcg.agents import read_agents
from pcg.errors import InputError
from pcg.frozen import read_frozen
from pcg.learning_curve import read_curve
from pcg.level_set import LEVELS_FILE, MANIFEST_FILE, iter_level_set, read_manifest
from pcg.policy import load_policy
from planner.demonstration import read_demonstration
from planner.verify import verify

ROOT = Path(__file__).parents[2]
DATA = ROOT / "data"

LEVEL = "; corridor\n#######\n#@ $ .#\n#######\n"

STUDY = """\
name: example
scenes:
  - room.yaml
  - {files: "*.xsb", presets: [clear], where: {occluded: false, name: "cor*"}, take: 1}
  - {files: "missing/*.yaml", optional: true}
methods:
  - Rnd+FPR
  - {method: Rnd+FPR, name: wide, set: {candidates: 400}}
  - {method: MBTS, sweep: {time_limit: [1.0, 2.0]}, settings: faithful}
  - {name: program, command: [./their_planner, "{scene}"], options: {depth: 5}}
seeds: 3
time_limit: 1
improve: 0
hard_limit: 2
memory_mb: 4096
"""

FROZEN = "######\n#??.?#\n#? $?#\n######\n"


PREPARED = ("room.yaml", "level.xsb")
"""Files of a folder that specifications may name."""


@dataclass(frozen=True)
class Parser:
    """A kind of file.

    Attributes:
        file: What it is called, in a folder of its own; the folder holds `room.yaml` and `level.xsb` too.
        seeds: Good files.
        read: Reads it and does with the result what commands do, short of planning and drawing pixels.
        words: Pieces of text that mutations should know.
    """

    file: str
    seeds: Callable[[], list[bytes]]
    read: Callable[[Path], object]
    words: tuple[str, ...] = ()


def small_room() -> Scene:
    """A room with a wall, a goal-object of two parts and an obstacle."""
    ell = (Part.box((0.4, 0.2)), Part(np.array([[-0.2, 0.1], [0.0, 0.1], [0.0, 0.3]]), 0.01))
    return Scene(
        name="room",
        bounds=np.array([[-2.0, -2.0], [2.0, 2.0]]),
        tolerance=1e-3,
        agent=Agent(np.array([0.0, -1.0]), 0.2),
        walls=(Body("wall", np.array([1.0, 0.0, 0.1]), 0.2, (Part.box((0.2, 2.0)),), 0.1),),
        objects=(
            Body("obj", np.array([-1.0, 0.0, 0.1]), 0.2, ell, color=(0.0, 0.0, 1.0)),
            Body("obstacle", np.array([0.0, 1.0, 0.1]), 0.2, (Part.box((0.3, 0.3), 0.05),)),
        ),
        goal=Goal("obj", np.array([-1.0, 1.5]), np.array([0.5, 0.4])),
    )


def small_plan() -> Plan:
    """A plan for the room; that it is not valid does not matter."""
    scene = small_room()
    segments = (
        Segment("move", None, np.array([[0.0, -1.0], [-1.0, -1.0], [-1.0, -0.4]])),
        Segment("carry", "obj", np.array([[-1.0, -0.4], [-1.0, 1.1]])),
    )
    return Plan(
        scene="room",
        scene_hash=scene.geometry_hash,
        method="by hand",
        seed=0,
        status=Status.SOLVED,
        time_s=0.5,
        tolerance=1e-3,
        settings={"time_limit": 1.0},
        counters={"nodes": 3},
        segments=segments,
        scene_data=scene,
    )


def trial_row(**changes: object) -> TrialRow:
    """A row of a study's database."""
    values = {
        "key": "00aa",
        "scene": "room",
        "scene_hash": small_room().geometry_hash,
        "method": "Rnd+FPR",
        "seed": 0,
        "settings": json.dumps({"time_limit": 10.0, "preset": "fast"}),
        "settings_hash": "m0",
        "status": "solved",
        "verified": True,
        "time_s": 0.5,
        "path_length_m": 3.0,
        "pick_places": 1,
        "counters": json.dumps({"subgoal_time_s": 0.1, "accepted": 1}),
        "message": None,
        "plan": zlib.compress(json.dumps(plan_document(small_plan())).encode()),
        "versions": '{"manipuzzle": "0"}',
        "machine": "a machine",
        "started": "2026-01-01T10:00:00.000+00:00",
        "finished": "2026-01-01T11:00:00.000+00:00",
    }
    return TrialRow(**{**values, **changes})  # type: ignore[arg-type]  # tests put anything into rows


def write_store(folder: Path, *rows: TrialRow, name: str = "a study") -> Path:
    """A study's folder with these rows, all of them on `small_room`."""
    scene = small_room()
    with TrialStore(folder) as store:
        store.add_scenes([scene])
        for row in rows:
            store.add(row)
        scenes = tuple(dict.fromkeys((row.scene, row.scene_hash) for row in rows))
        methods = tuple(dict.fromkeys((row.method, row.settings_hash) for row in rows))
        store.set_study(StudyRecord(name, scenes, methods, tuple(sorted({row.seed for row in rows})), len(rows)))
    return folder


@cache
def store_bytes() -> bytes:
    """A small study's database as the bytes of one file."""
    with tempfile.TemporaryDirectory() as folder:
        unsolved = trial_row(key="01bb", seed=1, status="timeout", verified=None, plan=None)
        write_store(Path(folder), trial_row(), unsolved)
        with contextlib.closing(sqlite3.connect(Path(folder) / FILE_NAME)) as connection:
            connection.execute("PRAGMA journal_mode = DELETE")
        return (Path(folder) / FILE_NAME).read_bytes()


def prepare_folder(folder: Path) -> None:
    """Writes the files of `PREPARED`."""
    room, level = PREPARED
    write_scene_yaml(folder / room, small_room())
    (folder / level).write_text(LEVEL)


def _read_levels(path: Path) -> None:
    for i, level in enumerate(iter_level_set(path)):
        if level.tiles.size <= 100 and i < 10:
            convert_level(level)


def _read_manifest(path: Path) -> None:
    (path.parent / LEVELS_FILE).write_text(LEVEL)
    read_manifest(path)
    list(iter_level_set(path.parent))


def _read_scene(path: Path) -> None:
    scene = read_scene(path)
    if len(scene.walls) + len(scene.objects) > 100:
        return
    assert to_document(scene)["name"] == scene.name
    rai_g_text(scene)
    mjcf_text(scene)
    problem_text(scene)
    svg_text(scene_drawing(scene), 100, title=scene.name)


def _read_plan(path: Path) -> None:
    plan = read_plan(path)
    json.dumps(plan_document(plan), allow_nan=False)
    scene = plan.scene_data or small_room()
    if len(scene.walls) + len(scene.objects) > 100 or sum(len(segment.path) for segment in plan.segments) > 1000:
        return
    verify(scene, plan)
    embedded_json(plan_payload(scene, plan))
    plan_text(scene, plan)


def _read_answer(path: Path) -> None:
    # A failing program is a trial that failed, with a line about why.
    with contextlib.suppress(ProgramError):
        plan = _plan(_Exchange(path.parent).read(), small_room(), 0, 1.0)
        json.dumps(plan_document(plan), allow_nan=False)
        verify(small_room(), plan)


def _read_study(path: Path) -> None:
    # A study's author may name any function, which is imported; inputs made by chance must not.
    with mock.patch.object(Reference, "load", return_value=print):
        study = read_study(path)
    if study.size < 1000:
        assert sum(1 for _ in study.trials()) == study.size
        study.record()


def _read_store(path: Path) -> None:
    with StoredTrials(path.parent) as store, StoredTrials(path.parent) as again:
        rows = list(store.rows())
        for row in rows:
            plan_of(row)
            without_times(row)
        list(store.scenes())
        store.study()
        compare(store, again)
    read_trials(path.parent)
    write_parquet(path.parent, path.parent / "trials.parquet")


def _files(*patterns: str) -> list[bytes]:
    return [path.read_bytes() for pattern in patterns for path in sorted(DATA.glob(pattern))]


def _scene_seeds() -> list[bytes]:
    return [_written(".yaml"), *_files("puzzles/cube-free.yaml", "puzzles/wall.yaml")]


def _written(suffix: str) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"room{suffix}"
        if suffix == ".g":
            path.write_text(rai_g_text(small_room()))
        else:
            write_scene_yaml(path, small_room())
        return path.read_bytes()


def _rai_seeds() -> list[bytes]:
    handmade = b"""\
world {}
floor (world) { shape:ssBox, size:[4 4 .1 .02], Q:<t(0 0 -.05)>, tolerance:0.001 }
egoJoint (world) { Q:[0 -1 .1] }
ego (egoJoint) { shape:ssCylinder, size:[.2 .2 .02], joint:transXY, contact:1 }
w (world) { shape:ssBox, Q:<t(1 0 .1) d(90 0 0 1)>, size:[.2 2 .2 .02], contact:1, color:[1 0 0] }
obj (world) { joint:rigid, shape:ssBox, Q:<t(-1 0 .1) q(1 0 0 0)> size:[.2 .2 .2 .02], contact:1 ] }
goal (world) { shape:ssBox, size:[.3 .3 .1 .02], Q:[1 1 0 1 0 0 0] }
"""
    return [_written(".g"), handmade]


def _plan_seeds() -> list[bytes]:
    return [json.dumps(plan_document(small_plan())).encode()]


def _answer_seeds() -> list[bytes]:
    document = plan_document(small_plan())
    return [json.dumps({"status": "solved", "segments": document["segments"], "counters": {"nodes": 3}}).encode()]


def _manifest_seeds() -> list[bytes]:
    lines = (DATA / "corpus" / MANIFEST_FILE).read_bytes().splitlines(keepends=True)
    return [b"".join(lines[:2]), lines[0].replace(b'"m0-', b'"corridor", "x": "')]


_YAML_WORDS = ("&a", "*a", "!!python/object", "<<:", "1e999", ".nan", "-.inf", "null", "~", "[", "{", "- ", "? ", "|")
_JSON_WORDS = ("NaN", "Infinity", "-Infinity", "1e999", "null", "true", '"\\ud800"', "[[", "{}", "-1", "1e308")

PARSERS = {
    "levels": Parser("a.xsb", lambda: [LEVEL.encode(), b"\n\n".join(_files("corpus/levels.xsb")[0].split(b"\n\n")[:3])], _read_levels, ("#", "Title:", ";", "\r\n", "\t", "_")),
    "manifest": Parser(MANIFEST_FILE, _manifest_seeds, _read_manifest, _JSON_WORDS),
    "frozen": Parser("a.txt", lambda: [FROZEN.encode()], read_frozen, ("#", "?")),
    "agents": Parser("agents.yaml", lambda: _files("agents.yaml"), read_agents, _YAML_WORDS),
    "policy": Parser("a.onnx", lambda: _files("policies/narrow.onnx"), load_policy),
    "curve": Parser("curve.jsonl", lambda: [_files("policies/narrow.curve.jsonl")[0][:1000]], read_curve, _JSON_WORDS),
    "scene-yaml": Parser("a.yaml", _scene_seeds, _read_scene, (*_YAML_WORDS, "polygon", "parts", "yaw", "offset")),
    "scene-g": Parser("a.g", _rai_seeds, _read_scene, ("Include", "'", "<t(", "d(", "q(", "shape:ssBox", "Q:", "X:", "core:", "joint:", "1e999", "nan")),
    "plan": Parser("a.json", _plan_seeds, _read_plan, (*_JSON_WORDS, "carry", "move")),
    "answer": Parser("stdout", _answer_seeds, _read_answer, (*_JSON_WORDS, "carry", "move", "exhausted")),
    "demonstration": Parser("a.yaml", lambda: _files("human/wall.yaml"), read_demonstration, _YAML_WORDS),
    "study": Parser("study.yaml", lambda: [STUDY.encode()], _read_study, (*_YAML_WORDS, "sweep", "${HOME}", "**", "presets", "take", "where", "max", "options")),
    "published": Parser("a.csv", lambda: _files("published/table1.csv"), read_times, ('"', "nan", "1e999")),
    "store": Parser(FILE_NAME, lambda: [store_bytes()], _read_store),
}  # fmt: skip
"""All parsers by name."""


def complaint(parser: Parser, data: bytes, folder: Path) -> str | None:
    """What the parser says about a file with these bytes; None if it reads it.

    Args:
        parser: One of `PARSERS`.
        data: The file.
        folder: Where it is put; see `prepare_folder`.
    """
    for left_over in folder.iterdir():
        if left_over.name not in PREPARED:
            left_over.unlink()
    path = folder / parser.file
    path.write_bytes(data)
    try:
        parser.read(path)
    except InputError as error:
        return str(error)
    return None
