"""Drawings as SVG, the vector format: for papers, and for every size of screen.

The same shapes as in `converter.raster`: a rounded polygon becomes straight edges and circular arcs, so it is exact at
every scale. Only plain elements that browsers, Inkscape and converters to PDF agree on are used. Coordinates are pixels
of a picture of the asked width; equal drawings give equal text.
"""

import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from converter.drawing import Drawing, Inset, Item, Label, Line, Rounded, Shape
from converter.shape import FloatArray
from converter.theme import Color
from pcg.files import write_text

FONT = "Helvetica, Arial, sans-serif"

BASELINE = 0.35
"""How far the baseline of text lies below its middle, in font sizes; renderers disagree on the attributes for it."""

_UNSUITABLE = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")
"""Characters that XML does not allow."""


@dataclass(frozen=True)
class Frame:
    """From the world to the coordinates of a picture, whose y points down.

    Attributes:
        left: The world's x [m] at 0.
        top: The world's y [m] at 0.
        scale: Picture units per metre.
        digits: Decimals that are kept.
    """

    left: float = 0.0
    top: float = 0.0
    scale: float = 1.0
    digits: int = 2

    def points(self, xy: FloatArray) -> FloatArray:
        """(n, 2): points of the world (n, 2) [m] in the picture."""
        return (xy - [self.left, self.top]) * [self.scale, -self.scale]

    def number(self, value: float) -> str:
        """The shortest text for a number to the frame's precision."""
        text = f"{value:.{self.digits}f}"
        text = text.rstrip("0").rstrip(".") if "." in text else text
        return "0" if text == "-0" else text

    def length(self, metres: float) -> str:
        """A length of the world in the picture."""
        return self.number(metres * self.scale)

    def place(self, xy: FloatArray) -> str:
        """A point (2,) [m] as `x y`."""
        x, y = self.points(xy[np.newaxis])[0]
        return f"{self.number(x)} {self.number(y)}"


def svg_text(drawing: Drawing, width_px: int, *, title: str = "") -> str:
    """The drawing as the text of an SVG file.

    Args:
        drawing: What to show.
        width_px: Width of the picture; the height follows from the drawing's proportions.
        title: What assistive programs read out.
    """
    return _Writer(drawing, width_px).text(title)


def write_svg(path: Path, drawing: Drawing, width_px: int, *, title: str = "") -> None:
    """Writes an SVG file; equal drawings give equal bytes.

    Raises:
        InputError: the file cannot be written.
    """
    write_text(path, svg_text(drawing, width_px, title=title))


def path_data(parts: Sequence[Rounded], frame: Frame, widened: float = 0.0) -> str:
    """The `d` of a path that covers the union of `parts`, each widened by `widened` [m], by the rule `nonzero`."""
    return "".join(_outline(part.core, part.radius + widened, frame) for part in parts)


def polyline_data(points: FloatArray, frame: Frame) -> str:
    """The `d` of a path along `points` (n, 2) [m]; a single point becomes a path of no length."""
    first, *rest = [frame.place(point) for point in points]
    return f"M{first}L{' '.join(rest or [first])}"


def hex_color(color: Color) -> str:
    """A colour as `#rrggbb`."""
    return "#" + "".join(f"{int(np.rint(channel * 255)):02x}" for channel in color)


def _outline(core: FloatArray, radius: float, frame: Frame) -> str:
    if len(core) == 1:
        west, east = (frame.place(core[0] + np.array([side * radius, 0.0])) for side in (-1, 1))
        arc = _arc(radius, frame)
        return f"M{west}{arc}{east}{arc}{west}Z"
    if radius <= 0:
        return f"M{'L'.join(frame.place(point) for point in core)}Z"
    following = np.roll(core, -1, axis=0)
    edges = following - core
    outward = np.stack([edges[:, 1], -edges[:, 0]], axis=1) / np.hypot(*edges.T)[:, np.newaxis]
    starts, ends = core + radius * outward, following + radius * outward
    arc = _arc(radius, frame)
    sides = [f"{frame.place(start)}L{frame.place(end)}" for start, end in zip(starts, ends, strict=True)]
    return f"M{arc.join([*sides, frame.place(starts[0])])}Z"


def _arc(radius: float, frame: Frame) -> str:
    """A counter-clockwise arc of at most half a circle, up to its end point."""
    r = frame.length(radius)
    return f"A{r} {r} 0 0 0 "


class _Writer:
    """One file: drawings that occur several times become a definition each, which is then used."""

    def __init__(self, drawing: Drawing, width_px: int) -> None:
        self._drawing = drawing
        self._width_px = width_px
        self._count = Counter((inset.drawing, inset.width) for inset in _insets(drawing))
        self._names: dict[tuple[Drawing, float], str] = {}
        self._definitions: list[str] = []
        self._masks = 0

    def text(self, title: str) -> str:
        frame = _frame(self._drawing, self._width_px)
        width, height = _size(self._drawing, frame)
        body = self._body(self._drawing, frame)
        head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
            f'width="{width}" height="{height}" viewBox="0 0 {width} {height}"'
        )
        named = f' role="img">\n<title>{_escaped(title)}</title>' if title else ">"
        definitions = ["<defs>", *self._definitions, "</defs>"] if self._definitions else []
        return "\n".join([head + named, *definitions, *body, "</svg>"]) + "\n"

    def _body(self, drawing: Drawing, frame: Frame) -> list[str]:
        width, height = _size(drawing, frame)
        ground = f'<rect width="{width}" height="{height}" fill="{hex_color(drawing.background)}"/>'
        return [ground, *(line for item in drawing.items for line in _WRITERS[type(item)](self, item, frame))]

    def shape(self, shape: Shape, frame: Frame) -> list[str]:
        fill = f'fill="{hex_color(shape.fill)}"' + _opacity(shape.fill_opacity)
        width = shape.outline_width
        if width <= 0:
            return [f'<path d="{path_data(shape.parts, frame)}" {fill}/>']
        outline = hex_color(shape.outline)
        if len(shape.parts) == 1:
            stroke = f'stroke="{outline}" stroke-width="{frame.length(width)}" stroke-linejoin="round"'
            return [f'<path d="{path_data(shape.parts, frame, width / 2)}" {fill} {stroke}/>']
        around, inside = path_data(shape.parts, frame, width), path_data(shape.parts, frame)
        mask = "" if shape.fill_opacity >= 1 else f' mask="url(#{self._mask(around, inside)})"'
        return [f'<path d="{around}" fill="{outline}"{mask}/>', f'<path d="{inside}" {fill}/>']

    def line(self, line: Line, frame: Frame) -> list[str]:
        stroke = f'stroke="{hex_color(line.color)}" stroke-width="{frame.length(line.width)}"'
        round_ends = 'stroke-linecap="round" stroke-linejoin="round"'
        return [f'<path d="{polyline_data(line.points, frame)}" fill="none" {stroke} {round_ends}/>']

    def label(self, label: Label, frame: Frame) -> list[str]:
        x, y = frame.points(label.position[np.newaxis])[0]
        place = f'x="{frame.number(x)}" y="{frame.number(y + BASELINE * label.height * frame.scale)}"'
        font = f'font-family="{FONT}" font-size="{frame.length(label.height)}" text-anchor="middle"'
        return [f'<text {place} {font} fill="{hex_color(label.color)}">{_escaped(label.text)}</text>']

    def inset(self, inset: Inset, frame: Frame) -> list[str]:
        size = inset.drawing.upper - inset.drawing.lower
        place = frame.place(inset.lower + np.array([0.0, inset.width * size[1] / size[0]]))
        inner = _frame(inset.drawing, inset.width * frame.scale)
        key = (inset.drawing, inset.width)
        if self._count[key] == 1:
            return [f'<g transform="translate({place})">', *self._clipped(inset.drawing, inner), "</g>"]
        if key not in self._names:
            name = self._names[key] = f"drawing{len(self._names) + 1}"
            self._definitions += [f'<g id="{name}">', *self._clipped(inset.drawing, inner), "</g>"]
        return [f'<use xlink:href="#{self._names[key]}" transform="translate({place})"/>']

    def _clipped(self, drawing: Drawing, frame: Frame) -> list[str]:
        width, height = _size(drawing, frame)
        return [f'<svg width="{width}" height="{height}">', *self._body(drawing, frame), "</svg>"]

    def _mask(self, around: str, inside: str) -> str:
        """What keeps an outline from shining through a translucent fill."""
        self._masks += 1
        name = f"mask{self._masks}"
        paths = f'<path d="{around}" fill="#ffffff"/><path d="{inside}" fill="#000000"/>'
        self._definitions.append(f'<mask id="{name}">{paths}</mask>')
        return name


_WRITERS: dict[type[Item], Callable[[_Writer, Any, Frame], list[str]]] = {
    Shape: _Writer.shape,
    Line: _Writer.line,
    Label: _Writer.label,
    Inset: _Writer.inset,
}


def _insets(drawing: Drawing) -> Iterator[Inset]:
    for item in drawing.items:
        if isinstance(item, Inset):
            yield item
            yield from _insets(item.drawing)


def _frame(drawing: Drawing, width: float) -> Frame:
    scale = width / float(drawing.upper[0] - drawing.lower[0])
    return Frame(float(drawing.lower[0]), float(drawing.upper[1]), scale)


def _size(drawing: Drawing, frame: Frame) -> tuple[str, str]:
    width, height = drawing.upper - drawing.lower
    return frame.length(width), frame.length(height)


def _opacity(value: float) -> str:
    return "" if value >= 1 else f' fill-opacity="{value:g}"'


def _escaped(text: str) -> str:
    return escape(_UNSUITABLE.sub("\ufffd", text), quote=False)
