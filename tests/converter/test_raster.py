from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from converter.drawing import Drawing, Item, Label, Line, Rounded, Shape, box, disc
from converter.raster import MAX_PIXELS, Image, paint, paint_over, require_paintable
from converter.shape import FloatArray
from pcg.errors import InputError

BLACK, WHITE, RED = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (1.0, 0.0, 0.0)


def drawing(*items: Item) -> Drawing:
    """Items on white in the square from (-1, -1) to (1, 1)."""
    return Drawing(np.array([-1.0, -1.0]), np.array([1.0, 1.0]), WHITE, items)


def darkness(image: Image) -> FloatArray:
    """(h, w) in 0..1: the share of each pixel that black shapes cover."""
    return 1.0 - image[..., 0] / 255.0


@st.composite
def rounded_polygons(draw: st.DrawFn) -> Rounded:
    """A random convex polygon well inside the picture: points on an ellipse around a random centre."""
    angles = sorted(draw(st.lists(st.floats(0, 6), min_size=3, max_size=7, unique_by=lambda angle: round(angle, 1))))
    turn, width, height = draw(st.floats(0, 6)), draw(st.floats(0.2, 0.5)), draw(st.floats(0.2, 0.5))
    around = np.stack([width * np.cos(angles), height * np.sin(angles)], axis=-1)
    c, s = np.cos(turn), np.sin(turn)
    center = np.array([draw(st.floats(-0.3, 0.3)), draw(st.floats(-0.3, 0.3))])
    return Rounded(around @ np.array([[c, s], [-s, c]]) + center, draw(st.integers(0, 10)) / 100)


def test_disc_has_its_radius_in_pixels():
    """A disc of radius 0.5 m at 100 px/m is 100 px across and covers pi 50^2 pixels."""
    covered = darkness(paint(drawing(Shape((disc((0.0, 0.0), 0.5),), BLACK)), 200))
    assert np.flatnonzero(covered[100] > 0.5).tolist() == list(range(50, 150))
    assert np.flatnonzero(covered[:, 100] > 0.5).tolist() == list(range(50, 150))
    assert covered.sum() == pytest.approx(np.pi * 50**2, rel=1e-3)


def test_y_is_up_and_x_is_right():
    """A box in the upper right corner of the world is in the first rows and the last columns."""
    covered = darkness(paint(drawing(Shape((box((0.75, 0.75), (0.5, 0.5)),), BLACK)), 40))
    expected = np.zeros((40, 40))
    expected[:10, 30:] = 1
    assert np.array_equal(covered, expected)


def test_height_follows_from_the_proportions():
    """A drawing twice as wide as high gives an image twice as wide as high."""
    wide = replace(drawing(), lower=np.array([-1.0, 0.0]))
    assert paint(wide, 60).shape == (30, 60, 3)


def test_half_covered_pixels_are_half_dark():
    """A box that ends in the middle of a column of pixels darkens it by half."""
    covered = darkness(paint(drawing(Shape((box((-0.5, 0.0), (1.05, 2.0)),), BLACK)), 40))
    assert covered[20, 19] == 1
    assert covered[20, 20] == pytest.approx(0.5, abs=0.01)
    assert covered[20, 21] == 0


@given(rounded_polygons())
@settings(max_examples=50)
def test_area_is_that_of_the_buffered_polygon(polygon: Rounded):
    """The covered area agrees with that of an independent geometry library to a part of a pixel along the outline."""
    covered = darkness(paint(drawing(Shape((polygon,), BLACK)), 400)).sum() / 200**2
    shape = shapely.Polygon(polygon.core).buffer(polygon.radius, quad_segs=64)
    assert covered == pytest.approx(shape.area, abs=0.02 * shape.length / 200 + 2 / 200**2)


@given(rounded_polygons(), st.floats(0, 0.05))
@settings(max_examples=50)
def test_mirrored_shape_gives_mirrored_image(polygon: Rounded, outline_width: float):
    """Painting treats left and right alike, to one level of 255."""
    mirrored = Rounded(polygon.core[::-1] * [-1.0, 1.0], polygon.radius)
    images = [
        paint(drawing(Shape((part,), RED, outline_width=outline_width)), 100).astype(int)
        for part in (polygon, mirrored)
    ]
    assert np.abs(images[0] - images[1][:, ::-1]).max() <= 1


@given(st.floats(-0.5, 0.5))
def test_touching_parts_leave_no_seam(x: float):
    """Two boxes of one shape that share an edge look like one box, wherever the edge is."""
    left, right = box(((x - 0.8) / 2, 0.0), (x + 0.8, 1.0)), box(((x + 0.8) / 2, 0.0), (0.8 - x, 1.0))
    halves = paint(drawing(Shape((left, right), RED, outline_width=0.03)), 100).astype(int)
    whole = paint(drawing(Shape((box((0.0, 0.0), (1.6, 1.0)),), RED, outline_width=0.03)), 100)
    assert np.abs(halves - whole).max() <= 1


def test_outline_lies_outside_the_fill():
    """An outline leaves the filled pixels as they are and adds its width around them."""
    plain = paint(drawing(Shape((box((0.0, 0.0), (1.0, 1.0)),), RED)), 40)
    outlined = paint(drawing(Shape((box((0.0, 0.0), (1.0, 1.0)),), RED, outline=BLACK, outline_width=0.1)), 40)
    filled = (plain == [255, 0, 0]).all(axis=-1)
    assert filled.sum() == 20 * 20
    assert np.array_equal((outlined == [255, 0, 0]).all(axis=-1), filled)
    assert np.flatnonzero((outlined[20] == 0).all(axis=-1)).tolist() == [8, 9, 30, 31]


def test_translucent_fill_mixes_with_the_ground():
    """A black fill of opacity 0.2 on white is a light grey."""
    image = paint(drawing(Shape((box((0.0, 0.0), (1.0, 1.0)),), BLACK, fill_opacity=0.2)), 40)
    assert image[20, 20].tolist() == [204, 204, 204]


def test_line_has_its_width_along_its_whole_length():
    """A polyline covers its width beside its edges, and only once where they meet."""
    points = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5]])
    covered = darkness(paint(drawing(Line(points, 0.1, BLACK)), 200))
    assert np.flatnonzero(covered[:, 100] > 0.5).tolist() == list(range(145, 155))
    assert np.flatnonzero(covered[100] > 0.5).tolist() == list(range(145, 155))
    outside = shapely.LineString(points).buffer(0.05, quad_segs=64)
    assert covered.sum() / 100**2 == pytest.approx(outside.area, rel=0.01)


def test_line_with_many_close_points_looks_like_a_straight_one():
    """Vertices closer than a fraction of a pixel change nothing."""
    ends = np.array([[-0.5, 0.1], [0.5, 0.3]])
    dense = ends[0] + np.linspace(0, 1, 20_000)[:, None] * (ends[1] - ends[0])
    assert np.array_equal(paint(drawing(Line(ends, 0.05, BLACK)), 100), paint(drawing(Line(dense, 0.05, BLACK)), 100))


def test_line_of_one_point_is_a_disc():
    """A path without length is a dot of the line's width."""
    dot = paint(drawing(Line(np.array([[0.2, 0.1]]), 0.4, BLACK)), 100)
    assert np.array_equal(dot, paint(drawing(Shape((disc((0.2, 0.1), 0.2),), BLACK)), 100))


def test_later_items_are_above():
    """Of two shapes at one place the last is seen."""
    square = (box((0.0, 0.0), (1.0, 1.0)),)
    assert paint(drawing(Shape(square, BLACK), Shape(square, RED)), 20)[10, 10].tolist() == [255, 0, 0]


@pytest.mark.parametrize("center", [(5.0, 0.0), (-5.0, 0.0), (0.0, 5.0), (0.0, -5.0)])
def test_items_outside_the_picture_leave_it_blank(center: tuple[float, float]):
    """What lies beside the shown rectangle is cut off, not an error."""
    items = (
        Shape((disc(center, 1.0),), BLACK, outline_width=0.1),
        Line(np.array([center, center]), 0.1, BLACK),
        Label("far away", np.array(center), 0.2, BLACK),
    )
    assert (paint(drawing(*items), 50) == 255).all()


def test_shape_on_the_border_is_cut():
    """A disc around a corner shows a quarter."""
    covered = darkness(paint(drawing(Shape((disc((1.0, 1.0), 1.0),), BLACK)), 200))
    assert covered.sum() == pytest.approx(np.pi * 100**2 / 4, rel=1e-3)


def test_label_is_centred():
    """The ink of a label surrounds its position evenly."""
    image = paint(drawing(Label("H", np.array([0.3, -0.2]), 0.4, BLACK)), 200)
    rows, columns = np.nonzero(image[..., 0] < 128)
    assert (columns.min() + columns.max() + 1) / 2 == pytest.approx(130, abs=1)
    assert (rows.min() + rows.max() + 1) / 2 == pytest.approx(120, abs=1)
    assert 20 < np.ptp(rows) < 40


@pytest.mark.parametrize("text", ["", " ", "\n", "Größe 漢字", "a" * 3000])
def test_any_text_can_be_painted(text: str):
    """Labels never fail: characters without a glyph and text beyond the border included."""
    assert paint(drawing(Label(text, np.zeros(2), 0.4, BLACK)), 50).shape == (50, 50, 3)


def test_painting_over_keeps_the_image_below():
    """`paint_over` returns a copy."""
    below = paint(drawing(), 20)
    above = paint_over(below, drawing(Shape((disc((0.0, 0.0), 0.5),), BLACK)))
    assert (below == 255).all()
    assert above[10, 10].tolist() == [0, 0, 0]


@pytest.mark.parametrize(("width", "height"), [(0, 5), (5, 0), (-1, 5), (MAX_PIXELS, 2)])
def test_impossible_sizes_are_refused(width: int, height: int):
    """An image without pixels or of gigabytes is an error that says what is allowed."""
    with pytest.raises(InputError, match=f"image size: {width} x {height} pixels; at least 1 x 1 and at most"):
        require_paintable(width, height)


def test_very_flat_drawings_are_refused():
    """A drawing so flat that its image has no row is an error, not an empty image."""
    with pytest.raises(InputError, match="100 x 0 pixels"):
        paint(replace(drawing(), lower=np.array([-1.0, 0.9999])), 100)
