"""The tables of a study, each of which says what its trials were allowed."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
import polars as pl

from evaluate.published import PublishedTime, success_by_occlusion
from evaluate.scene_groups import OCCLUSION, Grouping
from evaluate.scene_statistics import SceneStatistics
from evaluate.table import Table, as_markdown
from evaluate.tables_methods import comparison_table, methods_table
from evaluate.tables_scenes import facts_table, plans_table, times_table
from evaluate.tables_success import success_table


def tables_of(
    frame: pl.DataFrame,
    facts: Mapping[str, SceneStatistics],
    groups: Sequence[Grouping],
    published: Mapping[tuple[str, str], PublishedTime] | None,
) -> Iterator[Table]:
    """Tables of methods, then of success, then of scenes.

    Args:
        frame: The trials, as `evaluate.trial_frame.read_trials` gives them.
        facts: Statistics of the scenes by their names.
        groups: Ways to group the scenes.
        published: Published times to stand beside those of the study; with them also the paper's success rates.
    """
    for table in _results(frame, groups, published):
        yield _with_conditions(table, frame)
    if facts:
        yield facts_table(facts)


def overview(name: str, frame: pl.DataFrame) -> str:
    """The Markdown document of the study `name`: times by scene and method, and the methods over all scenes."""
    tables = times_table(frame), methods_table(frame, np.random.default_rng(0))
    titled = (replace(table, title=f"{name}: {table.title[0].lower()}{table.title[1:]}") for table in tables)
    return "\n".join(as_markdown(_with_conditions(table, frame)) for table in titled)


def _results(
    frame: pl.DataFrame, groups: Sequence[Grouping], published: Mapping[tuple[str, str], PublishedTime] | None
) -> Iterator[Table]:
    # Intervals come out the same in every report of the same trials.
    rng = np.random.default_rng(0)
    yield methods_table(frame, rng)
    if (comparisons := comparison_table(frame, rng)) is not None:
        yield comparisons
    for grouping in groups:
        beside = success_by_occlusion() if published is not None and grouping.name.startswith(OCCLUSION) else None
        yield success_table(frame, grouping, beside)
    yield times_table(frame, published)
    yield plans_table(frame)


def _with_conditions(table: Table, frame: pl.DataFrame) -> Table:
    """The table with a note on settings, time limits and seeds."""
    presets = " and ".join(f"`{name}`" for name in frame["settings"].drop_nulls().unique(maintain_order=True))
    limits = " and ".join(f"{limit:g} s" for limit in frame["time_limit"].drop_nulls().unique().sort())
    seeds = frame["seed"].n_unique()
    said = [f"settings {presets}"] * bool(presets) + [f"time limit {limits}"] * bool(limits)
    note = ", ".join([*said, f"{seeds} seed{'' if seeds == 1 else 's'}"])
    return replace(table, note=f"{table.note} {note[0].upper()}{note[1:]}.")
