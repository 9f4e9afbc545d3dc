"""Contact sheets: many pictures in a grid, each with its name and a verdict."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from converter.drawing import Drawing, Item, Label, Shape, box, fitted
from converter.shape import FloatArray
from converter.theme import PAPER, Theme
from pcg.errors import InputError

CARD_PX = 220
"""Width of a card, if not too many share the sheet."""

LEAST_CARD_PX = 64
"""Narrowest card whose text can still be read."""

MAX_WIDTH_PX = 4000
MAX_HEIGHT_PX = 4000

ASPECT = 1.5
"""Width of a sheet over its height, about."""

GAP = 0.08
"""Between cards and around the sheet, in widths of a card's picture."""

TEXT = 0.068
LINE_HEIGHT = 0.11
HEADING = 0.14
"""Heights of the text, of a line of it, and of the heading's text, in the same unit."""

STRIP = 0.02
"""Height of the coloured strip that makes verdicts quick to find, and its distance from the picture, in that unit."""

CHARACTER = 0.56
"""Width of a character on average, in font sizes."""


@dataclass(frozen=True, eq=False)
class Card:
    """One picture of a sheet.

    Attributes:
        name: Stands below the picture.
        drawing: The picture.
        verdict: Stands below the name; may be empty.
        good: Whether the verdict is good news; None for neither.
    """

    name: str
    drawing: Drawing
    verdict: str = ""
    good: bool | None = None


def sheet_drawing(
    cards: Sequence[Card], *, heading: str = "", columns: int | None = None, theme: Theme = PAPER
) -> Drawing:
    """The cards row by row; a card's picture is one unit wide.

    Args:
        cards: At least one.
        heading: Stands above them.
        columns: Cards in a row; None for a sheet of pleasant proportions.
        theme: Colours.

    Raises:
        ValueError: there are no cards.
    """
    if not cards:
        raise ValueError("a sheet needs at least one card")
    picture = _picture_height(cards)
    lines = 2 if any(card.verdict for card in cards) else 1
    pitch = np.array([1.0 + GAP, picture + GAP + lines * LINE_HEIGHT])
    columns = columns or _columns(len(cards), pitch)
    rows = -(-len(cards) // columns)
    top = GAP + (HEADING + 2 * GAP if heading else 0.0)
    upper = np.array([columns * pitch[0] + GAP, rows * pitch[1] + top + GAP / 2])
    items: list[Item] = []
    for i, card in enumerate(cards):
        row, column = divmod(i, columns)
        corner = np.array([GAP + column * pitch[0], upper[1] - top - row * pitch[1]])
        items += _card_items(card, corner, picture, theme)
    if heading:
        center = np.array([upper[0] / 2, upper[1] - GAP - HEADING / 2])
        height = min(HEADING, (upper[0] - 2 * GAP) / (CHARACTER * len(heading)))
        items.append(Label(heading, center, height, theme.outline))
    return Drawing(np.zeros(2), upper, theme.page, tuple(items))


def sheet_width_px(drawing: Drawing) -> int:
    """The width that shows a sheet's cards well.

    Raises:
        InputError: so many cards share the sheet that their text could not be read.
    """
    width, height = drawing.upper
    card_px = min(CARD_PX, MAX_WIDTH_PX / width, MAX_HEIGHT_PX / height)
    if card_px < LEAST_CARD_PX:
        count = round(MAX_WIDTH_PX * MAX_HEIGHT_PX / LEAST_CARD_PX**2 / 1.5, -2)
        raise InputError("sheet", f"too many pictures for one sheet; about {count:g} can be read on it")
    return round(float(card_px * width))


def shortened(text: str, width: float, height: float) -> str:
    """`text` cut in the middle, if it would be wider than `width` in letters of `height`."""
    most = max(int(width / (CHARACTER * height)), 3)
    if len(text) <= most:
        return text
    end = most // 2
    return f"{text[: most - 1 - end]}…{text[len(text) - end :]}"


def _picture_height(cards: Sequence[Card]) -> float:
    """Height of the tallest picture, which is at most square: wide pictures leave no empty stripes."""
    sizes = [card.drawing.upper - card.drawing.lower for card in cards]
    return float(min(max(height / width for width, height in sizes), 1.0))


def _columns(count: int, pitch: FloatArray) -> int:
    return min(count, max(round(float(np.sqrt(count * ASPECT * pitch[1] / pitch[0]))), 1))


def _card_items(card: Card, corner: FloatArray, picture: float, theme: Theme) -> list[Item]:
    """A card whose upper left corner is at `corner` (2,)."""
    middle = corner + np.array([0.5, -picture / 2])
    line = corner + np.array([0.5, -picture - 0.75 * LINE_HEIGHT])
    items: list[Item] = [fitted(card.drawing, middle, (1.0, picture))]
    items.append(Label(shortened(card.name, 1.0, TEXT), line, TEXT, theme.outline))
    if card.verdict:
        color = theme.move if card.good is None else theme.good if card.good else theme.bad
        below = line - np.array([0.0, LINE_HEIGHT])
        items.append(Label(shortened(card.verdict, 1.0, TEXT), below, TEXT, color))
    if card.good is not None:
        strip = corner + np.array([0.5, -picture - STRIP])
        items.append(Shape((box(strip, (1.0, STRIP)),), theme.good if card.good else theme.bad))
    return items
