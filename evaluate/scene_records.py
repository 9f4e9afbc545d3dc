"""The scenes of a study with the best plan found for each, read one at a time."""

import contextlib
import json
import sqlite3
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import polars as pl

from converter.formats import scene_yaml
from converter.plan import Plan, plan_from_document
from converter.scene import Scene
from evaluate.packed import unpacked
from evaluate.scene_statistics import SceneStatistics, carries_once, geometry_statistics_of
from evaluate.trial_frame import reading
from pcg import json_text
from pcg.errors import InputError
from pcg.files import read_text, write_text

CACHE = "scene_statistics.json"
"""File of a study's folder that keeps what takes longest: statistics by the hash of the scene."""

CACHE_VERSION = 1


@dataclass(frozen=True, eq=False)
class SceneRecord:
    """A scene of a study. What takes milliseconds to read is read when it is asked for.

    Attributes:
        name: As in the tables.
        where: What messages call it.
        statistics: `pick_places` and `monotone` are those of `plan`.
        stored: Name and document of the scene.
        stored_plan: Document of the plan; None without one.
    """

    name: str
    where: str
    statistics: SceneStatistics
    stored: tuple[str, dict[str, Any]]
    stored_plan: dict[str, Any] | None

    @cached_property
    def scene(self) -> Scene:
        """The scene.

        Raises:
            InputError: the database is damaged.
        """
        if self.plan is not None and self.plan.scene_data is not None:
            return self.plan.scene_data
        return _scene(self.stored, self.where)

    @cached_property
    def plan(self) -> Plan | None:
        """The verified plan with the fewest pick-places, and of these the shortest; None without one.

        Raises:
            InputError: the database is damaged.
        """
        return None if self.stored_plan is None else plan_from_document(self.stored_plan, self.where)


def scene_records(folder: Path, frame: pl.DataFrame) -> Iterator[SceneRecord]:
    """The scenes in the order of the trials `frame`, which was read from `folder`.

    Raises:
        InputError: the database is damaged.
    """
    cache = _Cache(folder / CACHE)
    named = frame.group_by("scene", maintain_order=True).agg(pl.col("scene_hash").first())
    ranked = frame.filter("solved").sort("pick_places", "path_length_m", "row")
    best = {scene: (row, picks) for scene, row, picks in ranked.group_by("scene").agg(_BEST).iter_rows()}
    try:
        with reading(folder) as connection:
            places = dict(connection.execute("SELECT scene_hash, rowid FROM scene").fetchall())
            for name, hash_ in named.iter_rows():
                if hash_ not in places:
                    continue
                where = f"{folder}: {name}"
                stored = _stored_scene(connection, places[hash_], where)
                statistics = cache.statistics(hash_, partial(_scene, stored, where))
                place, pick_places = best.get(name, (None, None))
                plan = None if place is None else _stored_plan(connection, place, where)
                if plan is not None:
                    statistics = replace(statistics, pick_places=pick_places, monotone=_is_monotone(plan, where))
                yield SceneRecord(name, where, statistics, stored, plan)
    finally:
        # What took long is kept, also when the report is interrupted.
        cache.save()


_BEST = (pl.col("row").first(), pl.col("pick_places").first())


def _stored_scene(connection: sqlite3.Connection, place: int, where: str) -> tuple[str, dict[str, Any]]:
    name, blob = connection.execute("SELECT name, document FROM scene WHERE rowid = ?", (place,)).fetchone()
    return name, unpacked(blob, where)


def _stored_plan(connection: sqlite3.Connection, place: int, where: str) -> dict[str, Any] | None:
    (blob,) = connection.execute("SELECT plan FROM trial WHERE rowid = ?", (place,)).fetchone()
    return None if blob is None else unpacked(blob, where)


def _scene(stored: tuple[str, dict[str, Any]], where: str) -> Scene:
    name, document = stored
    return scene_yaml.from_document(document, where, name)


def _is_monotone(plan: dict[str, Any], where: str) -> bool:
    """`is_monotone` of a plan that only its document is known of.

    Raises:
        InputError: it is no plan's document.
    """
    try:
        return carries_once([segment["object"] for segment in plan["segments"]])
    except (KeyError, TypeError):
        raise InputError(where, "what is stored is no plan") from None


class _Cache:
    """Statistics of the geometry of scenes that earlier reports computed."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._known = _read(path)
        self._changed = False

    def statistics(self, hash_: str, scene: Callable[[], Scene]) -> SceneStatistics:
        """The statistics of a scene, which is made if they are not known."""
        if hash_ not in self._known:
            self._known[hash_] = geometry_statistics_of(scene())
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
