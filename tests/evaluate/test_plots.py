"""Plots of a study."""

import itertools
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import polars as pl
import pytest
from matplotlib.figure import Figure

from evaluate.plot_style import COLUMN_WIDTH, FORMATS, figure_bytes, inline_svg, label_logarithmic, paper_style
from evaluate.plots import CURVE_POINTS, MAX_METHODS, curves_plot, plots_of, times_plot
from evaluate.scene_groups import Grouping
from evaluate.trial_frame import read_trials

GROUPING = Grouping("occlusion", "occlusion", {"not occluded": ["wall"], "occluded": ["corner", "open"]})


def test_equal_data_give_equal_files(two_methods: Path):
    """In every format, to the byte; PDF files embed their fonts as TrueType."""
    frame = read_trials(two_methods)
    first, second = (curves_plot(frame).figure for _ in range(2))
    for format_ in FORMATS:
        assert figure_bytes(first, format_) == figure_bytes(second, format_)
    assert b"/FontFile2" in figure_bytes(first, "pdf")
    assert b"/Type3" not in figure_bytes(first, "pdf")


def test_plots_without_solved_runs(two_methods: Path):
    """Times are plotted where there are any; success always."""
    frame = read_trials(two_methods)
    assert [plot.name for plot in plots_of(frame, [GROUPING])] == ["times", "solved-within", "success"]
    unsolved = frame.filter(~pl.col("solved"))
    assert [plot.name for plot in plots_of(unsolved, [GROUPING])] == ["success"]


def test_the_best_of_many_methods_are_plotted(make_study: Callable[..., Path], make_run: Callable[..., Any]):
    """Of a sweep the methods that solve most, and of these the fastest, are shown in their order; the note counts on."""
    solved = [make_run("wall", f"m{i:02}", 0, 1.0 + i) for i in range(MAX_METHODS + 2)]
    frame = read_trials(make_study([make_run("wall", "none", 0, None), *solved]))
    boxes, curves = plots_of(frame, [])
    assert [line.get_label() for line in curves.figure.axes[0].lines] == [f"m{i:02}" for i in range(MAX_METHODS)]
    for plot in (boxes, curves):
        assert plot.note.endswith(" 3 methods are left out, which solve fewer runs or take longer.")


def test_boxes_hold_solved_runs_without_subgoal_time(two_methods: Path):
    """Of Btl in `corner` the box spans 0.25 s to 0.45 s; A has none there, for it solved nothing."""
    axes = times_plot(read_trials(two_methods)).figure.axes
    by_title = {ax.get_title(): ax for ax in axes}
    medians = [line.get_ydata()[0] for line in by_title["corner"].lines if line.get_linewidth() == pytest.approx(1.6)]
    assert medians == [pytest.approx(0.35)]


def test_curves_end_at_the_share_of_runs_solved(two_methods: Path):
    """A solves 3 of 5 runs, Btl 3 of 4, and no curve is longer than the eye can follow."""
    lines = curves_plot(read_trials(two_methods)).figure.axes[0].lines
    assert [line.get_ydata()[-1] for line in lines] == [0.6, 0.75]
    assert all(len(line.get_xdata()) <= CURVE_POINTS + 2 for line in lines)


@pytest.mark.parametrize(("low", "high"), [(0.0013, 0.06), (0.010, 0.011), (1.0, 1.0), (3e-4, 90.0), (0.9, 2.1)])
@pytest.mark.parametrize("name", ["x", "y"])
def test_labels_of_logarithmic_axes_stand_apart(name: str, low: float, high: float):
    """Two at least, in plain numbers, none over another, whatever the times are."""
    with paper_style():
        figure = Figure(figsize=(COLUMN_WIDTH, 1.35), layout="constrained")
        ax = figure.subplots()
        ax.plot([low, high], [low, high])
        ax.set(**{f"{name}scale": "log"})
        axis = ax.xaxis if name == "x" else ax.yaxis
        label_logarithmic(axis)
        figure.draw_without_rendering()
        begin, end = axis.get_view_interval()
        labels = [label for label in axis.get_ticklabels(which="both") if label.get_text()]
        inside = [label for label in labels if begin <= label.get_position()["xy".index(name)] <= end]
        boxes = [label.get_window_extent() for label in inside]
    assert len(inside) >= 2
    assert all(re.fullmatch(r"[0-9.]+", label.get_text()) for label in inside)
    assert not any(one.overlaps(other) for one, other in itertools.combinations(boxes, 2))


def test_long_names_stay_in_the_figure(two_methods: Path):
    """Legends take fewer columns, titles smaller letters; all is inside, and no title runs into the next one."""
    long = "a method with settings [keep_share=0.5,near_share=0.0]"
    frame = pl.concat(
        read_trials(two_methods).with_columns(
            method=pl.lit(f"{i} {long}"), scene=pl.lit(f"{'long-' * i}scene-{i} (published)"), solved=pl.lit(value=True)
        )
        for i in range(12)
    )
    for plot in plots_of(frame, [GROUPING]):
        plot.figure.draw_without_rendering()
        (legend,) = plot.figure.legends
        inside = plot.figure.bbox.padded(1)
        assert all(inside.contains(x, y) for x, y in legend.get_window_extent().corners())
        titles = [ax.title.get_window_extent() for ax in plot.figure.axes if ax.get_title()]
        assert all(inside.contains(x, y) for box in titles for x, y in box.corners())
        assert not any(one.overlaps(other) for one, other in itertools.combinations(titles, 2))


def test_inline_figures_share_no_ids(two_methods: Path):
    """Every reference of an inline figure leads to an element of the same figure."""
    frame = read_trials(two_methods)
    svg = inline_svg(curves_plot(frame).figure, "one")
    ids = set(re.findall(r'\bid="([^"]*)"', svg))
    references = set(re.findall(r'(?:href="#|url\(#)([^")]*)', svg))
    assert ids
    assert references
    assert references <= ids
    assert all(name.startswith("one-") for name in ids)
    assert "<!--" not in svg
