"""Tables with one row a scene and columns for each method: Table I of the paper, and the plans' lengths."""

import math
from collections.abc import Mapping, Sequence

import polars as pl

from evaluate.published import TIME_COLUMNS, PublishedTime, scene_key
from evaluate.scene_statistics import SceneStatistics
from evaluate.summary import Summary, best_of, summaries, time_text
from evaluate.table import BLANK, Entry, Table
from evaluate.trial_frame import names_in

PAPER = "(paper)"
"""Behind a method's name: the column of its published numbers."""


def times_table(frame: pl.DataFrame, published: Mapping[tuple[str, str], PublishedTime] | None = None) -> Table:
    """Table I: planning times of every method on every scene, optionally with published ones beside them."""
    cells, scenes, methods = summaries(frame, "scene", "method"), names_in(frame, "scene"), names_in(frame, "method")
    beside = published or {}
    known = {method for scene in scenes for name, method in beside if name == scene_key(scene)}
    heads = [head for method in methods for head in ([method, f"{method} {PAPER}"] if method in known else [method])]
    rows = []
    for scene in scenes:
        best = best_of({method: cells[scene, method] for method in methods if (scene, method) in cells})
        row = [Entry(scene)]
        for method in methods:
            row.append(_time_entry(method, cells.get((scene, method)), bold=method in best))
            if method in known:
                row.append(_published_entry(beside.get((scene_key(scene), method))))
        rows.append(tuple(row))
    paper = " Columns marked (paper): published numbers, on other machines." if known else ""
    note = (
        "Planning time [s], mean (standard deviation) over the solved runs, and the percentage of runs solved where it "
        "is below 100; - where none is solved, nothing where none was run. In square brackets the mean without "
        "computing subgoals. A run is solved if its plan passes the independent verification. Bold: the largest share "
        f"solved, and of these the least mean.{paper}"
    )
    title = "Planning times by scene and method"
    return Table("times", title, note, ("scene", *heads), tuple(rows), _times_data(scenes, methods, cells))


def plans_table(frame: pl.DataFrame) -> Table:
    """Pick-places and way of the agent of every method on every scene."""
    cells, scenes, methods = summaries(frame, "scene", "method"), names_in(frame, "scene"), names_in(frame, "method")
    heads = [f"{method} {what}" for method in methods for what in ("pick-places", "path [m]")]
    rows = []
    for scene in scenes:
        of_scene = [cells.get((scene, method)) for method in methods]
        values = [v for cell in of_scene for v in ((cell.pick_places, cell.path_length) if cell else (None, None))]
        shown = [cell is not None for cell in of_scene for _ in range(2)]
        least = [min((v for v in values[i::2] if v is not None), default=math.inf) for i in range(2)]
        entries = [
            _mean_entry(value, bold=value is not None and _same(value, least[i % 2])) if shown[i] else BLANK
            for i, value in enumerate(values)
        ]
        rows.append((Entry(scene), *entries))
    note = "Means over the solved runs; - where none is solved. Bold: the least of the row."
    return Table("plans", "Plans by scene and method", note, ("scene", *heads), tuple(rows))


def facts_table(facts: Mapping[str, SceneStatistics]) -> Table:
    """What makes each scene hard."""
    rows = []
    for name, statistics in facts.items():
        must_move, pick_places = statistics.must_move, statistics.pick_places
        rows.append(
            (
                Entry(name),
                _number_entry(statistics.objects),
                _number_entry(statistics.walls),
                Entry(f"{statistics.wall_density:.2f}", value=statistics.wall_density),
                Entry(_YES[statistics.occluded]),
                Entry(f"{statistics.narrowest_passage_m:.3f}", value=statistics.narrowest_passage_m),
                BLANK if must_move is None else _number_entry(must_move),
                BLANK if pick_places is None else _number_entry(pick_places),
                BLANK if statistics.monotone is None else Entry(_YES[statistics.monotone]),
            )
        )
    columns = (
        "scene",
        "objects",
        "walls",
        "wall density",
        "occluded",
        "narrowest passage [m]",
        "must move",
        "fewest pick-places",
        "monotone",
    )
    note = (
        "Walls inside the room and the share of it that they cover; whether the agent sees the goal-object at the "
        "start; width of the narrowest passage on the agent's widest way to goal-object and goal; objects that every "
        "plan must move at least; fewest pick-places of all plans of this study, and whether that plan moves every "
        "object at most once."
    )
    return Table("facts", "What the scenes are like", note, columns, tuple(rows))


_YES = {True: "yes", False: "no"}


def _time_entry(method: str, cell: Summary | None, *, bold: bool) -> Entry:
    if cell is None:
        return BLANK
    return Entry(time_text(cell, net=method.startswith("Btl")), bold, cell.mean)


def _published_entry(published: PublishedTime | None) -> Entry:
    if published is None:
        return BLANK
    if published.mean is None:
        return Entry("-")
    deviation = "" if published.deviation is None else f" ({published.deviation:g})"
    net = published.mean_without_subgoals
    brackets = "" if net is None else f" [{net:g}]"
    share = "" if published.percent == 100 else f" {published.percent:g}%"
    return Entry(f"{published.mean:g}{deviation}{brackets}{share}", value=published.mean)


def _mean_entry(value: float | None, *, bold: bool) -> Entry:
    return Entry("-") if value is None else Entry(f"{value:.1f}", bold, value)


def _number_entry(value: int) -> Entry:
    return Entry(str(value), value=value)


def _same(a: float, b: float) -> bool:
    return f"{a:.1f}" == f"{b:.1f}"


def _times_data(
    scenes: Sequence[str], methods: Sequence[str], cells: Mapping[tuple[str, ...], Summary]
) -> tuple[tuple[str, ...], tuple[tuple[object, ...], ...]]:
    """The numbers in the format of published tables, so that one study can stand beside another."""
    rows = []
    for scene in scenes:
        for method in methods:
            if (cell := cells.get((scene, method))) is not None:
                net = cell.net_mean if method.startswith("Btl") else None
                rows.append((scene, method, cell.mean, cell.deviation, cell.percent, net))
    return TIME_COLUMNS, tuple(rows)
