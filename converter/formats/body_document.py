"""Bodies as plain values: what stands in a scene file for each wall and object.

A body is given by `size` (its outer size), by `polygon` (its outline without the edge radius) and `height`, or by
several `parts`, which move as one, and `height`. Lengths in metres, angles in radians.
"""

from collections.abc import Callable, Sequence
from typing import Annotated, Any, Self

import numpy as np
from pydantic import AfterValidator, ConfigDict, Field, model_validator
from pydantic.config import JsonDict

from converter.scene import Body
from converter.shape import FloatArray, Part, denoised, rotation
from pcg.errors import InputError
from pcg.validation import Document, validated

MAX_LENGTH = 1e4
"""Largest coordinate and length [m]."""

MIN_LENGTH = 1e-6
"""Smallest size [m]."""

MAX_PARTS = 100
"""Most parts of a body."""

_NOISE = 1e-12
"""Numbers this close to nine decimals are meant to be those: 0.1 + 0.2 is written 0.3."""


def _printable(text: str) -> str:
    if not text.isprintable():
        raise ValueError("a name must be printable text")
    return text


def _only(fields: list[str], without: list[str]) -> JsonDict:
    """The JSON Schema of an object that has some fields and lacks others."""
    return {"required": list(fields), "not": {"anyOf": [{"required": [field]} for field in without]}}


Number = Annotated[float, Field(strict=True, ge=-MAX_LENGTH, le=MAX_LENGTH)]
Length = Annotated[float, Field(strict=True, ge=MIN_LENGTH, le=MAX_LENGTH)]
Radius = Annotated[float, Field(strict=True, ge=0, le=MAX_LENGTH)]
Share = Annotated[float, Field(strict=True, ge=0, le=1)]
Text = Annotated[str, AfterValidator(_printable)]
Name = Annotated[Text, Field(min_length=1, max_length=200)]
Polygon = Annotated[tuple[tuple[Number, Number], ...], Field(min_length=1, max_length=1000)]


class PartDocument(Document):
    """One convex part: a box of outer `size`, turned by `yaw` and then moved by `offset`, or a polygon likewise."""

    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": ["size"]}, {"required": ["polygon"]}]})

    size: tuple[Length, Length] | None = None
    polygon: Polygon | None = None
    edge_radius: Radius = 0.0
    offset: tuple[Number, Number] = (0.0, 0.0)
    yaw: Number = 0.0

    @model_validator(mode="after")
    def _one_outline(self) -> Self:
        if (self.size is None) == (self.polygon is None):
            raise ValueError("a part needs either size [sx, sy] or polygon")
        return self


class BodyDocument(Document):
    """One wall or object."""

    model_config = ConfigDict(
        json_schema_extra={
            "oneOf": [
                _only(["size"], ["polygon", "parts", "height"]),
                _only(["polygon", "height"], ["size", "parts"]),
                _only(["parts", "height"], ["size", "polygon", "edge_radius"]),
            ]
        }
    )

    name: Name
    position: tuple[Number, Number, Number]
    size: tuple[Length, Length, Length] | None = None
    polygon: Polygon | None = None
    parts: Annotated[tuple[PartDocument, ...], Field(min_length=1, max_length=MAX_PARTS)] | None = None
    height: Length | None = None
    edge_radius: Radius = 0.0
    yaw: Number = 0.0
    color: tuple[Share, Share, Share] | None = None

    @model_validator(mode="after")
    def _one_outline(self) -> Self:
        if sum(outline is not None for outline in (self.size, self.polygon, self.parts)) != 1:
            raise ValueError("a body needs one of size [sx, sy, sz], polygon with height, parts with height")
        if (self.size is None) == (self.height is None):
            raise ValueError("polygon and parts need a height; with size it is the third number")
        if self.parts is not None and self.edge_radius:
            raise ValueError("with parts, edge_radius belongs to each part")
        return self

    @property
    def part_documents(self) -> Sequence[PartDocument]:
        """The parts, of which a body given by size or polygon has one."""
        if self.parts is not None:
            return self.parts
        size = None if self.size is None else self.size[:2]
        return [PartDocument(size=size, polygon=self.polygon, edge_radius=self.edge_radius)]


def to_body(document: BodyDocument, where: str) -> Body:
    """The body of a document.

    Raises:
        InputError: a polygon is not convex, or a box is smaller than two edge radii.
    """
    height = document.size[2] if document.size is not None else document.height or 0.0
    try:
        parts = tuple(_part(part) for part in document.part_documents)
        return Body(document.name, np.array(document.position), height, parts, document.yaw, document.color)
    except ValueError as error:
        raise InputError(where, f"{document.name}: {error}") from None


def _part(document: PartDocument) -> Part:
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


def from_body(body: Body) -> dict[str, Any]:
    """The plain values of a body, without the fields that have their default; `geometry` survives the way back.

    Raises:
        InputError: a name or number is beyond what a file may hold.
    """
    document = _fields(body, [_outline(part) for part in body.parts], short)
    read_back = to_body(validated(BodyDocument, document, body.name), body.name)
    if read_back.geometry == body.geometry:
        return document
    # Shortened numbers would move a vertex across a rounding boundary of `geometry`: give each number in full.
    return _fields(body, [{"polygon": part.core.tolist()} for part in body.parts], float)


def short(value: float) -> float:
    """The number without the noise of floating-point arithmetic behind the ninth decimal."""
    rounded = round(float(value), 9)
    # Adding 0.0 turns -0.0 into 0.0.
    return (rounded if abs(value - rounded) <= _NOISE else float(value)) + 0.0


def _fields(body: Body, outlines: list[dict[str, Any]], number: Callable[[float], float]) -> dict[str, Any]:
    parts = [
        {**outline, "edge_radius": number(part.edge_radius)} for outline, part in zip(outlines, body.parts, strict=True)
    ]
    height = number(body.height)
    footprint: dict[str, Any] = {"parts": [_without_defaults(part) for part in parts], "height": height}
    if len(parts) == 1 and "offset" not in parts[0]:
        size, polygon = parts[0].get("size"), parts[0].get("polygon")
        upright = {"size": [*size, height]} if size else {"polygon": polygon, "height": height}
        footprint = {**upright, "edge_radius": parts[0]["edge_radius"]}
    fields = {
        "name": body.name,
        "position": [number(value) for value in body.position],
        **footprint,
        "yaw": number(body.yaw),
        "color": None if body.color is None else [short(value) for value in body.color],
    }
    return _without_defaults(fields)


def _outline(part: Part) -> dict[str, Any]:
    lower, upper = part.core.min(axis=0), part.core.max(axis=0)
    # Sums are rounded to picometres, so that writing what was read gives the same text.
    offset = [short(value) for value in denoised((lower + upper) / 2)]
    size = [short(value) for value in denoised(upper - lower + 2 * part.edge_radius)]
    centred = np.abs(part.core - offset) * 2 + 2 * part.edge_radius
    if not np.allclose(centred, size, rtol=0, atol=10 * _NOISE):
        return {"polygon": [[short(x), short(y)] for x, y in part.core]}
    return {"size": size, "offset": offset} if any(offset) else {"size": size}


def _without_defaults(fields: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in fields.items() if value not in (None, 0.0)}
