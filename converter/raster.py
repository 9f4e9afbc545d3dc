"""Painting drawings in pixels.

Every shape is a convex polygon inflated by a disc, so its signed distance is exact and cheap, and the share of a pixel
that it covers is `clamp(1/2 - distance / pixel, 0, 1)`. That gives smooth edges at sub-pixel accuracy without
supersampling, and a mirrored drawing gives the mirrored picture. Images are (h, w, 3) uint8, red-green-blue, row 0 at
the top.
"""

import math
from collections.abc import Callable
from functools import cache, lru_cache
from typing import Any, NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from converter.drawing import Drawing, Inset, Item, Label, Line, Rounded, Shape, extent
from converter.shape import FloatArray
from converter.theme import Color
from pcg.errors import InputError

Image = npt.NDArray[np.uint8]

MAX_PIXELS = 4096 * 4096
"""Largest picture; its intermediate arrays take about a gigabyte."""

FINEST_STEP = 0.25
"""Vertices of a line closer than this to the one before [px] are left out."""


FULL_SLACK = 1e-9
"""A share of a pixel this close to 1 is the whole pixel."""


class _Window(NamedTuple):
    """A rectangle of pixels: where it is in the image, and the world coordinates [m] of its pixels' centres."""

    rows: slice
    columns: slice
    x: FloatArray
    y: FloatArray


def paint(drawing: Drawing, width_px: int) -> Image:
    """The drawing as an image of `width_px` pixels' width; the height follows from the drawing's proportions.

    Raises:
        InputError: the image would have no pixels or more than `MAX_PIXELS`.
    """
    width, height = drawing.upper - drawing.lower
    return _painted(drawing, width_px, round(width_px * height / width))


def paint_over(image: Image, drawing: Drawing) -> Image:
    """A copy of `image`, which shows the same rectangle as `drawing`, with the drawing's items above it."""
    painted = image.copy()
    for item in drawing.items:
        _PAINTERS[type(item)](painted, drawing, item)
    return painted


def require_paintable(width_px: int, height_px: int) -> None:
    """Refuses images without pixels and images too large for memory.

    Raises:
        InputError: saying how large the image may be.
    """
    if width_px < 1 or height_px < 1 or width_px * height_px > MAX_PIXELS:
        raise InputError(
            "image size", f"{width_px} x {height_px} pixels; at least 1 x 1 and at most {MAX_PIXELS} pixels in all"
        )


def _paint_shape(image: Image, drawing: Drawing, shape: Shape) -> None:
    """Shares the pixels on the border between fill and outline, without letting the ground shine through."""
    if _is_plain_box(shape):
        _paint_box(image, drawing, shape)
        return
    pixel, width = _pixel(image, drawing), shape.outline_width
    window = _window(image, drawing, extent(shape.parts), width + pixel)
    inside, around = np.zeros((2, len(window.y), len(window.x)))
    for part in shape.parts:
        near = _window(image, drawing, extent((part,)), width)
        place = _place(near, window)
        distance = _distance(part, near)
        # Parts that touch along an edge cover half of its pixels each: their sum leaves no seam. Their outlines
        # overlap there, and the larger one counts.
        inside[place] = np.minimum(inside[place] + _coverage(distance, pixel), 1.0)
        if width > 0:
            around[place] = np.maximum(around[place], _coverage(distance - width, pixel))
    np.maximum(np.subtract(around, inside, out=around), 0.0, out=around)
    inside *= shape.fill_opacity
    _blend(image[window.rows, window.columns], [(shape.fill, inside), (shape.outline, around)])


def _is_plain_box(shape: Shape) -> bool:
    """Whether a shape is one upright box with sharp corners and without an outline, as a floor is."""
    (part, *others) = shape.parts
    return not others and part.radius == 0 and shape.outline_width == 0 and _is_upright_box(part.core)


def _paint_box(image: Image, drawing: Drawing, shape: Shape) -> None:
    """A plain box: each pixel's share is the product of those of its row and of its column."""
    pixel, core = _pixel(image, drawing), shape.parts[0].core
    window = _window(image, drawing, extent(shape.parts), pixel)
    pixels = image[window.rows, window.columns]
    x, y = (_shares(centers, core[:, axis], pixel) for axis, centers in enumerate((window.x, window.y)))
    rows, columns = _full(y), _full(x)
    if shape.fill_opacity >= 1:
        pixels[rows, columns] = _bytes(shape.fill)
    else:
        rows = slice(0, 0)
    # What is left is a frame of few pixels: above, below, and on both sides.
    for r, c in (
        (slice(0, rows.start), slice(None)),
        (slice(rows.stop, None), slice(None)),
        (rows, slice(0, columns.start)),
        (rows, slice(columns.stop, None)),
    ):
        _blend(pixels[r, c], [(shape.fill, np.outer(y[r], x[c]) * shape.fill_opacity)])


def _shares(centers: FloatArray, ends: FloatArray, pixel: float) -> FloatArray:
    """(n,): how much of each row or column of pixels lies between the least and the greatest of `ends` [m]."""
    common = np.minimum(centers + pixel / 2, ends.max()) - np.maximum(centers - pixel / 2, ends.min())
    shares: FloatArray = np.clip(common / pixel, 0.0, 1.0)
    return shares


def _full(shares: FloatArray) -> slice:
    """The rows or columns that are covered from side to side."""
    found = np.flatnonzero(shares >= 1 - FULL_SLACK)
    return slice(int(found[0]), int(found[-1]) + 1) if len(found) else slice(0, 0)


def _paint_line(image: Image, drawing: Drawing, line: Line) -> None:
    pixel, radius = _pixel(image, drawing), line.width / 2
    points = _thinned(line.points, FINEST_STEP * pixel)
    window = _window(image, drawing, extent((Rounded(points, radius),)), pixel)
    covered = np.zeros((len(window.y), len(window.x)))
    for i in range(max(len(points) - 1, 1)):
        stretch = Rounded(points[i : i + 2], radius)
        near = _window(image, drawing, extent((stretch,)), 0.0)
        place = _place(near, window)
        covered[place] = np.maximum(covered[place], _coverage(_distance(stretch, near), pixel))
    _blend(image[window.rows, window.columns], [(line.color, covered)])


def _paint_label(image: Image, drawing: Drawing, label: Label) -> None:
    pixel = _pixel(image, drawing)
    size_px = max(round(label.height / pixel), 1)
    ink, rise = _ink(label.text, size_px)
    height, width = ink.shape
    column = round((label.position[0] - drawing.lower[0]) / pixel - width / 2)
    # Labels of one height share their baseline, whatever letters they have.
    row = round((drawing.upper[1] - label.position[1]) / pixel + _capital_height(size_px) / 2) - rise
    top, left = max(row, 0), max(column, 0)
    bottom, right = min(row + height, image.shape[0]), min(column + width, image.shape[1])
    if top >= bottom or left >= right:
        return
    visible = ink[top - row : bottom - row, left - column : right - column]
    _blend(image[top:bottom, left:right], [(label.color, visible)])


def _paint_inset(image: Image, drawing: Drawing, inset: Inset) -> None:
    """Puts the inner picture on whole pixels; where it meets another one, both end at the same ones."""
    pixel = _pixel(image, drawing)
    size = inset.drawing.upper - inset.drawing.lower
    width, height = np.array([1.0, size[1] / size[0]]) * inset.width / pixel
    left, bottom = np.array([1.0, -1.0]) * (inset.lower - [drawing.lower[0], drawing.upper[1]]) / pixel
    x, y = (_whole(left), _whole(left + width)), (_whole(bottom - height), _whole(bottom))
    inner = _inset_image(inset.drawing, max(x[1] - x[0], 1), max(y[1] - y[0], 1))
    rows = slice(max(y[0], 0), min(y[0] + inner.shape[0], image.shape[0]))
    columns = slice(max(x[0], 0), min(x[0] + inner.shape[1], image.shape[1]))
    if rows.start < rows.stop and columns.start < columns.stop:
        image[rows, columns] = inner[rows.start - y[0] : rows.stop - y[0], columns.start - x[0] : columns.stop - x[0]]


def _whole(edge: float) -> int:
    """The nearest whole number; halves go up, those that rounding errors have moved too."""
    return math.floor(edge + 0.5 + FULL_SLACK)


@lru_cache(maxsize=64)
def _inset_image(drawing: Drawing, width_px: int, height_px: int) -> Image:
    """An inner picture, painted once for all its places."""
    return _painted(drawing, width_px, height_px)


def _painted(drawing: Drawing, width_px: int, height_px: int) -> Image:
    require_paintable(width_px, height_px)
    image = np.empty((height_px, width_px, 3), dtype=np.uint8)
    image[:] = _bytes(drawing.background)
    return paint_over(image, drawing)


_PAINTERS: dict[type[Item], Callable[[Image, Drawing, Any], None]] = {
    Shape: _paint_shape,
    Line: _paint_line,
    Label: _paint_label,
    Inset: _paint_inset,
}


def _pixel(image: Image, drawing: Drawing) -> float:
    """Side of a pixel [m]."""
    columns: int = image.shape[1]
    return float(drawing.upper[0] - drawing.lower[0]) / columns


def _window(image: Image, drawing: Drawing, corners: FloatArray, margin: float) -> _Window:
    """The pixels that the box between `corners` (2, 2) [m], widened by `margin` [m], can touch."""
    pixel = _pixel(image, drawing)
    (left, low), (right, high) = corners
    first_column, last_column = (np.array([left - margin, right + margin]) - drawing.lower[0]) / pixel
    first_row, last_row = (drawing.upper[1] - np.array([high + margin, low - margin])) / pixel
    rows = _clipped(first_row, last_row, image.shape[0])
    columns = _clipped(first_column, last_column, image.shape[1])
    x = drawing.lower[0] + (np.arange(columns.start, columns.stop) + 0.5) * pixel
    y = drawing.upper[1] - (np.arange(rows.start, rows.stop) + 0.5) * pixel
    return _Window(rows, columns, x, y)


def _clipped(first: float, last: float, size: int) -> slice:
    start = int(np.clip(np.floor(first - 0.5), 0, size))
    return slice(start, max(int(np.clip(np.ceil(last + 0.5), 0, size)), start))


def _place(inner: _Window, outer: _Window) -> tuple[slice, slice]:
    """Where `inner` lies in an array over the pixels of `outer`, which contains it."""
    row, column = outer.rows.start, outer.columns.start
    rows = slice(inner.rows.start - row, inner.rows.stop - row)
    return rows, slice(inner.columns.start - column, inner.columns.stop - column)


def _distance(part: Rounded, window: _Window) -> FloatArray:
    """(h, w) [m]: distance of the window's pixel centres to `part`, negative inside.

    The distance to a convex polygon is the least over its edges, negative where the point lies left of them all; an
    inflated polygon's is that less the radius.
    """
    core = part.core
    if len(core) == 1:
        from_center: FloatArray = np.hypot(window.x[None, :] - core[0, 0], window.y[:, None] - core[0, 1])
        return from_center - part.radius
    if _is_upright_box(core):
        return _distance_to_box(core, window) - part.radius
    x, y = window.x[None, :], window.y[:, None]
    squared = np.full((len(window.y), len(window.x)), np.inf)
    inside = np.full(squared.shape, fill_value=len(core) > 2)
    edges = np.roll(core, -1, axis=0) - core
    for (ax, ay), (ex, ey) in zip(core, edges, strict=True):
        dx, dy = x - ax, y - ay
        along = np.clip((dx * ex + dy * ey) / max(ex * ex + ey * ey, 1e-300), 0.0, 1.0)
        np.minimum(squared, (dx - along * ex) ** 2 + (dy - along * ey) ** 2, out=squared)
        inside &= ex * dy - ey * dx >= 0
    from_core: FloatArray = np.where(inside, -1.0, 1.0) * np.sqrt(squared)
    return from_core - part.radius


def _is_upright_box(core: FloatArray) -> bool:
    """Whether `core` has four corners and sides along the axes, which most walls and objects have."""
    sides = np.diff(core, axis=0)
    return len(core) == 4 and bool((np.count_nonzero(sides, axis=1) == 1).all()) and bool((core[0] != core[2]).all())


def _distance_to_box(core: FloatArray, window: _Window) -> FloatArray:
    """As `_distance` of the core alone: how far beyond its sides a point is, or how far within the nearest one."""
    lower, upper = core.min(axis=0), core.max(axis=0)
    x = np.maximum(lower[0] - window.x, window.x - upper[0])[None, :]
    y = np.maximum(lower[1] - window.y, window.y - upper[1])[:, None]
    from_core: FloatArray = np.hypot(np.maximum(x, 0.0), np.maximum(y, 0.0))
    from_core += np.minimum(np.maximum(x, y), 0.0)
    return from_core


def _coverage(distance: FloatArray, pixel: float) -> FloatArray:
    """Share of each pixel that a shape at signed `distance` [m] covers."""
    share: FloatArray = np.clip(0.5 - distance / pixel, 0.0, 1.0)
    return share


def _blend(pixels: Image, layers: list[tuple[Color, FloatArray]]) -> None:
    """Mixes colours into `pixels` (h, w, 3), each with its (h, w) weights; the weights add up to at most 1."""
    mixed = np.zeros(pixels.shape[:2], dtype=np.bool_)
    for color, weights in layers:
        # Most pixels lie inside of a shape: they take its colour as it is.
        full = weights >= 1
        pixels[full] = _bytes(color)
        mixed |= (weights > 0) ^ full
    edge = np.nonzero(mixed)
    ground = 1.0 - np.sum([weights[edge] for _, weights in layers], axis=0)
    values = pixels[edge] * ground[:, np.newaxis]
    for color, weights in layers:
        values += weights[edge][:, np.newaxis] * _bytes(color)
    pixels[edge] = np.rint(values)


def _bytes(color: Color) -> npt.NDArray[np.uint8]:
    rounded: npt.NDArray[np.uint8] = np.rint(np.array(color) * 255).astype(np.uint8)
    return rounded


def _thinned(points: FloatArray, step: float) -> FloatArray:
    """`points` without those closer than `step` to the one kept before, the last one apart."""
    kept = [points[0]]
    for point in points[1:-1]:
        if np.hypot(*(point - kept[-1])) >= step:
            kept.append(point)
    return np.array([*kept, *points[1:][-1:]])


class _Ink(NamedTuple):
    """(h, w) in 0..1: where a text has ink, cropped to it; and how far its top lies above the baseline [px]."""

    mask: FloatArray
    rise: int


def _ink(text: str, size_px: int) -> _Ink:
    _, top, width, height = cv2.getTextSize((0, 0), text, (0, 0), _font(), size_px, 600)
    baseline = size_px // 2 - top
    mask = np.zeros((2 * height + size_px, width + 2 * size_px), dtype=np.uint8)
    cv2.putText(mask, text, (size_px // 2, baseline), 255, _font(), size_px, 600)
    rows, columns = np.nonzero(mask.any(axis=1))[0], np.nonzero(mask.any(axis=0))[0]
    if len(rows) == 0:
        return _Ink(np.zeros((0, 0)), 0)
    return _Ink(mask[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1] / 255.0, baseline - int(rows[0]))


@cache
def _capital_height(size_px: int) -> int:
    return _ink("H", size_px).rise


@cache
def _font() -> cv2.FontFace:
    return cv2.FontFace("sans")
