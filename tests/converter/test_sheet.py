"""Contact sheets."""

import numpy as np
import pytest

from converter.drawing import Drawing, Inset, Label, Shape
from converter.raster import paint
from converter.sheet import CHARACTER, TEXT, Card, sheet_drawing, sheet_width_px, shortened
from converter.theme import PAPER
from pcg.errors import InputError


def picture(width: float = 1.0, height: float = 1.0) -> Drawing:
    """An empty picture."""
    return Drawing(np.zeros(2), np.array([width, height]), (0.5, 0.5, 0.5), ())


def texts(drawing: Drawing) -> list[str]:
    """All labels of a drawing."""
    return [item.text for item in drawing.items if isinstance(item, Label)]


def test_cards_have_their_names_and_verdicts():
    """In the order of the cards, below the heading."""
    cards = [
        Card("a", picture(), "valid", good=True),
        Card("b", picture(), "blocked", good=False),
        Card("c", picture()),
    ]
    drawing = sheet_drawing(cards, heading="3 scenes")
    assert texts(drawing) == ["a", "valid", "b", "blocked", "c", "3 scenes"]


def test_verdicts_are_coloured_twice():
    """Text and strip are green for good news and red for bad ones; without a verdict there is no strip."""
    cards = [
        Card("a", picture(), "valid", good=True),
        Card("b", picture(), "blocked", good=False),
        Card("c", picture()),
    ]
    drawing = sheet_drawing(cards)
    assert [item.fill for item in drawing.items if isinstance(item, Shape)] == [PAPER.good, PAPER.bad]
    colors = {item.text: item.color for item in drawing.items if isinstance(item, Label)}
    assert (colors["valid"], colors["blocked"], colors["c"]) == (PAPER.good, PAPER.bad, PAPER.outline)


@pytest.mark.parametrize("count", [1, 2, 7, 30, 361])
def test_pictures_do_not_overlap_and_stay_inside(count: int):
    """Whatever the number and the shapes of the pictures."""
    cards = [Card(f"{i}", picture(1.0, 0.5 + i % 3), "v", good=None) for i in range(count)]
    drawing = sheet_drawing(cards)
    insets = [item for item in drawing.items if isinstance(item, Inset)]
    lower = np.array([inset.lower for inset in insets])
    size = [np.array([1.0, np.divide(*inset.drawing.upper[::-1])]) * inset.width for inset in insets]
    upper = lower + np.array(size)
    assert (lower >= drawing.lower).all()
    assert (upper <= drawing.upper).all()
    apart = (lower[:, None] >= upper[None]).any(axis=2) | (upper[:, None] <= lower[None]).any(axis=2)
    assert (apart | np.eye(count, dtype=bool)).all()


def test_rows_are_as_long_as_asked():
    """Three cards in a row are one row of three."""
    places = [i.lower for i in sheet_drawing([Card("", picture())] * 3, columns=3).items if isinstance(i, Inset)]
    assert len({y for _, y in places}) == 1


def test_long_names_are_cut_in_the_middle():
    """Beginning and end stay, which is where names differ, and the rest fits."""
    text = shortened("a-very-long-name-of-a-scene-by-Rnd+FPR-17", 1.0, TEXT)
    assert text.startswith("a-very")
    assert text.endswith("FPR-17")
    assert "…" in text
    assert len(text) * CHARACTER * TEXT <= 1.0
    assert shortened("short", 1.0, TEXT) == "short"


def test_a_sheet_has_a_sensible_size():
    """A few cards are shown at full size, hundreds smaller, and too many to be read are refused."""
    few, many = (sheet_width_px(sheet_drawing([Card("x", picture())] * n)) for n in (4, 360))
    assert few < 1000 < many <= 4000
    assert paint(sheet_drawing([Card("x", picture())] * 4), few).shape[1] == few
    with pytest.raises(InputError, match="too many pictures for one sheet"):
        sheet_width_px(sheet_drawing([Card("x", picture())] * 10_000))


def test_a_sheet_needs_a_card():
    """Nothing to show is a programmer's mistake."""
    with pytest.raises(ValueError, match="at least one card"):
        sheet_drawing([])
