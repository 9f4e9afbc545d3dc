"""The trials of a study as a data frame, read in batches: all that tables and plots need of them, without the plans.

Besides `evaluate.store` only what uses `reading` asks the database: this, `evaluate.scene_records`, `evaluate.report`.
"""

import contextlib
import json
import sqlite3
import tempfile
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl

from evaluate.statistics import FloatArray
from evaluate.store import FILE_NAME, StoredTrials, read_only
from evaluate.study_record import StudyRecord
from pcg import json_text
from pcg.errors import InputError
from pcg.files import replacing

BATCH = 20_000
"""Rows that are in memory as Python objects at a time."""

_COLUMNS = {
    "row": ("rowid", pl.Int64),
    "scene": ("scene", pl.String),
    "scene_hash": ("scene_hash", pl.String),
    "method": ("method", pl.String),
    "settings_hash": ("settings_hash", pl.String),
    "seed": ("seed", pl.Int64),
    "status": ("status", pl.String),
    "solved": ("coalesce(verified, 0)", pl.Boolean),
    "accepted": ("CAST(json_extract(counters, '$.accepted') AS INTEGER)", pl.Int64),
    "time_s": ("time_s", pl.Float64),
    "subgoal_time_s": ("CAST(json_extract(counters, '$.subgoal_time_s') AS REAL)", pl.Float64),
    "path_length_m": ("path_length_m", pl.Float64),
    "pick_places": ("pick_places", pl.Int64),
    "time_limit": ("CAST(json_extract(settings, '$.time_limit') AS REAL)", pl.Float64),
    "settings": ("CAST(json_extract(settings, '$.preset') AS TEXT)", pl.String),
    "preset": ("preset", pl.String),
}
"""Columns of the frame: what they are in SQL, and their types."""

_METHOD = ("method", "settings_hash")
"""Columns that tell methods apart."""


@contextlib.contextmanager
def reading(folder: Path) -> Iterator[sqlite3.Connection]:
    """The database of a study, for reading only; a study may write to it meanwhile.

    Raises:
        InputError: there is none in `folder`, or it is damaged.
    """
    # Opening it this way checks its version.
    with StoredTrials(folder):
        path = folder / FILE_NAME
    try:
        with contextlib.closing(read_only(path)) as connection:
            yield connection
    except sqlite3.Error as error:
        raise InputError(str(path), f"not usable as a study's database: {error}") from None


def read_trials(folder: Path) -> pl.DataFrame:
    """One row a trial with the columns of `_COLUMNS`.

    Only the trials of the study that last ran in the folder count, if it holds others too. Names are made to tell
    apart what differs: scenes get their geometry preset if there are several, and the beginning of their hash if that
    is not enough; methods of one name get the settings in which they differ.

    Raises:
        InputError: there is no study in `folder`, its database is damaged, or it holds no trials.
    """
    expressions = ", ".join(f"{sql} AS {name}" for name, (sql, _) in _COLUMNS.items())
    schema = {name: type_ for name, (_, type_) in _COLUMNS.items()}
    with StoredTrials(folder) as store, reading(folder) as connection:
        rows = connection.execute(f"SELECT {expressions} FROM trial ORDER BY rowid")  # noqa: S608  # no outside text
        frames = [pl.DataFrame(batch, schema=schema, orient="row") for batch in _batches(rows)]
        settings = _settings(connection)
        study = store.study()
    frame = pl.concat([pl.DataFrame(schema=schema), *frames])
    frame = frame if study is None else _of_study(frame, study)
    if not frame.select(pl.col("time_s", "path_length_m", "time_limit").is_finite().all()).row(0) == (True, True, True):
        raise InputError(str(folder), "times and path lengths have to be finite")
    if frame.is_empty():
        raise InputError(str(folder), "the study holds no trials yet")
    labels = _method_labels({method: settings[method] for method in frame.select(_METHOD).unique().iter_rows()})
    names = pl.DataFrame(labels, schema=[*_METHOD, "label"], orient="row")
    frame = frame.join(names, on=_METHOD, how="left", maintain_order="left")
    return _with_scene_labels(frame.with_columns(method=pl.col("label")).drop("label"))


def _of_study(frame: pl.DataFrame, study: StudyRecord) -> pl.DataFrame:
    """The trials of a study, in the order of its scenes and methods."""
    scenes = pl.DataFrame(study.scenes, schema=["scene", "scene_hash"], orient="row").with_row_index("scene_place")
    methods = pl.DataFrame(study.methods, schema=["method", "settings_hash"], orient="row").with_row_index("place")
    return (
        frame.filter(pl.col("seed").is_in(study.seeds))
        .join(scenes, on=["scene", "scene_hash"])
        .join(methods, on=["method", "settings_hash"])
        .sort("scene_place", "place", "seed", maintain_order=True)
        .drop("scene_place", "place")
    )


def _with_scene_labels(frame: pl.DataFrame) -> pl.DataFrame:
    if frame["preset"].n_unique() > 1:
        frame = frame.with_columns(scene=pl.format("{} ({})", "scene", pl.col("preset").fill_null("other")))
    is_unique = pl.col("scene_hash").n_unique().over("scene") == 1
    marked = pl.format("{} [{}]", "scene", pl.col("scene_hash").str.head(4))
    return frame.with_columns(scene=pl.when(is_unique).then("scene").otherwise(marked))


def planning_times(frame: pl.DataFrame, *, column: str = "time_s") -> dict[str, FloatArray]:
    """The times of each method as a (runs, scenes) matrix, see `evaluate.statistics`.

    Scenes and methods are in the order in which they first occur. A seed has the same row in all methods; with other
    seeds for each scene a row is the n-th seed of each.

    Args:
        frame: As `read_trials` gives it.
        column: Where the times of solved runs are.
    """
    scenes, methods = names_in(frame, "scene"), names_in(frame, "method")
    indexed = frame.select(
        "method",
        scene=pl.col("scene").replace_strict(scenes, range(len(scenes)), return_dtype=pl.Int64),
        run=pl.col("seed").rank("dense").over("scene").cast(pl.Int64) - 1,
        time=pl.when("solved").then(column).otherwise(np.inf),
    )
    runs = int(indexed["run"].max()) + 1  # type: ignore[arg-type]  # polars cannot know that it is a number
    matrices = {}
    for method in methods:
        rows = indexed.filter(pl.col("method") == method)
        matrix = np.full((runs, len(scenes)), np.nan)
        matrix[rows["run"].to_numpy(), rows["scene"].to_numpy()] = rows["time"].to_numpy()
        matrices[method] = matrix
    return matrices


def names_in(frame: pl.DataFrame, column: str) -> list[str]:
    """The different values of a column in the order in which they first occur."""
    return frame[column].unique(maintain_order=True).to_list()


def write_parquet(folder: Path, path: Path) -> int:
    """Writes all rows of a study to a Parquet file, every column but the plans; in bounded memory.

    Returns:
        The number of rows.

    Raises:
        InputError: there is no study, or the file cannot be written.
    """
    with reading(folder) as connection, replacing(path) as temporary, tempfile.TemporaryDirectory() as parts:
        columns = [row[1] for row in connection.execute("PRAGMA table_info(trial)") if row[1] != "plan"]
        types = connection.execute("SELECT type FROM pragma_table_info('trial') WHERE name != 'plan'")
        schema = {name: _PARQUET_TYPES[type_] for name, (type_,) in zip(columns, types, strict=True)}
        rows = connection.execute(f"SELECT {', '.join(columns)} FROM trial ORDER BY rowid")  # noqa: S608  # our columns
        files = []
        for i, batch in enumerate(_batches(rows)):
            files.append(Path(parts) / f"{i:06}.parquet")
            pl.DataFrame(batch, schema=schema, orient="row").write_parquet(files[-1])
        scan = pl.scan_parquet(files) if files else pl.LazyFrame(schema=schema)
        scan.with_columns(pl.col("verified").cast(pl.Boolean)).sink_parquet(temporary)
        return int(connection.execute("SELECT count(*) FROM trial").fetchone()[0])


_PARQUET_TYPES = {"TEXT": pl.String, "INTEGER": pl.Int64, "REAL": pl.Float64}


def _batches(rows: sqlite3.Cursor) -> Iterator[list[Any]]:
    while batch := rows.fetchmany(BATCH):
        yield batch


def _settings(connection: sqlite3.Connection) -> dict[tuple[str, str], dict[str, Any]]:
    """The settings of each method by its name and their hash."""
    found = {}
    query = "SELECT method, settings_hash, settings FROM trial GROUP BY method, settings_hash"
    for method, hash_, settings in connection.execute(query):
        where = f"settings of {method!r}"
        found[method, hash_] = json_text.require_object(json_text.parse(settings, where), where)
    return found


def _method_labels(settings: Mapping[tuple[str, str], dict[str, Any]]) -> list[tuple[str, str, str]]:
    """Method, hash of its settings, and its name in the report."""
    variants: dict[str, list[dict[str, Any]]] = {}
    for (method, _), values in settings.items():
        variants.setdefault(method, []).append(values)
    return [
        (method, hash_, _label(method, hash_, values, variants[method])) for (method, hash_), values in settings.items()
    ]


def _label(method: str, hash_: str, settings: dict[str, Any], variants: Collection[dict[str, Any]]) -> str:
    if len(variants) == 1:
        return method
    different = [key for key in settings if len({json.dumps(other.get(key)) for other in variants}) > 1]
    values = ", ".join(f"{key}={settings[key]}" for key in different)
    return f"{method} [{values or hash_[:4]}]"
