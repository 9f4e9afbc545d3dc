"""Plots of a study: box plots per scene, solved-versus-time curves, success by difficulty.

Figures are made without a window system and without global state; `evaluate.plot_style` writes them.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import polars as pl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import PercentFormatter

from evaluate.plot_style import COLUMN_WIDTH, TEXT_WIDTH, color_of, dashes_of, label_logarithmic, paper_style
from evaluate.scene_groups import Grouping
from evaluate.statistics import FloatArray, solved_within, wilson_interval
from evaluate.tables_success import success_counts
from evaluate.trial_frame import names_in, planning_times
from pcg.printable import one_line, printable

MAX_METHODS = 16
"""Methods in a plot: as many as two rounds of colours tell apart."""

MAX_BOXED_SCENES = 24
"""Scenes in the box plots; of more, those with the longest times are shown."""

SCENES_A_ROW = 6
MAX_GROUPS = 8
"""Groups of scenes that fit beside each other."""

LEGEND_COLUMNS = 7
LEGEND_LENGTH = 45
"""Letters of a method's name that fit into a column of a paper."""

TITLE_LENGTH = 18
"""Letters of a scene's name that fit above its plot."""

CURVE_POINTS = 400
"""Steps of a curve; nobody sees more."""


@dataclass(frozen=True, eq=False)
class Plot:
    """A figure for the report.

    Attributes:
        name: Stem of its files.
        title: What it shows.
        note: How to read it.
        figure: The figure, of a paper's column or text width.
    """

    name: str
    title: str
    note: str
    figure: Figure


def plots_of(frame: pl.DataFrame, groupings: Sequence[Grouping]) -> list[Plot]:
    """All plots of the trials (`evaluate.trial_frame.read_trials`); those without any solved run are left out."""
    best = _best_methods(frame)
    left_out = frame["method"].n_unique() - len(best)
    frame, plots = frame.filter(pl.col("method").is_in(best)), []
    if frame["solved"].any():
        plots += [times_plot(frame), curves_plot(frame)]
    if difficulty := [grouping for grouping in groupings if 1 < len(grouping.groups) <= MAX_GROUPS]:
        plots.append(success_plot(frame, difficulty))
    more = f" {left_out} methods are left out, which solve fewer runs or take longer." if left_out else ""
    return [replace(plot, note=plot.note + more) for plot in plots]


def _best_methods(frame: pl.DataFrame) -> list[str]:
    """The methods to be plotted: those that solve most runs, and of these the fastest."""
    solved = pl.col("solved")
    found = frame.group_by("method", maintain_order=True).agg(solved.mean(), pl.col("time_s").filter(solved).mean())
    ranked = found.sort("solved", "time_s", descending=[True, False], nulls_last=True, maintain_order=True)
    return ranked["method"][:MAX_METHODS].to_list()


def times_plot(frame: pl.DataFrame) -> Plot:
    """Box plots of the solved runs' times per scene, after Fig. 6 of [L]: methods Btl without subgoal computation."""
    net = pl.when(pl.col("method").str.starts_with("Btl")).then(pl.col("subgoal_time_s").fill_null(0.0)).otherwise(0.0)
    solved = frame.filter("solved").with_columns(net_s=(pl.col("time_s") - net).clip(1e-6))
    by_scene = solved.group_by("scene", maintain_order=True).agg(pl.col("net_s").median())
    scenes, left_out = names_in(solved, "scene"), 0
    if len(scenes) > MAX_BOXED_SCENES:
        slowest = by_scene.sort("net_s", descending=True, maintain_order=True)["scene"][:MAX_BOXED_SCENES].to_list()
        left_out = len(scenes) - len(slowest)
        scenes = [scene for scene in scenes if scene in set(slowest)]
    methods = names_in(frame, "method")
    with paper_style():
        columns = min(SCENES_A_ROW, len(scenes))
        rows = math.ceil(len(scenes) / columns)
        width = TEXT_WIDTH if columns > 3 else COLUMN_WIDTH
        figure = Figure(figsize=(width, 1.35 * rows + 0.35), layout="constrained")
        axes = figure.subplots(rows, columns, squeeze=False, sharey=True).ravel()
        for i, (ax, scene) in enumerate(zip(axes, scenes, strict=False)):
            _boxes(ax, solved.filter(pl.col("scene") == scene), methods)
            _title(ax, scene)
            if i % columns == 0:
                ax.set_ylabel("time [s]")
        label_logarithmic(axes[0].yaxis)
        for ax in axes[len(scenes) :]:
            ax.set_axis_off()
        _legend(figure, methods)
    more = f" {left_out} faster scenes are left out." if left_out else ""
    note = (
        "Times of the solved runs: median, quartiles, whiskers to the furthest run within 1.5 quartile ranges, and the "
        f"others as dots. Unsolved runs are left out; methods Btl without computing subgoals.{more}"
    )
    return Plot("times", "Planning times per scene", note, figure)


def curves_plot(frame: pl.DataFrame) -> Plot:
    """Share of the runs that each method solves within a time (cactus plot)."""
    times = planning_times(frame)
    with paper_style():
        figure = Figure(figsize=(COLUMN_WIDTH, 2.4), layout="constrained")
        ax = figure.subplots()
        longest = max(float(m[np.isfinite(m)].max(initial=0.0)) for m in times.values())
        for i, (method, matrix) in enumerate(times.items()):
            seconds, shares = _thinned(*solved_within(matrix))
            if len(seconds):
                x = np.concatenate([seconds[:1], seconds, [longest]])
                y = np.concatenate([[0.0], shares, shares[-1:]])
                ax.step(x, y, where="post", color=color_of(i), linestyle=dashes_of(i), label=_plain(method))
        ax.set_xscale("log")
        label_logarithmic(ax.xaxis)
        ax.set_xlabel("time [s]")
        ax.set_ylabel("runs solved")
        ax.set_ylim(0, 1.02)
        ax.yaxis.set_major_formatter(PercentFormatter(1.0))
        ax.grid(visible=True)
        _legend(figure, list(times))
    note = "Share of all runs, over all scenes and seeds, that are solved within the time."
    return Plot("solved-within", "Solved within a time", note, figure)


def success_plot(frame: pl.DataFrame, groupings: Sequence[Grouping]) -> Plot:
    """Share of runs solved by groups of scenes of rising difficulty, with Wilson intervals."""
    methods = names_in(frame, "method")
    with paper_style():
        columns = min(2, len(groupings))
        rows = math.ceil(len(groupings) / columns)
        width = TEXT_WIDTH if columns > 1 else COLUMN_WIDTH
        figure = Figure(figsize=(width, 1.7 * rows + 0.35), layout="constrained")
        axes = figure.subplots(rows, columns, squeeze=False, sharey=True).ravel()
        for ax, grouping in zip(axes, groupings, strict=False):
            _success(ax, frame, grouping, methods)
        for ax in axes[len(groupings) :]:
            ax.set_axis_off()
        for ax in axes[::columns]:
            ax.set_ylabel("runs solved")
        _legend(figure, methods)
    note = "Share of the runs solved, with the 95 % Wilson interval; below each group the number of its scenes."
    return Plot("success", "Success by difficulty", note, figure)


def _boxes(ax: Axes, runs: pl.DataFrame, methods: Sequence[str]) -> None:
    for i, method in enumerate(methods):
        values = runs.filter(pl.col("method") == method)["net_s"].to_numpy()
        if len(values):
            line = {"color": color_of(i), "linewidth": 0.8}
            ax.boxplot(
                values,
                positions=[i],
                widths=0.6,
                boxprops=line,
                whiskerprops=line,
                capprops=line,
                medianprops={**line, "linewidth": 1.6},
                flierprops={"marker": ".", "markersize": 2.5, "markeredgecolor": color_of(i)},
            )
    ax.set_yscale("log")
    ax.set_xlim(-0.7, len(methods) - 0.3)
    ax.set_xticks([])
    ax.grid(visible=True, axis="y")


def _success(ax: Axes, frame: pl.DataFrame, grouping: Grouping, methods: Sequence[str]) -> None:
    width = 0.8 / len(methods)
    for i, method in enumerate(methods):
        found = [
            (place + (i + 0.5) * width - 0.4, *counts[method])
            for place, members in enumerate(grouping.groups.values())
            if method in (counts := success_counts(frame, members))
        ]
        if not found:
            continue
        x, solved, trials = (np.array(values, dtype=float) for values in zip(*found, strict=True))
        limits = np.array([wilson_interval(int(s), int(n)) for s, n in zip(solved, trials, strict=True)]).T
        rates = solved / trials
        errors = np.abs(limits - rates)
        bars = ax.errorbar(
            x, rates, errors, color=color_of(i), linestyle="none", marker="o", markersize=3, elinewidth=0.8
        )
        for artist in bars.get_children():
            artist.set_clip_on(False)  # all of the dots at 100 %
    names = [f"{_plain(name)}\n({len(members)})" for name, members in grouping.groups.items()]
    ax.set_xticks(range(len(names)), names)
    ax.tick_params(axis="x", length=0)
    ax.set_title(grouping.title, fontsize=7)
    ax.set_xlim(-0.5, len(names) - 0.5)
    ax.set_ylim(-0.02, 1.02)
    ax.yaxis.set_major_formatter(PercentFormatter(1.0))
    ax.grid(visible=True, axis="y")


def _legend(figure: Figure, methods: Sequence[str]) -> None:
    """The methods below the plots, in as many columns as fit; the figure grows by all rows but the first."""
    handles = [
        Line2D([], [], color=color_of(i), linestyle=dashes_of(i), label=_plain(one_line(method, LEGEND_LENGTH)))
        for i, method in enumerate(methods)
    ]
    columns = min(len(methods), LEGEND_COLUMNS)
    legend = figure.legend(handles=handles, loc="outside lower center", ncols=columns)
    while (box := legend.get_window_extent()).width > figure.bbox.width and columns > 1:
        columns -= 1
        legend.remove()
        legend = figure.legend(handles=handles, loc="outside lower center", ncols=columns)
    rows = math.ceil(len(methods) / columns)
    figure.set_figheight(figure.get_figheight() + (1 - 1 / rows) * box.height / figure.dpi)


def _title(ax: Axes, scene: str) -> None:
    """The name of a scene above its plot, in letters that fit; the geometry on a line of its own."""
    name, _, geometry = scene.rpartition(" (")
    lines = [name, f"({geometry}"] if name and len(scene) > TITLE_LENGTH else [scene]
    lines = [_plain(one_line(line, 2 * TITLE_LENGTH)) for line in lines]
    size = 7 * min(1.0, TITLE_LENGTH / max(map(len, lines)))
    ax.set_title("\n".join(lines), fontsize=size)


def _thinned(seconds: FloatArray, shares: FloatArray) -> tuple[FloatArray, FloatArray]:
    if len(seconds) <= CURVE_POINTS:
        return seconds, shares
    kept = np.unique(np.linspace(0, len(seconds) - 1, CURVE_POINTS).round().astype(int))
    return seconds[kept], shares[kept]


def _plain(text: str) -> str:
    """Text without the dollar signs that would begin a formula, and without what no font has."""
    return printable(text).replace("$", r"\$")
