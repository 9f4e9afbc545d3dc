"""Whatever is in a file, its parser reads it or refuses it with one line: mutated good files, and files made to hurt."""

import contextlib
import json
import os
import re
import sqlite3
import tempfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from converter.plan import plan_document
from evaluate.store import FILE_NAME, StoredTrials, TrialStore
from pcg.errors import InputError
from tests.fuzz.parsers import PARSERS, complaint, prepare_folder, small_plan, store_bytes, trial_row, write_store

# A place as a share of the file, how many bytes go there, and which word or bytes come instead.
CHANGES = st.lists(
    st.tuples(st.floats(0, 1, exclude_max=True), st.integers(0, 40), st.integers(0, 1 << 16), st.binary(max_size=3)),
    min_size=1,
    max_size=4,
)
SLOW_TO_READ = {"policy": 15, "store": 25, "agents": 25, "study": 40}
"""Examples of parsers that take milliseconds."""


@pytest.fixture(scope="module")
def folder() -> Any:
    """A folder for one file after the other."""
    with tempfile.TemporaryDirectory() as name:
        prepare_folder(Path(name))
        yield Path(name)


def require_one_line(problem: str | None, file: str) -> None:
    """Messages are one printable line of bounded length that names the file."""
    if problem is not None:
        assert problem.isprintable()
        assert len(problem) <= 1000
        assert file.split(".", maxsplit=1)[0] in problem or ":" in problem


@pytest.mark.parametrize("name", PARSERS)
def test_mutated_files_are_read_or_refused(name: str, folder: Path):
    """Bytes and words replaced anywhere in good files, and files cut short."""
    parser, seeds = PARSERS[name], PARSERS[name].seeds()
    words = [word.encode() for word in parser.words] or [b"\0"]

    @settings(max_examples=SLOW_TO_READ.get(name, 60), database=None)
    @given(st.sampled_from(seeds), CHANGES, st.floats(0.5, 1))
    def run(data: bytes, changes: list[tuple[float, int, int, bytes]], share: float) -> None:
        for place, length, word, raw in changes:
            start = int(place * len(data))
            data = data[:start] + (raw or words[word % len(words)]) + data[start + length :]
        if share < 0.6:
            data = data[: int(share * len(data))]
        require_one_line(complaint(parser, data, folder), parser.file)

    run()


@pytest.mark.parametrize("name", PARSERS)
def test_good_files_are_read(name: str, folder: Path):
    """The seeds of all this are good: a parser that refuses everything would pass the rest."""
    assert complaint(PARSERS[name], PARSERS[name].seeds()[0], folder) is None


JSON_VALUES = st.recursive(
    st.none() | st.booleans() | st.integers(-(10**20), 10**20) | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=5,
)


def places_in(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Where the values of a document are."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [path, *(place for key, item in items for place in places_in(item, (*path, key)))]


def with_value(document: Any, place: tuple[Any, ...], value: Any) -> Any:
    """The document with another value at one place."""
    if not place:
        return value
    copy = dict(document) if isinstance(document, dict) else list(document)
    copy[place[0]] = with_value(copy[place[0]], place[1:], value)
    return copy


@settings(max_examples=100, database=None)
@given(data=st.data())
def test_plans_with_any_value_in_any_place(data: st.DataObject):
    """A plan's document with one value replaced by any other that JSON has, NaN and halves of characters included."""
    document = plan_document(small_plan())
    place = data.draw(st.sampled_from(places_in(document)))
    text = json.dumps(with_value(document, place, data.draw(JSON_VALUES)))
    with tempfile.TemporaryDirectory() as name:
        require_one_line(complaint(PARSERS["plan"], text.encode(), Path(name)), "a.json")
        require_one_line(complaint(PARSERS["answer"], text.encode(), Path(name)), "stdout")


def deep(levels: int) -> bytes:
    """Lists in lists."""
    return b"[" * levels + b"]" * levels


def plan_with(**changes: Any) -> bytes:
    """A plan with other values; the text X stands for JSON that Python does not write."""
    return json.dumps(plan_document(small_plan()) | changes).encode()


def first_seed(name: str) -> bytes:
    """A good file."""
    return PARSERS[name].seeds()[-1]


SCENE = (
    b"format: 1\nbounds: [[-2, -2], [2, 2]]\ntolerance: 0.001\nagent: {position: [0, -1], radius: 0.1}\n"
    b"goal: {object: obj, position: [0, 0], size: [1, 1]}\nobjects:\n- {name: obj, position: [1, 1, 0.1], size: [1, 1, 1]}\n"
)
STUDY = b"name: a\nscenes: [room.yaml]\nseeds: 1\nmethods: "
HURTING: dict[str, tuple[str, Callable[[], bytes], str]] = {
    "a list of millions": ("scene-yaml", lambda: b"a: [" + b"0," * 600_000 + b"]", "more than 500000 values"),
    "a million keys": ("scene-yaml", lambda: b"".join(b"k%d: 1\n" % i for i in range(260_000)), "500000 values"),
    "a million objects": (
        "scene-yaml",
        lambda: SCENE + b"".join(b"- {name: %d, position: [0, 0, 0], size: [1, 1, 1]}\n" % i for i in range(1_000_000)),
        "larger than 8 MB",
    ),
    "deep YAML": ("scene-yaml", lambda: deep(100_000), "nested deeper than 20"),
    "aliases": ("scene-yaml", lambda: b"a: &a [x, x]\nb: &b [*a, *a]\nc: [*b, *b]\n", "aliases are not allowed"),
    "a tag": ("scene-yaml", lambda: b"!!python/object/apply:os.system ['true']", "tags are not allowed"),
    "many documents": ("scene-yaml", lambda: b"---\n" * 300_000, "more than 500000 values|another document"),
    "infinity in free values": ("scene-yaml", lambda: SCENE + b"source: {a: .inf}\n", "finite"),
    "nesting in free values": ("plan", lambda: plan_with(settings={"a": "X"}).replace(b'"X"', deep(900)), "nested deeper"),
    "NaN in free values": ("plan", lambda: plan_with(settings={"a": float("nan")}), "settings: every number must be finite"),
    "half a character": ("plan", lambda: plan_with(method="\ud800"), "method"),
    "half a character in free values": ("plan", lambda: plan_with(settings={"\udfff": 1}), "settings: text must be Unicode"),
    "half a character in a certificate": ("plan", lambda: plan_with(certificate="\udfff"), "certificate"),
    "an escape sequence": ("plan", lambda: plan_with(scene="\x1b[31m"), "scene: a name must be printable"),
    "a deep value in the wrong place": ("plan", lambda: plan_with(seed="X").replace(b'"X"', deep(900)), "seed"),
    "many segments": ("plan", lambda: plan_with(segments=[{"mode": "move", "path": [[0, 0]]}] * 10_001), "10000 items"),
    "many digits": ("plan", lambda: plan_with(seed="X").replace(b'"X"', b"9" * 9999), "digits"),
    "a large plan": ("plan", lambda: b"[" + b"[]," * 7_000_000 + b"[]]", "larger than 20 MB"),
    "a pose of blanks": ("scene-g", lambda: b"floor { size:[1 1 1 0] X:<" + b" " * 100_000 + b"> }", "floor|goal"),
    "a pose of many factors": ("scene-g", lambda: b"floor { shape:ssBox size:[1 1 1 0] X:<" + b"t(0 0 0)" * 101 + b"> }", "100 factors"),
    "infinite minus infinite": (
        "scene-g",
        lambda: b"far { Q:[1e999 0 0] }\n" + first_seed("scene-g").replace(b"(world)", b"(far)"),
        "pose",
    ),
    "an infinite quaternion": ("scene-g", lambda: first_seed("scene-g").replace(b"q(1 0 0 0)", b"q(1e999 0 0 1e999)"), "pose"),
    "an escape sequence as a name": ("scene-g", lambda: b"\x1b[31m {}", r"unexpected '\\x1b'"),
    "a long name": ("scene-g", lambda: b"a" * 1_000_000 + b" {}", "at most 200 characters"),
    "a file name too long to include": ("scene-g", lambda: b"Include '" + b"a" * 5000 + b"'", "does not exist"),
    "a file name with a NUL": ("scene-g", lambda: b"Include 'a\0b'", "unexpected"),
    "millions of brackets": ("scene-g", lambda: b"]" * 450_000, "more than 400000 words"),
    "a core of many points": (
        "scene-g",
        lambda: b"floor { shape:ssCvx size:[.1] core:[" + b"0 0 0 " * 2001 + b"] }",
        "more than 2000 points",
    ),
    "rows without end": ("levels", lambda: b"#\n" * 1_000_000, "at most 1000 x 1000"),
    "a line without end": ("levels", lambda: b"#" * 10_000_000, "at most 1000 x 1000"),
    "a large level file": ("levels", lambda: b" " * 20_000_001, "larger than 20 MB"),
    "a long record": ("manifest", lambda: b"[" + b"[]," * 1_000_000 + b"]", "line 1: longer than 1 MB"),
    "a deep record": ("manifest", lambda: deep(100_000), "nested too deeply"),
    "millions of records": ("manifest", lambda: b"\n" * 1_000_001, "more than 1000000 lines"),
    "a long field": ("published", lambda: first_seed("published") + b"x" * 200_000 + b",a,1,1,1,1\n", "field"),
    "seeds without end": ("study", lambda: b"name: a\nscenes: [room.yaml]\nmethods: [Rnd+R]\nseeds: 999999999\n", "seeds"),
    "an escape sequence in a title": ("study", lambda: b'name: "\\e[31m"\n' + STUDY[8:] + b"[Rnd+R]", "name"),
    "an escape sequence in a method": ("study", lambda: STUDY + b'[{method: Rnd+R, name: "\\e"}]', r"methods\[0\].name"),
    "patterns in patterns": ("study", lambda: STUDY.replace(b"room.yaml", b"'**/**/*'") + b"[Rnd+R]", r"more than one \*\*"),
    "candidates without end": ("study", lambda: STUDY + b"[{method: Rnd+R, set: {candidates: 99999999999}}]", "at most 1000000"),
    "methods without end": (
        "study",
        lambda: STUDY + b"".join(b"\n- {method: Rnd+R, name: m%d, sweep: {candidates: [%s], expansions: [%s]}}" % (
            i, b",".join(b"%d" % j for j in range(1, 72)), b",".join(b"%d" % j for j in range(1, 72))) for i in range(2)),
        "more than 10000",
    ),
}  # fmt: skip
"""A parser, a file, and what has to be said about it."""


@pytest.mark.parametrize("name", HURTING)
def test_files_made_to_hurt_are_refused(name: str, folder: Path):
    """Large, deep, endless, infinite, unprintable: one line says which of it."""
    parser, make, expected = HURTING[name]
    problem = complaint(PARSERS[parser], make(), folder)
    assert problem is not None
    require_one_line(problem, PARSERS[parser].file)
    assert re.search(expected, problem)


def changed_store(*statements: tuple[str, tuple[object, ...]]) -> bytes:
    """A database after some SQL."""
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / FILE_NAME
        path.write_bytes(store_bytes())
        with contextlib.closing(sqlite3.connect(path)) as connection:
            for statement, parameters in statements:
                connection.execute(statement, parameters)
            connection.commit()
        return path.read_bytes()


BOMB = zlib.compress(b" " * (1 << 28))
ENDLESS = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT * FROM n"
FOREIGN: dict[str, tuple[tuple[str, tuple[object, ...]], ...]] = {
    "another table": (("CREATE TABLE t (a)", ()),),
    "an endless view": (("ALTER TABLE trial RENAME TO t", ()), (f"CREATE VIEW trial AS {ENDLESS}", ())),
    "a trigger": (("CREATE TRIGGER t AFTER INSERT ON trial BEGIN DELETE FROM trial; END", ()),),
    "a plan that unfolds": (("UPDATE trial SET plan = ? WHERE plan NOT NULL", (BOMB,)),),
    "a plan that is none": (("UPDATE trial SET plan = ? WHERE plan NOT NULL", (zlib.compress(b"[]"),)),),
    "a plan without counters": (("UPDATE trial SET plan = ? WHERE plan NOT NULL", (zlib.compress(b"{}"),)),),
    "counters that are none": (("UPDATE trial SET counters = '[]'", ()),),
    "settings that are none": (("UPDATE trial SET settings = '[]'", ()),),
    "an infinite time": (("UPDATE trial SET time_s = 9e999", ()),),
    "a study of numbers": (("UPDATE study SET document = ?", (zlib.compress(b'{"name": 1}'),)),),
    "a study that unfolds": (("UPDATE study SET document = ?", (BOMB,)),),
    "a large seed": (
        (
            "UPDATE study SET document = ?",
            (zlib.compress(b'{"name": "a", "scenes": [], "methods": [], "seeds": [1%030d], "trials": 1}' % 0),),
        ),
    ),
    "a scene that is none": (("UPDATE scene SET document = ?", (zlib.compress(deep(100_000)),)),),
    "text that is none": (("UPDATE trial SET scene = CAST(x'ff00fe' AS TEXT)", ()),),
}


@pytest.mark.parametrize("name", FOREIGN)
def test_foreign_databases_are_refused(name: str, folder: Path):
    """Tables that are not ours, and documents that are not what they should be."""
    problem = complaint(PARSERS["store"], changed_store(*FOREIGN[name]), folder)
    assert problem is not None
    require_one_line(problem, FILE_NAME)


@pytest.mark.parametrize("name", [".lock", FILE_NAME, f"{FILE_NAME}-wal", f"{FILE_NAME}-shm"])
def test_links_in_a_folder_are_not_written_through(name: str, tmp_path: Path):
    """Whoever made a results folder could have its files point anywhere."""
    victim = tmp_path / "victim"
    victim.write_text("kept")
    write_store(tmp_path / "study", trial_row())
    (tmp_path / "study" / name).unlink(missing_ok=True)
    (tmp_path / "study" / name).symlink_to(victim)
    with pytest.raises(InputError, match="symbolic link"):
        TrialStore(tmp_path / "study")
    assert victim.read_text() == "kept"


@pytest.mark.parametrize("name", [".lock", FILE_NAME, f"{FILE_NAME}-wal"])
def test_pipes_in_a_folder_are_not_waited_for(name: str, tmp_path: Path):
    """Opening one would never end."""
    write_store(tmp_path / "study", trial_row())
    (tmp_path / "study" / name).unlink(missing_ok=True)
    os.mkfifo(tmp_path / "study" / name)
    with pytest.raises(InputError, match="named pipe"):
        TrialStore(tmp_path / "study")


def test_what_was_computed_survives_refusal(tmp_path: Path):
    """A damaged part of a database costs nothing else: the other rows are still there."""
    study = write_store(tmp_path, trial_row(), trial_row(key="01bb", seed=1))
    with contextlib.closing(sqlite3.connect(study / FILE_NAME)) as connection:
        connection.execute("UPDATE trial SET plan = x'00' WHERE seed = 1")
        connection.execute("UPDATE study SET document = x'00'")
        connection.commit()
    with StoredTrials(study) as store:
        with pytest.raises(InputError, match="damaged"):
            store.study()
        assert [row.seed for row in store.rows()] == [0, 1]
