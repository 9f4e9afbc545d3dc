import copy
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings

from converter.formats.json_schema import PLAN_FILE, SCENE_FILE, plan_schema, scene_schema, write_schemas
from converter.formats.scene_yaml import from_document, to_document
from converter.plan import Plan, plan_document, plan_from_document
from converter.scene import Scene
from pcg import yaml_text
from pcg.errors import InputError

DATA = Path(__file__).parents[2] / "data"
PUZZLES = sorted((DATA / "puzzles").glob("*.yaml"))
GOLDEN = Path(__file__).parents[1] / "golden"

TYPES: dict[str, Callable[[Any], bool]] = {
    "object": lambda value: isinstance(value, dict),
    "array": lambda value: isinstance(value, list),
    "string": lambda value: isinstance(value, str),
    "null": lambda value: value is None,
    "integer": lambda value: isinstance(value, int) and not isinstance(value, bool),
    "number": lambda value: isinstance(value, (int, float)) and not isinstance(value, bool),
}
NOTES = {"title", "description", "default", "$defs", "$schema", "$id"}


def fits(value: Any, schema: Any, root: dict[str, Any]) -> bool:
    """Whether a value follows a JSON Schema, by the standard's definition of the keywords that ours use.

    An unknown keyword fails the test instead of being ignored.
    """
    if isinstance(schema, bool):
        return schema
    unknown = schema.keys() - KEYWORDS.keys() - NOTES
    assert not unknown, f"unknown keywords {unknown}"
    return all(KEYWORDS[keyword](value, schema[keyword], schema, root) for keyword in schema.keys() - NOTES)


def referenced(value: Any, name: str, _schema: Any, root: dict[str, Any]) -> bool:
    """`$ref`: a definition of the same file, or the other file."""
    if name == SCENE_FILE:
        return fits(value, scene_schema(), scene_schema())
    return fits(value, root["$defs"][name.removeprefix("#/$defs/")], root)


def other_properties(value: Any, wanted: Any, schema: dict[str, Any], root: dict[str, Any]) -> bool:
    """`additionalProperties`."""
    known = schema.get("properties", {})
    return not isinstance(value, dict) or all(fits(v, wanted, root) for k, v in value.items() if k not in known)


def of(kind: str, holds: Callable[[Any, Any], bool]) -> Callable[..., bool]:
    """A keyword that only concerns values of one type."""
    return lambda value, wanted, *_: not TYPES[kind](value) or holds(value, wanted)


KEYWORDS: dict[str, Callable[[Any, Any, Any, Any], bool]] = {
    "$ref": referenced,
    "type": lambda value, wanted, *_: TYPES[wanted](value),
    "const": lambda value, wanted, *_: value == wanted,
    "enum": lambda value, wanted, *_: value in wanted,
    "anyOf": lambda value, wanted, _, root: any(fits(value, option, root) for option in wanted),
    "oneOf": lambda value, wanted, _, root: sum(fits(value, option, root) for option in wanted) == 1,
    "not": lambda value, wanted, _, root: not fits(value, wanted, root),
    "minimum": of("number", lambda value, wanted: value >= wanted),
    "maximum": of("number", lambda value, wanted: value <= wanted),
    "minLength": of("string", lambda value, wanted: len(value) >= wanted),
    "maxLength": of("string", lambda value, wanted: len(value) <= wanted),
    "minItems": of("array", lambda value, wanted: len(value) >= wanted),
    "maxItems": of("array", lambda value, wanted: len(value) <= wanted),
    "required": of("object", lambda value, wanted: set(wanted) <= set(value)),
    "properties": lambda value, wanted, _, root: (
        not isinstance(value, dict) or all(fits(value[k], s, root) for k, s in wanted.items() if k in value)
    ),
    "additionalProperties": other_properties,
    "prefixItems": lambda value, wanted, _, root: (
        not isinstance(value, list) or all(fits(v, s, root) for v, s in zip(value, wanted, strict=False))
    ),
    "items": lambda value, wanted, _, root: (
        not isinstance(value, list) or all(fits(item, wanted, root) for item in value)
    ),
}


def valid(value: Any, schema: dict[str, Any]) -> bool:
    """Whether a document follows a schema."""
    return fits(json.loads(json.dumps(value)), schema, schema)


def test_the_committed_schemas_are_those_of_the_models(tmp_path: Path):
    """After a change of the models: `python -m converter.formats.json_schema data/schema`."""
    write_schemas(tmp_path)
    assert sorted(path.name for path in (DATA / "schema").iterdir()) == sorted([SCENE_FILE, PLAN_FILE])
    for path in tmp_path.iterdir():
        assert (DATA / "schema" / path.name).read_text() == path.read_text()


@pytest.mark.parametrize("path", [*PUZZLES, GOLDEN / "level-to-scene.yaml"], ids=lambda path: path.stem)
def test_the_shipped_scenes_are_valid(path: Path):
    """As they stand in their files."""
    assert valid(yaml_text.parse(path.read_text(), str(path)), scene_schema())


@pytest.mark.parametrize("preset", ["clear", "published"])
def test_plan_files_are_valid(preset: str):
    """With the scene that they hold."""
    assert valid(json.loads((GOLDEN / f"maze-{preset}-plan.json").read_text()), plan_schema())


@settings(max_examples=25)
@given(scene=...)
def test_what_is_written_is_valid(scene: Scene):
    """Whatever the bodies are made of."""
    assert valid(to_document(scene), scene_schema())


SCENE_ERRORS: list[tuple[str, Callable[[dict[str, Any]], Any]]] = [
    ("format", lambda d: d.update(format=2)),
    ("no format", lambda d: d.pop("format")),
    ("no agent", lambda d: d.pop("agent")),
    ("no objects", lambda d: d.update(objects=[])),
    ("another field", lambda d: d.update(colour="red")),
    ("another field of a body", lambda d: d["walls"][0].update(mass=1.0)),
    ("preset", lambda d: d.update(preset="wide")),
    ("tolerance", lambda d: d.update(tolerance=-1.0)),
    ("text for a number", lambda d: d.update(tolerance="0.1")),
    ("truth for a number", lambda d: d["agent"].update(radius=True)),
    ("zero radius", lambda d: d["agent"].update(radius=0)),
    ("far away", lambda d: d["walls"][0].update(position=[0, 0, 1e9])),
    ("two numbers for three", lambda d: d["walls"][0].update(position=[0, 0])),
    ("four numbers for three", lambda d: d["walls"][0].update(position=[0, 0, 0, 0])),
    ("no name", lambda d: d["walls"][0].update(name="")),
    ("long name", lambda d: d["walls"][0].update(name="x" * 201)),
    ("no outline", lambda d: d["walls"][0].pop("size")),
    ("two outlines", lambda d: d["walls"][0].update(polygon=[[0, 0], [1, 0], [0, 1]])),
    ("two heights", lambda d: d["walls"][0].update(height=1.0)),
    ("no height", lambda d: (d["walls"][0].pop("size"), d["walls"][0].update(polygon=[[0, 0], [1, 0], [0, 1]]))),
    ("colour", lambda d: d["objects"][0].update(color=[0, 0, 2])),
    ("no list", lambda d: d.update(walls={})),
    ("null", lambda d: d.update(goal=None)),
]


@pytest.mark.parametrize(("name", "change"), SCENE_ERRORS, ids=lambda value: value if isinstance(value, str) else "")
def test_schema_and_reader_refuse_the_same(small_room: Scene, name: str, change: Callable[[dict[str, Any]], Any]):
    """A document with one error is refused by both; the reader names file and field."""
    document = copy.deepcopy(to_document(small_room))
    assert valid(document, scene_schema())
    change(document)
    assert not valid(document, scene_schema()), name
    with pytest.raises(InputError, match=r"^room\.yaml: \S"):
        from_document(document, "room.yaml")


PLAN_ERRORS: list[tuple[str, Callable[[dict[str, Any]], Any]]] = [
    ("status", lambda d: d.update(status="done")),
    ("no hash", lambda d: d.pop("scene_hash")),
    ("mode", lambda d: d["segments"][0].update(mode="fly")),
    ("point", lambda d: d["segments"][0].update(path=[[0.0]])),
    ("seed", lambda d: d.update(seed="zero")),
    ("scene", lambda d: d["scene_data"].update(format=0)),
    ("another field", lambda d: d.update(cost_per_hour=1)),
]


@pytest.mark.parametrize(("name", "change"), PLAN_ERRORS, ids=lambda value: value if isinstance(value, str) else "")
def test_schema_and_reader_refuse_the_same_plans(name: str, change: Callable[[dict[str, Any]], Any]):
    """As for scenes."""
    document = json.loads((GOLDEN / "maze-clear-plan.json").read_text())
    change(document)
    assert not valid(document, plan_schema()), name
    with pytest.raises(InputError, match=r"^plan\.json: \S"):
        plan_from_document(document, "plan.json")


def test_plans_without_a_scene_are_valid(small_plan: Plan):
    """The scene is optional."""
    assert valid(plan_document(small_plan), plan_schema())
