"""What a picture shows, independent of how it is painted: shapes, lines and labels in world coordinates.

A drawing is a list of items, later ones above earlier ones; x points right and y up. `converter.raster` paints one in
pixels, `converter.svg` writes one as vectors.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from converter.scene import Body
from converter.shape import FloatArray, Part
from converter.theme import Color


class Rounded(NamedTuple):
    """The convex polygon `core` (n, 2) [m], counter-clockwise, n >= 1, inflated by a disc of `radius` [m]."""

    core: FloatArray
    radius: float


@dataclass(frozen=True, eq=False)
class Shape:
    """The union of rounded convex polygons, filled with one colour.

    The fill covers exactly the union; the outline lies around it, outside.

    Attributes:
        parts: The polygons.
        fill: Colour of the inside.
        fill_opacity: 0..1.
        outline: Colour of the outline.
        outline_width: [m]; 0 for none.
    """

    parts: tuple[Rounded, ...]
    fill: Color
    fill_opacity: float = 1.0
    outline: Color = (0.0, 0.0, 0.0)
    outline_width: float = 0.0


@dataclass(frozen=True, eq=False)
class Line:
    """A polyline with round ends and corners.

    Attributes:
        points: (n, 2) [m], n >= 1.
        width: [m].
        color: Its colour.
    """

    points: FloatArray
    width: float
    color: Color


@dataclass(frozen=True, eq=False)
class Label:
    """One line of text, centred.

    Attributes:
        text: What it says.
        position: (2,) [m]: the middle of the text, half a capital letter above its baseline.
        height: Font size [m].
        color: Its colour.
    """

    text: str
    position: FloatArray
    height: float
    color: Color


@dataclass(frozen=True, eq=False)
class Inset:
    """A drawing inside another one; what lies outside of its own rectangle is cut off.

    Attributes:
        drawing: The inner drawing; its background covers what is below.
        lower: (2,) [m], in the outer drawing: where the inner one's lower left corner comes to lie.
        width: Of the inner drawing [m], in the outer one; its height follows from its proportions.
    """

    drawing: "Drawing"
    lower: FloatArray
    width: float


Item = Shape | Line | Label | Inset


@dataclass(frozen=True, eq=False)
class Drawing:
    """Items and the rectangle that the picture shows.

    Attributes:
        lower: (2,) [m]: the picture's lower left corner.
        upper: (2,) [m]: its upper right corner.
        background: Colour under all items.
        items: From bottom to top.
    """

    lower: FloatArray
    upper: FloatArray
    background: Color
    items: tuple[Item, ...]

    @property
    def unit(self) -> float:
        """A six-hundredth of the longer side [m], the unit of a theme's widths."""
        return float((self.upper - self.lower).max()) / 600


def disc(center: npt.ArrayLike, radius: float) -> Rounded:
    """The disc around `center` (2,) [m]."""
    return Rounded(np.asarray(center, dtype=np.float64).reshape(1, 2), radius)


def box(center: npt.ArrayLike, size: npt.ArrayLike, edge_radius: float = 0.0) -> Rounded:
    """The axis-aligned box around `center` (2,) [m] of outer `size` (2,) [m], its edges rounded by `edge_radius`."""
    sx, sy = np.asarray(size, dtype=np.float64)
    return Rounded(Part.box((sx, sy), edge_radius).core + np.asarray(center), edge_radius)


def footprint(body: Body, position: FloatArray | None = None) -> tuple[Rounded, ...]:
    """The parts of `body`, moved to `position` (2,) [m] if that is given."""
    xy = body.position[:2] if position is None else position
    return tuple(Rounded(core + xy, part.edge_radius) for core, part in zip(body.cores, body.parts, strict=True))


def extent(parts: tuple[Rounded, ...]) -> FloatArray:
    """(2, 2) [m]: lower and upper corner of the box around `parts`."""
    lower = np.min([part.core.min(axis=0) - part.radius for part in parts], axis=0)
    upper = np.max([part.core.max(axis=0) + part.radius for part in parts], axis=0)
    return np.array([lower, upper])


def fitted(drawing: Drawing, center: npt.ArrayLike, size: npt.ArrayLike) -> Inset:
    """`drawing` as large as it fits into the box around `center` (2,) [m] of `size` (2,) [m]."""
    own = drawing.upper - drawing.lower
    scale = float((np.asarray(size) / own).min())
    return Inset(drawing, np.asarray(center) - scale * own / 2, scale * float(own[0]))
