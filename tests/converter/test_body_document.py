import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from converter.formats.body_document import BodyDocument, from_body, short, to_body
from converter.scene import Body
from converter.shape import Part
from pcg.errors import InputError
from pcg.validation import validated

SQUARE = [[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]]


def body(**fields: Any) -> Body:
    """The body of a document with these fields."""
    document = {"name": "it", "position": [0.0, 0.0, 0.1], **fields}
    return to_body(validated(BodyDocument, document, "file"), "file")


def test_size_is_the_outer_size():
    """The edge radius rounds the corners of a box and does not make it larger."""
    (part,) = body(size=[0.4, 0.2, 0.3], edge_radius=0.05).parts
    np.testing.assert_allclose(part.core.max(axis=0), [0.15, 0.05])
    assert part.box_size == pytest.approx((0.4, 0.2))


def test_polygon_is_the_outline_without_its_edge_radius():
    """The edge radius of a polygon comes on top of its vertices."""
    made = body(polygon=SQUARE, height=0.2, edge_radius=0.05)
    np.testing.assert_array_equal(made.parts[0].core, SQUARE)
    assert made.parts[0].box_size == pytest.approx((0.3, 0.3))


def test_a_clockwise_polygon_is_turned_round():
    """Drawing programs differ in their sense of rotation; both are read."""
    assert body(polygon=SQUARE[::-1], height=0.2).geometry == body(polygon=SQUARE, height=0.2).geometry


@pytest.mark.parametrize(
    "polygon",
    [
        [[0, 0], [1, 0], [0.2, 0.2], [0, 1]],
        [[0, 0], [1, 1], [1, 0], [0, 1]],
        [[0, 0], [1, 0], [2, 0]],
        [[0, 0], [1, 0], [1, 0], [0, 1]],
        [[0, 0], [1, 0]],
    ],
    ids=["reflex", "bow tie", "flat", "repeated vertex", "no area"],
)
def test_a_polygon_that_is_not_convex_is_refused(polygon: list[list[float]]):
    """Only convex polygons are parts; the message names the body."""
    with pytest.raises(InputError, match=r"^file: it: .*(polygon)"):
        body(polygon=polygon, height=0.2)


def test_parts_are_turned_and_then_moved():
    """A part of size 0.4 x 0.2, turned by a quarter and moved by 1, reaches from 0.9 to 1.1."""
    made = body(parts=[{"size": [0.4, 0.2], "yaw": math.pi / 2, "offset": [1.0, 0.0]}], height=0.2)
    np.testing.assert_allclose(made.parts[0].core.min(axis=0), [0.9, -0.2], atol=1e-12)
    np.testing.assert_allclose(made.parts[0].core.max(axis=0), [1.1, 0.2], atol=1e-12)


@pytest.mark.parametrize(
    "fields",
    [
        {},
        {"size": [0.2, 0.2, 0.2], "polygon": SQUARE, "height": 0.2},
        {"polygon": SQUARE},
        {"parts": [], "height": 0.2},
        {"parts": [{}], "height": 0.2},
        {"parts": [{"size": [0.2, 0.2]}], "height": 0.2, "edge_radius": 0.02},
        {"size": [0.2, 0.2, 0.2], "color": [0, 0, 2]},
        {"size": [0.2, 0.2, 0.2], "yaw": float("inf")},
    ],
    ids=["none", "two", "no height", "no parts", "empty part", "two edge radii", "colour", "yaw"],
)
def test_a_body_needs_exactly_one_outline(fields: dict[str, Any]):
    """Contradictory and incomplete bodies are refused."""
    with pytest.raises(InputError, match=r"^file: "):
        body(**fields)


@given(st.from_type(Body))
def test_a_body_survives_its_document(made: Body):
    """The geometry, to the last digit of its hash, and the name come back."""
    back = to_body(validated(BodyDocument, from_body(made), "file"), "file")
    assert back.geometry == made.geometry
    assert back.name == made.name


def test_an_l_shape_is_written_as_boxes():
    """Parts that are boxes somewhere in the body are given by size and offset."""
    arm = Part(Part.box((0.2, 0.4)).core + np.array([0.2, 0.1]))
    made = Body("l", np.array([0.0, 0.0, 0.1]), 0.2, (Part.box((0.2, 0.2)), arm))
    assert from_body(made)["parts"] == [{"size": [0.2, 0.2]}, {"size": [0.2, 0.4], "offset": [0.2, 0.1]}]


@pytest.mark.parametrize(
    ("value", "expected"), [(0.1 + 0.2, 0.3), (-0.0, 0.0), (1 / 3, 1 / 3), (1e-3, 0.001), (2.0000000001, 2.0000000001)]
)
def test_short_numbers_lose_only_noise(value: float, expected: float):
    """What differs from nine decimals by less than 1e-12 is noise, anything else is kept in full."""
    assert repr(short(value)) == repr(expected)
