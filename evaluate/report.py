"""The report of a study: tables, plots and a gallery of scenes, put together from its database.

Numbers are aggregated in data frames, scenes pass one at a time, so memory grows with the trials' columns and with what
the page shows, not with plans.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import polars as pl

from converter.plan import Plan
from converter.scene import Scene
from evaluate.plots import Plot, plots_of
from evaluate.published import PublishedTime
from evaluate.scene_groups import groupings
from evaluate.scene_records import SceneRecord, scene_records
from evaluate.store import StoredTrials
from evaluate.table import Table
from evaluate.tables import tables_of
from evaluate.trial_frame import names_in, read_trials, reading
from pcg import json_text


@dataclass(frozen=True)
class Provenance:
    """Where the trials come from.

    Attributes:
        started: When the first one began, UTC.
        finished: When the last one ended, UTC.
        machines: Processors and systems.
        versions: Versions of the libraries.
    """

    started: str
    finished: str
    machines: tuple[str, ...]
    versions: tuple[str, ...]


@dataclass(frozen=True)
class GalleryScene:
    """A scene in the gallery.

    Attributes:
        name: As in the tables.
        runs: Solved and all runs of each method, in the order of the report; None where it was not run.
        occluded: Whether the goal-object is hidden from the agent at the start; None if unknown.
        scene: To be drawn.
        plan: To be played; None without a verified one.
    """

    name: str
    runs: tuple[tuple[int, int] | None, ...]
    occluded: bool
    scene: Scene
    plan: Plan | None


@dataclass(frozen=True, eq=False)
class Report:
    """What a study found.

    Attributes:
        name: Title of the study.
        trials: Number of trials.
        solved: Trials with a verified plan.
        scenes: Names of the scenes.
        methods: Names of the methods.
        tables: Of methods, then of success, then of scenes.
        plots: The plots.
        provenance: Where the trials come from.
    """

    name: str
    trials: int
    solved: int
    scenes: tuple[str, ...]
    methods: tuple[str, ...]
    tables: tuple[Table, ...]
    plots: tuple[Plot, ...]
    provenance: Provenance


def read_report(
    folder: Path,
    published: Mapping[tuple[str, str], PublishedTime] | None = None,
    on_scene: Callable[[], object] = lambda: None,
) -> Report:
    """Tables and plots of the study in `folder`.

    Args:
        folder: Where `manipuzzle study` ran.
        published: Published times to stand beside those of the study; with them also the paper's success rates.
        on_scene: Told about every scene whose statistics are known; the first report computes them, which takes a
            fraction of a second each.

    Raises:
        InputError: there is no study, or its database is damaged.
    """
    frame = read_trials(folder)
    facts = {record.name: record.statistics for record in _told(scene_records(folder, frame), on_scene)}
    groups = groupings(facts, dict(frame.select("scene", "preset").unique(maintain_order=True).iter_rows()))
    return Report(
        name=_title(folder),
        trials=len(frame),
        solved=int(frame["solved"].sum()),
        scenes=tuple(names_in(frame, "scene")),
        methods=tuple(names_in(frame, "method")),
        tables=tuple(tables_of(frame, facts, groups, published)),
        plots=tuple(plots_of(frame, groups)),
        provenance=_provenance(folder),
    )


def gallery(folder: Path, methods: Iterable[str]) -> Iterator[GalleryScene]:
    """The scenes of the study in `folder`, one at a time.

    Raises:
        InputError: there is no study, or its database is damaged.
    """
    frame = read_trials(folder)
    counted = frame.group_by("scene", "method").agg(pl.col("solved").sum(), pl.len().alias("n"))
    counts = {(scene, method): (solved, n) for scene, method, solved, n in counted.iter_rows()}
    for record in scene_records(folder, frame):
        runs = tuple(counts.get((record.name, method)) for method in methods)
        yield GalleryScene(record.name, runs, record.statistics.occluded, record.scene, record.plan)


def _told(records: Iterable[SceneRecord], on_scene: Callable[[], object]) -> Iterator[SceneRecord]:
    for record in records:
        on_scene()
        yield record


def _title(folder: Path) -> str:
    with StoredTrials(folder) as store:
        study = store.study()
    return folder.resolve().name if study is None else study.name


def _provenance(folder: Path) -> Provenance:
    with reading(folder) as connection:
        started, finished = connection.execute("SELECT min(started), max(finished) FROM trial").fetchone()
        machines = [row[0] for row in connection.execute("SELECT DISTINCT machine FROM trial ORDER BY 1 LIMIT 20")]
        versions = [row[0] for row in connection.execute("SELECT DISTINCT versions FROM trial ORDER BY 1 LIMIT 20")]
    return Provenance(
        str(started)[:16].replace("T", " "),
        str(finished)[:16].replace("T", " "),
        tuple(machines),
        tuple(", ".join(f"{name} {version}" for name, version in _versions(text, folder).items()) for text in versions),
    )


def _versions(text: str, folder: Path) -> dict[str, Any]:
    where = f"{folder}: versions"
    return json_text.require_object(json_text.parse(text, where), where)
