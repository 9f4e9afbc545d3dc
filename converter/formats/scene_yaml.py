"""The scene file: YAML that people read and write, one body a line.

Lengths in metres, angles in radians; z = 0 is the floor and the z of a `position` the middle of the height.
`body_document` says how bodies are given. The same plain values stand in plan files.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from converter.formats.body_document import BodyDocument, Length, Name, Number, Radius, from_body, short, to_body
from converter.scene import Agent, Goal, Scene
from converter.shape import FloatArray
from pcg import yaml_text
from pcg.errors import InputError
from pcg.files import read_text, write_text
from pcg.validation import Document, PlainValues, validated

MAX_BYTES = 8_000_000
MAX_BODIES = 10_000


class AgentDocument(Document):
    """The disc that grasps and carries; it stands on the floor."""

    position: tuple[Number, Number]
    radius: Length
    height: Length = 0.2


class GoalDocument(Document):
    """The axis-aligned rectangle in which the centre of `object` has to come to rest."""

    object: str
    position: tuple[Number, Number]
    size: tuple[Length, Length]


class SceneDocument(Document):
    """A manipulation puzzle: lengths in metres, angles in radians, z = 0 is the floor."""

    format: Literal[1]
    name: Name | None = None
    preset: Literal["clear", "published"] | None = None
    bounds: tuple[tuple[Number, Number], tuple[Number, Number]]
    tolerance: Radius
    agent: AgentDocument
    walls: Annotated[tuple[BodyDocument, ...], Field(max_length=MAX_BODIES)] = ()
    objects: Annotated[tuple[BodyDocument, ...], Field(min_length=1, max_length=MAX_BODIES)]
    goal: GoalDocument
    source: PlainValues = Field(default_factory=dict)


def read_scene_yaml(path: Path) -> Scene:
    """Reads and validates a scene file; a scene without a name gets the stem of its file.

    Raises:
        InputError: naming file, field or line, and reason.
    """
    return from_document(yaml_text.parse(read_text(path, MAX_BYTES), str(path)), str(path), path.stem)


def write_scene_yaml(path: Path, scene: Scene) -> None:
    """Writes a scene; reading it gives the same `geometry_hash`.

    Raises:
        InputError: the path cannot be written, or a name or number is beyond what a file may hold.
    """
    document = to_document(scene)
    for field in ("walls", "objects"):
        document[field] = [yaml_text.Flow(body) for body in document[field]]
    for field in ("agent", "goal"):
        document[field] = yaml_text.Flow(document[field])
    write_text(path, yaml_text.dump(document))


def from_document(data: Any, where: str, name: str = "scene") -> Scene:
    """The scene of a document as `to_document` makes it.

    Args:
        data: Plain values.
        where: What they were read from; it begins every error message.
        name: Name of a scene whose document has none.

    Raises:
        InputError: naming the field and the reason.
    """
    document = validated(SceneDocument, data, where)
    walls = tuple(to_body(body, f"{where}: walls[{i}]") for i, body in enumerate(document.walls))
    objects = tuple(to_body(body, f"{where}: objects[{i}]") for i, body in enumerate(document.objects))
    try:
        return Scene(
            name=document.name or name,
            bounds=np.array(document.bounds),
            tolerance=document.tolerance,
            agent=Agent(np.array(document.agent.position), document.agent.radius, document.agent.height),
            walls=walls,
            objects=objects,
            goal=Goal(document.goal.object, np.array(document.goal.position), np.array(document.goal.size)),
            preset=document.preset,
            source=document.source,
        )
    except ValueError as error:
        raise InputError(where, str(error)) from None


def to_document(scene: Scene) -> dict[str, Any]:
    """The plain values of a scene's file.

    Raises:
        InputError: a name or number is beyond what a file may hold.
    """
    document = {
        "format": 1,
        "name": scene.name,
        "preset": scene.preset,
        "bounds": [_list(corner) for corner in scene.bounds],
        "tolerance": short(scene.tolerance),
        "agent": {
            "position": _list(scene.agent.position),
            "radius": short(scene.agent.radius),
            "height": short(scene.agent.height),
        },
        "walls": [from_body(body) for body in scene.walls],
        "objects": [from_body(body) for body in scene.objects],
        "goal": {
            "object": scene.goal.object,
            "position": _list(scene.goal.position),
            "size": _list(scene.goal.size),
        },
        "source": _plain(scene.source),
    }
    validated(SceneDocument, document, scene.name)
    return document


def _list(values: FloatArray) -> list[float]:
    return [short(value) for value in values]


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return value
