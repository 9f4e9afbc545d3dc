"""The scene file: YAML that people write and read, one body a line.

A body is given by `size` (its outer size), by `polygon` (its outline without the edge radius) and `height`, or by
several `parts`, which move as one, and `height`. Lengths in metres, angles in radians; z = 0 is the floor and the z of
a `position` the middle of the height.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, Field, model_validator

from converter.formats import yaml_text
from converter.scene import Agent, Body, Goal, Scene
from converter.shape import FloatArray, Part, rotation
from pcg.errors import InputError
from pcg.files import read_text, write_text
from pcg.validation import Document, validated

MAX_BYTES = 8_000_000
MAX_BODIES = 10_000
MAX_LENGTH = 1e4
"""Largest coordinate and length [m]."""

_NOISE = 1e-12
"""Numbers this close to nine decimals are meant to be those: 0.1 + 0.2 is written 0.3."""


def _printable(text: str) -> str:
    if not text.isprintable():
        raise ValueError("names must be printable")
    return text


_Number = Annotated[float, Field(strict=True, ge=-MAX_LENGTH, le=MAX_LENGTH)]
_Length = Annotated[float, Field(strict=True, ge=1e-6, le=MAX_LENGTH)]
_Radius = Annotated[float, Field(strict=True, ge=0, le=MAX_LENGTH)]
_Share = Annotated[float, Field(strict=True, ge=0, le=1)]
_Name = Annotated[str, Field(min_length=1, max_length=200), AfterValidator(_printable)]
_Polygon = Annotated[list[tuple[_Number, _Number]], Field(min_length=1, max_length=1000)]


class _Part(Document):
    size: tuple[_Length, _Length] | None = None
    polygon: _Polygon | None = None
    edge_radius: _Radius = 0.0
    offset: tuple[_Number, _Number] = (0.0, 0.0)
    yaw: _Number = 0.0

    @model_validator(mode="after")
    def _one_outline(self) -> "_Part":
        if (self.size is None) == (self.polygon is None):
            raise ValueError("a part needs either size [sx, sy] or polygon")
        return self


class _Body(Document):
    name: _Name
    position: tuple[_Number, _Number, _Number]
    size: tuple[_Length, _Length, _Length] | None = None
    polygon: _Polygon | None = None
    parts: Annotated[list[_Part], Field(min_length=1, max_length=100)] | None = None
    height: _Length | None = None
    edge_radius: _Radius = 0.0
    yaw: _Number = 0.0
    color: tuple[_Share, _Share, _Share] | None = None

    @model_validator(mode="after")
    def _one_outline(self) -> "_Body":
        if sum(outline is not None for outline in (self.size, self.polygon, self.parts)) != 1:
            raise ValueError("a body needs one of size [sx, sy, sz], polygon with height, or parts with height")
        if (self.size is None) == (self.height is None):
            raise ValueError("height goes with polygon or parts; with size it is the third number")
        if self.parts is not None and self.edge_radius:
            raise ValueError("with parts, edge_radius belongs to each part")
        return self

    @property
    def outlines(self) -> Sequence[_Part]:
        if self.parts is not None:
            return self.parts
        size = None if self.size is None else self.size[:2]
        return [_Part(size=size, polygon=self.polygon, edge_radius=self.edge_radius)]

    @property
    def extent(self) -> float:
        """Height [m], from wherever it is given."""
        return self.size[2] if self.size is not None else self.height or 0.0


class _Agent(Document):
    position: tuple[_Number, _Number]
    radius: _Length
    height: _Length = 0.2


class _Goal(Document):
    object: str
    position: tuple[_Number, _Number]
    size: tuple[_Length, _Length]


class _Scene(Document):
    format: Literal[1]
    name: _Name | None = None
    preset: Literal["clear", "published"] | None = None
    bounds: tuple[tuple[_Number, _Number], tuple[_Number, _Number]]
    tolerance: _Radius
    agent: _Agent
    walls: Annotated[tuple[_Body, ...], Field(max_length=MAX_BODIES)] = ()
    objects: Annotated[tuple[_Body, ...], Field(min_length=1, max_length=MAX_BODIES)]
    goal: _Goal
    source: dict[str, Any] = Field(default_factory=dict)


def read_scene_yaml(path: Path) -> Scene:
    """Reads and validates a scene file; a scene without a name gets the stem of its file.

    Raises:
        InputError: naming file, field or line, and reason.
    """
    if path.is_file() and path.stat().st_size > MAX_BYTES:
        raise InputError(str(path), f"larger than {MAX_BYTES // 1_000_000} MB, the most that a scene may have")
    return from_document(yaml_text.parse(read_text(path), str(path)), str(path), path.stem)


def write_scene_yaml(path: Path, scene: Scene) -> None:
    """Writes a scene; reading it gives the same `geometry_hash`."""
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
    document = validated(_Scene, data, where)
    walls = tuple(_body(body, f"{where}: walls[{i}]") for i, body in enumerate(document.walls))
    objects = tuple(_body(body, f"{where}: objects[{i}]") for i, body in enumerate(document.objects))
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


def _body(document: _Body, where: str) -> Body:
    try:
        parts = tuple(_part(part) for part in document.outlines)
        return Body(document.name, np.array(document.position), document.extent, parts, document.yaw, document.color)
    except ValueError as error:
        raise InputError(f"{where} ({document.name})", str(error)) from None


def _part(document: _Part) -> Part:
    if document.size is not None:
        part = Part.box(document.size, document.edge_radius)
    else:
        part = Part(_counter_clockwise(np.array(document.polygon)), document.edge_radius)
    if document.yaw == 0 and document.offset == (0, 0):
        return part
    return Part(part.core @ rotation(document.yaw) + np.array(document.offset), part.edge_radius)


def _counter_clockwise(polygon: FloatArray) -> FloatArray:
    x, y = (polygon - polygon[0]).T
    return polygon[::-1] if x @ np.roll(y, -1) < y @ np.roll(x, -1) else polygon


def to_document(scene: Scene) -> dict[str, Any]:
    """The plain values of a scene's file; fields that have their default are left out of bodies."""
    return {
        "format": 1,
        "name": scene.name,
        "preset": scene.preset,
        "bounds": _short(scene.bounds),
        "tolerance": _short(scene.tolerance),
        "agent": {
            "position": _short(scene.agent.position),
            "radius": _short(scene.agent.radius),
            "height": _short(scene.agent.height),
        },
        "walls": [_body_document(body) for body in scene.walls],
        "objects": [_body_document(body) for body in scene.objects],
        "goal": {
            "object": scene.goal.object,
            "position": _short(scene.goal.position),
            "size": _short(scene.goal.size),
        },
        "source": _plain(scene.source),
    }


def _body_document(body: Body) -> dict[str, Any]:
    document = {
        "name": body.name,
        "position": _short(body.position),
        **_outline_document(body),
        "yaw": _short(body.yaw),
        "color": None if body.color is None else _short(np.array(body.color)),
    }
    return {key: value for key, value in document.items() if value not in (None, 0.0)}


def _outline_document(body: Body) -> dict[str, Any]:
    height = _short(body.height)
    if len(body.parts) > 1:
        return {"parts": [_part_document(part) for part in body.parts], "height": height}
    (part,) = body.parts
    if part.box_size is not None:
        return {"size": [*_short(np.array(part.box_size)), height], "edge_radius": _short(part.edge_radius)}
    return {"polygon": _short(part.core), "height": height, "edge_radius": _short(part.edge_radius)}


def _part_document(part: Part) -> dict[str, Any]:
    middle = (part.core.min(axis=0) + part.core.max(axis=0)) / 2
    size = Part(part.core - middle, part.edge_radius).box_size
    document: dict[str, Any] = {"polygon": _short(part.core)}
    if size is not None:
        document = {"size": _short(np.array(size)), "offset": _short(middle)}
    return {**document, "edge_radius": _short(part.edge_radius)}


def _short(values: float | FloatArray) -> Any:
    values = np.asarray(values, dtype=np.float64)
    rounded = np.round(values, 9)
    # Adding 0.0 turns -0.0 into 0.0.
    return (np.where(np.abs(values - rounded) <= _NOISE, rounded, values) + 0.0).tolist()


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return value
