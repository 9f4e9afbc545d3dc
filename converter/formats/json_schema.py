"""JSON Schemas of our own files, for editors and for programs in other languages.

They are generated from the models that read the files, so they cannot differ from them: `python -m
converter.formats.json_schema data/schema` writes them anew. What a schema cannot say is checked by the readers only:
that polygons are convex, names printable and unique, the goal-object there, and lines of a plan joined.
"""

import json
import sys
from pathlib import Path
from typing import Any

from converter.formats.scene_yaml import SceneDocument
from converter.plan import PlanDocument
from pcg.files import write_text

DIALECT = "https://json-schema.org/draft/2020-12/schema"
SCENE_FILE = "scene.schema.json"
PLAN_FILE = "plan.schema.json"


def scene_schema() -> dict[str, Any]:
    """The schema of scene files (YAML)."""
    return _schema(SCENE_FILE, "manipuzzle scene", SceneDocument.model_json_schema())


def plan_schema() -> dict[str, Any]:
    """The schema of plan files (JSON); the scene in them follows `scene_schema`."""
    schema = _schema(PLAN_FILE, "manipuzzle plan", PlanDocument.model_json_schema())
    schema["properties"]["scene_data"] = {"anyOf": [{"$ref": SCENE_FILE}, {"type": "null"}], "default": None}
    return schema


def write_schemas(folder: Path) -> None:
    """Writes all schemas into a folder.

    Raises:
        InputError: it cannot be written to.
    """
    for schema in (scene_schema(), plan_schema()):
        write_text(folder / schema["$id"], json.dumps(schema, indent=1) + "\n")


def _schema(file: str, title: str, generated: dict[str, Any]) -> dict[str, Any]:
    return {"$schema": DIALECT, "$id": file, **generated, "title": title}


if __name__ == "__main__":
    write_schemas(Path(sys.argv[1]))
