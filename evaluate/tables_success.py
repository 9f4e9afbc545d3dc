"""Success by groups of scenes: occlusion, as in the paper's text, and difficulty."""

from collections.abc import Mapping, Sequence

import polars as pl

from evaluate.scene_groups import Grouping
from evaluate.statistics import wilson_interval
from evaluate.table import BLANK, Entry, Table
from evaluate.tables_methods import percent
from evaluate.tables_scenes import PAPER
from evaluate.trial_frame import names_in

ALL = "all"
"""The group of all scenes."""


def success_counts(frame: pl.DataFrame, scenes: Sequence[str]) -> dict[str, tuple[int, int]]:
    """Solved trials and all trials of each method on some scenes."""
    counted = (
        frame.filter(pl.col("scene").is_in(scenes)).group_by("method").agg(pl.col("solved").sum(), pl.len().alias("n"))
    )
    return {method: (solved, n) for method, solved, n in counted.iter_rows()}


def success_table(
    frame: pl.DataFrame, grouping: Grouping, published: Mapping[tuple[str, str], float] | None = None
) -> Table:
    """Share of the runs solved by each method in each group of scenes.

    Args:
        frame: As `evaluate.trial_frame.read_trials` gives it.
        grouping: The groups.
        published: Published shares, 0..1, by group and method; a method that has some gets a column for them.
    """
    beside = published or {}
    methods = names_in(frame, "method")
    known = {method for _, method in beside} & set(methods)
    scenes = [scene for members in grouping.groups.values() for scene in members]
    rows = []
    for group, members in {ALL: scenes, **grouping.groups}.items():
        counts = success_counts(frame, members)
        row = [Entry(group), Entry(str(len(members)), value=len(members))]
        for method in methods:
            row.append(_entry(counts.get(method)))
            if method in known:
                share = beside.get((group, method))
                row.append(BLANK if share is None else Entry(percent(share), value=share))
        rows.append(tuple(row))
    heads = [head for method in methods for head in ([method, f"{method} {PAPER}"] if method in known else [method])]
    paper = " Columns marked (paper): the paper's 360 generated scenes, which are others." if known else ""
    note = f"Share of the runs with a verified plan, its 95 % Wilson interval [%], and the runs solved of all.{paper}"
    title = f"Success by {grouping.title}"
    return Table(f"success-{grouping.name}", title, note, ("scenes", "number", *heads), tuple(rows))


def _entry(count: tuple[int, int] | None) -> Entry:
    if count is None:
        return BLANK
    solved, n = count
    low, high = wilson_interval(solved, n)
    return Entry(f"{percent(solved / n)} ({100 * low:.0f} to {100 * high:.0f}) {solved}/{n}", value=solved / n)
