"""Expressive range of generators: where their levels lie between few and many walls, short and long solutions.

The plot goes back to Smith and Whitehead (Analyzing the Expressive Range of a Level Generator, PCG workshop 2010): a
two-dimensional histogram per generator, on common axes.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, PercentFormatter

from evaluate.plot_style import TEXT_WIDTH, paper_style
from pcg.arrays import FloatArray
from pcg.level_set import ManifestEntry

PANEL_HEIGHT = 1.9
"""Of a row of panels [inch]."""
PANELS_A_ROW = 4
WALL_BIN, PUSH_BIN = 2, 2
"""Sides of a histogram's cells."""


def expressive_range_figure(level_sets: Mapping[str, Sequence[ManifestEntry]]) -> Figure:
    """Histograms of walls and optimal pushes, one panel a level set, with a cross at the mean.

    Args:
        level_sets: Solved levels by the name of what made them; at least one set, none of them empty.
    """
    points = {name: _points(entries) for name, entries in level_sets.items()}
    largest = np.concatenate(list(points.values())).max(axis=0)
    bins = [np.arange(0, most + size + 1, size) for most, size in zip(largest, (WALL_BIN, PUSH_BIN), strict=True)]
    shares = {
        name: np.histogram2d(found[:, 0], found[:, 1], bins=bins)[0].T / len(found) for name, found in points.items()
    }
    highest = max(float(share.max()) for share in shares.values())
    columns = min(len(points), PANELS_A_ROW)
    rows = -(-len(points) // columns)
    with paper_style():
        width = TEXT_WIDTH * max(columns, 2) / PANELS_A_ROW
        figure = Figure(figsize=(width, PANEL_HEIGHT * rows), layout="constrained")
        axes = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
        for ax, (name, share) in zip(axes.flat, shares.items(), strict=False):
            shown = np.ma.masked_equal(share, 0.0)
            mesh = ax.pcolormesh(*bins, shown, cmap="viridis_r", vmin=0.0, vmax=highest)
            ax.plot(*points[name].mean(axis=0), marker="+", color="#D55E00", markersize=7)
            ax.set_title(f"{name} ({len(points[name])})")
            for axis in (ax.xaxis, ax.yaxis):
                axis.set_major_locator(MaxNLocator(integer=True, nbins=6))
        for ax in axes.flat[len(points) :]:
            ax.set_visible(False)
        for ax in axes.flat[max(0, len(points) - columns) : len(points)]:
            ax.tick_params(labelbottom=True)
        scale = figure.colorbar(mesh, ax=axes, format=PercentFormatter(1.0, decimals=0))
        scale.set_label("share of the levels")
        figure.supxlabel("walls", fontsize=7)
        figure.supylabel("pushes of the shortest solution", fontsize=7)
    return figure


def _points(entries: Sequence[ManifestEntry]) -> FloatArray:
    """(n, 2) walls and pushes."""
    return np.array([(entry.statistics.walls, entry.pushes or 0) for entry in entries], dtype=np.float64)
