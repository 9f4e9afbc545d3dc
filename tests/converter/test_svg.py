"""Drawings as SVG."""

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from converter.drawing import Drawing, Inset, Item, Label, Line, Rounded, Shape, box, disc
from converter.render_scene import scene_drawing
from converter.scene import Scene
from converter.shape import Part
from converter.svg import Frame, path_data, svg_text, write_svg

BLACK, WHITE, RED = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (1.0, 0.0, 0.0)
NAMESPACE = "{http://www.w3.org/2000/svg}"


def drawing(*items: Item) -> Drawing:
    """Items on white in the square from (-1, -1) to (1, 1)."""
    return Drawing(np.array([-1.0, -1.0]), np.array([1.0, 1.0]), WHITE, items)


def parsed(*items: Item) -> ET.Element:
    """The root of the file of 200 px that shows `items`: 100 px a metre."""
    return ET.fromstring(svg_text(drawing(*items), 200))  # noqa: S314  # our own text


def elements(root: ET.Element, name: str) -> list[ET.Element]:
    """All elements called `name`."""
    return list(root.iter(NAMESPACE + name))


def area(d: str) -> float:
    """Area of a closed path of lines and arcs, each arc flattened into 64 chords."""
    total = 0.0
    for loop in re.findall(r"M[^MZ]*Z", d):
        points: list[complex] = []
        for command, text in re.findall(r"([MLA])([^MLAZ]*)", loop):
            numbers = [float(number) for number in text.split()]
            end = complex(*numbers[-2:])
            points += _chords(points[-1], end, numbers[0]) if command == "A" else [end]
        corners = np.array(points)
        total += abs((corners * np.roll(corners, -1).conj()).imag.sum()) / 2
    return total


def _chords(start: complex, end: complex, radius: float) -> list[complex]:
    """Points on the arc that turns left as one sees it, y pointing down."""
    chord = end - start
    if abs(chord) < 1e-9:
        return [end]
    height = max(radius**2 - abs(chord) ** 2 / 4, 0.0) ** 0.5
    center = (start + end) / 2 - 1j * chord / abs(chord) * height
    a, b = np.angle(start - center), np.angle(end - center)
    turn = -((a - b) % (2 * np.pi))
    return [center + radius * np.exp(1j * (a + turn * share)) for share in np.linspace(0, 1, 65)[1:]]


@given(st.from_type(Part))
@settings(max_examples=40)
def test_outlines_enclose_the_area_of_the_part(part: Part):
    """Straight edges and arcs enclose as much as the buffered polygon of an independent library."""
    shape = shapely.MultiPoint(part.core).convex_hull
    # The library fails for radii that are next to nothing.
    shape = shape.buffer(part.edge_radius, quad_segs=256) if part.edge_radius > 1e-9 else shape
    found = area(path_data((Rounded(part.core, part.edge_radius),), Frame(digits=9)))
    assert found == pytest.approx(shape.area, rel=1e-3, abs=1e-6)


def test_y_points_down():
    """A box in the upper right of the world is in the upper right of the picture."""
    (path,) = elements(parsed(Shape((box((0.75, 0.75), (0.5, 0.5)),), BLACK)), "path")
    assert path.get("d") == "M150 50L200 50L200 0L150 0Z"


def test_an_outline_lies_around_its_fill():
    """The stroke's middle is half its width outside, so that the fill keeps its size."""
    (path,) = elements(parsed(Shape((disc((0.0, 0.0), 0.5),), RED, outline=BLACK, outline_width=0.1)), "path")
    assert path.get("stroke-width") == "10"
    assert (path.get("d") or "").startswith("M45 100A55 55 ")


def test_outlines_of_several_parts_do_not_cross():
    """The outline of all parts is below the fill of all parts; a translucent fill has it cut out."""
    parts = (box((-0.2, 0.0), (0.5, 0.2)), box((0.2, 0.0), (0.5, 0.2)))
    around, inside = elements(parsed(Shape(parts, RED, outline_width=0.1)), "path")
    assert (around.get("fill"), inside.get("fill")) == ("#000000", "#ff0000")
    ghost = parsed(Shape(parts, RED, fill_opacity=0.3, outline_width=0.1))
    (mask,) = elements(ghost, "mask")
    assert [path.get("mask") for path in ghost.findall(NAMESPACE + "path")] == [f"url(#{mask.get('id')})", None]


def test_a_repeated_drawing_is_defined_once():
    """Tiles are drawn once and used many times; a drawing that occurs once stands where it is."""
    tile, other = drawing(Shape((disc((0.0, 0.0), 0.5),), RED)), drawing()
    root = parsed(*(Inset(tile, np.array([x, 0.0]), 0.5) for x in (-1.0, -0.5, 0.0)), Inset(other, np.zeros(2), 0.5))
    (definition,) = root.findall(f"{NAMESPACE}defs/{NAMESPACE}g")
    uses = elements(root, "use")
    assert [use.get("{http://www.w3.org/1999/xlink}href") for use in uses] == [f"#{definition.get('id')}"] * 3
    assert [use.get("transform") for use in uses] == ["translate(0 50)", "translate(50 50)", "translate(100 50)"]
    assert len(root.findall(NAMESPACE + "g")) == 1


@pytest.mark.parametrize("text", ["<script>alert(1)</script>", "a & b", "]]>", "\x00\x08\ud800", "Größe 漢字"])
def test_any_text_is_text(text: str, tmp_path: Path):
    """Labels and titles are never markup, and what XML cannot hold is replaced."""
    write_svg(tmp_path / "a.svg", drawing(Label(text, np.zeros(2), 0.2, BLACK)), 100, title=text)
    root = ET.parse(tmp_path / "a.svg").getroot()  # noqa: S314  # our own text
    kept = re.sub("[\x00-\x08\ud800]", "\ufffd", text)
    assert [element.text for name in ("title", "text") for element in elements(root, name)] == [kept, kept]
    assert elements(root, "script") == []


def test_a_line_of_one_point_is_a_dot():
    """A path without length keeps its round ends."""
    (path,) = elements(parsed(Line(np.array([[0.0, 0.0]]), 0.1, BLACK)), "path")
    assert (path.get("d"), path.get("stroke-linecap"), path.get("stroke-width")) == ("M100 100L100 100", "round", "10")


def test_equal_drawings_give_equal_text(small_room: Scene):
    """Nothing about the text depends on chance, and no number is -0."""
    first, second = (svg_text(scene_drawing(small_room), 600, title="room") for _ in range(2))
    assert first == second
    assert not re.search(r"-0[^.\d]", first)


def test_the_picture_of_a_scene_is_as_it_was(small_room: Scene):
    """Every change of the look or of the text shows here; `tests/golden/scene.svg` is the accepted one."""
    golden = Path(__file__).parents[1] / "golden" / "scene.svg"
    assert svg_text(scene_drawing(small_room), 600, title="small-room") == golden.read_text(encoding="utf-8")
