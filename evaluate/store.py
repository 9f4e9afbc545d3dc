"""The trials of a study on disk: an SQLite database with one row per trial, failures included.

One process writes (a lock sees to that), any number may read meanwhile. A row is on disk before the next result is
taken, so whatever interrupts a study costs only the trials under way.
"""

import contextlib
import fcntl
import sqlite3
from collections.abc import Iterator
from dataclasses import astuple, dataclass, fields, replace
from pathlib import Path
from typing import IO, Self

from pcg.errors import InputError

FILE_NAME = "trials.sqlite"
VERSION = 1
"""`PRAGMA user_version` of the database."""


@dataclass(frozen=True)
class TrialRow:
    """One row; the fields are the columns.

    Attributes:
        key: `Trial.key`.
        scene: Name of the scene.
        scene_hash: `Scene.geometry_hash`.
        method: Name of the method.
        seed: Seed of the trial.
        settings: Every setting, JSON.
        settings_hash: `evaluate.trial.settings_hash`.
        status: A `converter.plan.Status`.
        verified: Whether the plan passed verification; None without a plan.
        time_s: Planning time; for a trial that was stopped, its wall time [s].
        path_length_m: Distance that the agent drives [m]; None without a plan.
        pick_places: How often an object is picked and placed; None without a plan.
        counters: Work done, JSON.
        message: The certificate of the planner, the first violation, or the reason of a failure.
        plan: The plan file's JSON, compressed by zlib; None without a plan.
        versions: Of manipuzzle and the libraries that it plans with, JSON.
        machine: Processor and system.
        started: ISO 8601, UTC.
        finished: ISO 8601, UTC.
    """

    key: str
    scene: str
    scene_hash: str
    method: str
    seed: int
    settings: str
    settings_hash: str
    status: str
    verified: bool | None
    time_s: float
    path_length_m: float | None
    pick_places: int | None
    counters: str
    message: str | None
    plan: bytes | None
    versions: str
    machine: str
    started: str
    finished: str


_TYPES = {
    "key": "TEXT PRIMARY KEY",
    "seed": "INTEGER NOT NULL",
    "verified": "INTEGER",
    "time_s": "REAL NOT NULL",
    "path_length_m": "REAL",
    "pick_places": "INTEGER",
    "message": "TEXT",
    "plan": "BLOB",
}
_COLUMNS = [column.name for column in fields(TrialRow)]
_CREATE = ", ".join(f"{name} {_TYPES.get(name, 'TEXT NOT NULL')}" for name in _COLUMNS)
_INSERT = f"INSERT INTO trial VALUES ({', '.join('?' * len(_COLUMNS))})"  # noqa: S608  # no outside text in it


class TrialStore:
    """A study's database, open for reading and writing by this process alone. A context manager."""

    def __init__(self, folder: Path) -> None:
        """Opens or creates the database in `folder`, which is made if missing.

        Raises:
            InputError: the folder cannot be written to, another process writes there, or the file is no such
                database.
        """
        self._path = folder / FILE_NAME
        self._lock = _locked(folder)
        try:
            with self._explained():
                self._connection = _opened(self._path)
        except BaseException:
            self._lock.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._connection.close()
        self._lock.close()

    def __contains__(self, key: str) -> bool:
        with self._explained():
            return self._connection.execute("SELECT 1 FROM trial WHERE key = ?", (key,)).fetchone() is not None

    def add(self, row: TrialRow) -> None:
        """Writes one row.

        Raises:
            InputError: the disk is full or the file cannot be written.
        """
        with self._explained(), self._connection:
            self._connection.execute(_INSERT, astuple(row))

    def rows(self) -> Iterator[TrialRow]:
        """All rows in the order of completion, one at a time.

        Raises:
            InputError: the file is damaged.
        """
        with self._explained():
            for values in self._connection.execute("SELECT * FROM trial ORDER BY rowid"):
                row = TrialRow(*values)
                # SQLite has no Booleans.
                yield row if row.verified is None else replace(row, verified=bool(row.verified))

    @contextlib.contextmanager
    def _explained(self) -> Iterator[None]:
        try:
            yield
        except sqlite3.Error as error:
            raise InputError(str(self._path), f"not usable as a study's database: {error}") from None


def _opened(path: Path) -> sqlite3.Connection:
    connection = sqlite3.connect(path)
    try:
        _require_version(connection, path)
        # With a write-ahead log others can read while this process writes, and a commit does not wait for the disk.
        connection.execute("PRAGMA journal_mode = WAL")
        connection.execute("PRAGMA synchronous = NORMAL")
        connection.execute(f"CREATE TABLE IF NOT EXISTS trial ({_CREATE}) STRICT")
        connection.execute(f"PRAGMA user_version = {VERSION}")
    except BaseException:
        connection.close()
        raise
    return connection


def _require_version(connection: sqlite3.Connection, path: Path) -> None:
    (version,) = connection.execute("PRAGMA user_version").fetchone()
    if version not in (0, VERSION):
        raise InputError(str(path), f"a database of version {version}, allowed is {VERSION}")


def _locked(folder: Path) -> IO[str]:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        file = (folder / ".lock").open("w")
    except OSError as error:
        raise InputError(str(folder), f"cannot be written: {error.strerror}") from None
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        file.close()
        raise InputError(str(folder), "another study is running in this folder") from None
    return file
