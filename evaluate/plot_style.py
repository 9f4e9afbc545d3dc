"""How plots look, and how they are written: for papers, and the same bytes for the same data."""

import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

import matplotlib as mpl
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from pcg.files import replacing

COLUMN_WIDTH, TEXT_WIDTH = 3.5, 7.16
"""Widths of a column and of both columns of an IEEE paper [inch]."""

COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#999999")
"""Colours that people with colour blindness tell apart (Okabe and Ito 2008), the darker ones first."""

DASHES: tuple[Literal["-", "--", "-.", ":"], ...] = ("-", "--", "-.", ":")
"""Line styles; the second round of colours gets the second one, so no two methods look alike."""

FORMATS = ("svg", "pdf", "png")

SCREEN_SCALE = 2.1
"""Pixels of a page per point of paper."""

_STYLE: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 7,
    "axes.titlesize": 8,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.5,
    "legend.frameon": False,
    "lines.linewidth": 1.2,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    # TrueType fonts are embedded, which publishers ask for; in SVG, letters become paths.
    "pdf.fonttype": 42,
    "svg.fonttype": "path",
    "svg.hashsalt": "manipuzzle",
    "savefig.dpi": 300,
}

_METADATA = {
    "svg": {"Date": None, "Creator": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
    "png": {"Software": None},
}
"""What would differ from day to day or from version to version is left out."""


@contextmanager
def paper_style() -> Iterator[None]:
    """Everything drawn inside looks alike, whatever the user's own settings are."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(_STYLE)
        yield


def label_logarithmic(axis: Axis) -> None:
    """Labels a logarithmic axis by plain numbers that do not run into each other: 0.01, 0.02, 0.05 or decades alone.

    An axis of less than a decade grows to one. Call it when everything is drawn.
    """
    low, high = sorted(axis.get_view_interval())
    if (missing := 10 * low / high) > 1:
        low, high = low / missing**0.5, high * missing**0.5
        set_limits = axis.axes.set_xlim if axis is axis.axes.xaxis else axis.axes.set_ylim
        set_limits(low, high)
    within_decades = (1.0, 2.0, 5.0) if high < 100 * low else (1.0,)
    axis.set_major_locator(LogLocator(subs=within_decades))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def figure_bytes(figure: Figure, format_: str) -> bytes:
    """A figure as a file of one of `FORMATS`."""
    buffer = io.BytesIO()
    with paper_style():
        if figure.get_layout_engine() is not None:
            # Each drawing moves the layout a little, so it is settled once for all formats.
            figure.draw_without_rendering()
            figure.set_layout_engine("none")
        figure.savefig(buffer, format=format_, metadata=_METADATA[format_])
    return buffer.getvalue()


def write_figure(path: Path, figure: Figure, format_: str) -> None:
    """Writes a figure.

    Raises:
        InputError: the file cannot be written.
    """
    with replacing(path) as temporary:
        temporary.write_bytes(figure_bytes(figure, format_))


def inline_svg(figure: Figure, prefix: str) -> str:
    """A figure as an element of an HTML page.

    Args:
        figure: The figure.
        prefix: Begins every `id`, so that several figures of a page do not share any.
    """
    text = figure_bytes(figure, "svg").decode()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>|<!--.*?-->", "", text, flags=re.DOTALL)
    width = round(SCREEN_SCALE * 72 * figure.get_figwidth())
    text = re.sub(r'^<svg ([^>]*?)width="[^"]*"', rf'<svg \1style="width: {width}px"', text)
    text = re.sub(r'^(<svg [^>]*?) height="[^"]*"', r"\1", text)
    text = re.sub(r'\bid="', f'id="{prefix}-', text)
    return re.sub(r'(href="#|url\(#)', rf"\1{prefix}-", text)


def color_of(index: int) -> str:
    """The colour of the n-th method."""
    return COLORS[index % len(COLORS)]


def dashes_of(index: int) -> Literal["-", "--", "-.", ":"]:
    """The line style of the n-th method."""
    return DASHES[index // len(COLORS) % len(DASHES)]
