"""The scenes of a study with the best plan found for each, read one at a time."""

import contextlib
import json
import sqlite3
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import polars as pl

from converter.formats import scene_yaml
from converter.plan import Plan, plan_from_document
from converter.scene import Scene
from evaluate.packed import unpacked
from evaluate.scene_statistics import SceneStatistics, geometry_statistics_of, is_monotone
from evaluate.trial_frame import reading
from pcg import json_text
from pcg.errors import InputError
from pcg.files import read_text, write_text

CACHE = "scene_statistics.json"
"""File of a study's folder that keeps what takes longest: statistics by the hash of the scene."""

CACHE_VERSION = 1


@dataclass(frozen=True)
class SceneRecord:
    """A scene of a study.

    Attributes:
        name: As in the tables.
        scene: The scene.
        plan: The verified plan with the fewest pick-places, and of these the shortest; None without one.
        statistics: `pick_places` and `monotone` are those of `plan`.
    """

    name: str
    scene: Scene
    plan: Plan | None
    statistics: SceneStatistics


def scene_records(folder: Path, frame: pl.DataFrame) -> Iterator[SceneRecord]:
    """The scenes in the order of the trials `frame`, which was read from `folder`.

    Raises:
        InputError: the database is damaged.
    """
    cache = _Cache(folder / CACHE)
    named = frame.group_by("scene", maintain_order=True).agg(pl.col("scene_hash").first())
    ranked = frame.filter("solved").sort("pick_places", "path_length_m", "row")
    best = dict(ranked.group_by("scene").agg(pl.col("row").first()).iter_rows())
    try:
        with reading(folder) as connection:
            places = dict(connection.execute("SELECT scene_hash, rowid FROM scene").fetchall())
            for name, hash_ in named.iter_rows():
                if hash_ not in places:
                    continue
                scene = _scene(connection, places[hash_], f"{folder}: {name}")
                plan = _plan(connection, best.get(name), f"{folder}: {name}")
                statistics = cache.statistics(hash_, scene)
                if plan is not None:
                    statistics = replace(statistics, pick_places=plan.pick_places, monotone=is_monotone(plan))
                yield SceneRecord(name, scene, plan, statistics)
    finally:
        # What took long is kept, also when the report is interrupted.
        cache.save()


def _scene(connection: sqlite3.Connection, place: int, where: str) -> Scene:
    name, blob = connection.execute("SELECT name, document FROM scene WHERE rowid = ?", (place,)).fetchone()
    return scene_yaml.from_document(unpacked(blob, where), where, name)


def _plan(connection: sqlite3.Connection, place: int | None, where: str) -> Plan | None:
    found = connection.execute("SELECT plan FROM trial WHERE rowid = ?", (place,)).fetchone()
    if found is None or found[0] is None:
        return None
    return plan_from_document(unpacked(found[0], where), where)


class _Cache:
    """Statistics of the geometry of scenes that earlier reports computed."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._known = _read(path)
        self._changed = False

    def statistics(self, hash_: str, scene: Scene) -> SceneStatistics:
        """The statistics of a scene."""
        if hash_ not in self._known:
            self._known[hash_] = geometry_statistics_of(scene)
            self._changed = True
        return self._known[hash_]

    def save(self) -> None:
        """Writes the file if anything is new; who may not write there computes anew."""
        if self._changed:
            known = {hash_: asdict(statistics) for hash_, statistics in self._known.items()}
            with contextlib.suppress(InputError):
                write_text(self._path, json.dumps({"version": CACHE_VERSION, "scenes": known}, indent=1) + "\n")


def _read(path: Path) -> dict[str, SceneStatistics]:
    """What a cache holds; nothing if it is missing, damaged or of another version, for it can be made again."""
    try:
        document: Any = json_text.parse(read_text(path), str(path))
        if document["version"] != CACHE_VERSION:
            return {}
        return {hash_: SceneStatistics(**values) for hash_, values in document["scenes"].items()}
    except (InputError, ValueError, TypeError, KeyError):
        return {}
