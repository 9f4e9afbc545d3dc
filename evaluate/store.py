"""The trials of a study on disk: an SQLite database with one row per trial, failures included.

One process writes (a lock sees to that), any number may read meanwhile. A row is written before the next result is
taken, so whatever ends a study costs only the trials under way. A machine that loses its power may lose the rows of the
last seconds too: to wait for the disk after each would take several milliseconds, as long as many trials. Beside the
trials are the scenes that they were run on, and what the study that last ran in the folder consists of: a folder needs
no other file to be reported on.
"""

import contextlib
import fcntl
import math
import os
import sqlite3
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, astuple, fields, replace
from pathlib import Path
from typing import IO, Annotated, Any, Self

from pydantic import Field

from converter.formats import scene_yaml
from converter.formats.body_document import Name
from converter.scene import Scene
from evaluate.packed import packed, unpacked
from evaluate.study_record import StudyRecord
from evaluate.trial_row import TrialRow
from pcg.errors import InputError
from pcg.validation import Document, validated

FILE_NAME = "trials.sqlite"
LOCK_NAME = ".lock"
_LOG = f"{FILE_NAME}-wal"
_BESIDE = (_LOG, f"{FILE_NAME}-shm", f"{FILE_NAME}-journal")
"""Files that SQLite writes, the second even where it only reads."""
VERSION = 2
"""`PRAGMA user_version` of the database."""

MAX_INTEGER = 2**63 - 1
"""Of SQLite."""

_TYPES = {
    "key": "TEXT PRIMARY KEY",
    "seed": "INTEGER NOT NULL",
    "verified": "INTEGER",
    "time_s": "REAL NOT NULL",
    "path_length_m": "REAL",
    "pick_places": "INTEGER",
    "message": "TEXT",
    "plan": "BLOB",
    "preset": "TEXT",
}
_UNWRITABLE = "cannot be written, the finished trials in it are kept"
_COLUMNS = [column.name for column in fields(TrialRow)]
_TABLES = {
    "trial": ", ".join(f"{name} {_TYPES.get(name, 'TEXT NOT NULL')}" for name in _COLUMNS),
    "scene": "name TEXT NOT NULL, scene_hash TEXT NOT NULL, document BLOB NOT NULL, UNIQUE (name, scene_hash)",
    "study": "id INTEGER PRIMARY KEY, document BLOB NOT NULL",
}
"""Columns of the tables. A document is JSON, compressed by zlib; `study` has one row."""

_SCHEMA = {("table", name, f"CREATE TABLE {name} ({columns}) STRICT") for name, columns in _TABLES.items()}
"""What SQLite says that a database consists of. A view or a trigger of somebody else could do anything."""

_INSERT = f"INSERT INTO trial VALUES ({', '.join('?' * len(_COLUMNS))})"  # noqa: S608  # no outside text in it


class _StudyDocument(Document):
    name: Name
    scenes: tuple[tuple[str, str], ...]
    methods: tuple[tuple[str, str], ...]
    seeds: tuple[Annotated[int, Field(ge=0, le=MAX_INTEGER)], ...]
    trials: int


class StoredTrials:
    """A study's database, open for reading, also while a study writes to it. A context manager."""

    def __init__(self, folder: Path) -> None:
        """Opens the database in `folder`.

        Raises:
            InputError: there is none, or the file is no such database.
        """
        self._path = folder / FILE_NAME
        if not self._path.is_file():
            raise InputError(str(folder), f"no study: there is no file {FILE_NAME}")
        _require_plain_files(folder, _BESIDE)
        with self._explained():
            self._connection = read_only(self._path)
            try:
                _require_version(self._connection, self._path)
                _require_tables(self._connection, self._path)
            except BaseException:
                self._connection.close()
                raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._connection.close()

    def __contains__(self, key: str) -> bool:
        with self._explained():
            return self._connection.execute("SELECT 1 FROM trial WHERE key = ?", (key,)).fetchone() is not None

    def __len__(self) -> int:
        with self._explained():
            return int(self._connection.execute("SELECT count(*) FROM trial").fetchone()[0])

    def rows(self, *, plans: bool = True) -> Iterator[TrialRow]:
        """All rows in the order of completion, one at a time.

        Args:
            plans: False leaves the plans out, for speed; `plan` is then None in every row.

        Raises:
            InputError: the file is damaged.
        """
        columns = ", ".join(name if plans or name != "plan" else "NULL" for name in _COLUMNS)
        yield from self._selected(f"SELECT {columns} FROM trial ORDER BY rowid")  # noqa: S608  # our own column names

    def get(self, key: str) -> TrialRow:
        """The row of a trial.

        Raises:
            KeyError: there is none.
        """
        for row in self._selected(f"SELECT {', '.join(_COLUMNS)} FROM trial WHERE key = ?", key):  # noqa: S608  # our own text
            return row
        raise KeyError(key)

    def find(self, key: str) -> list[TrialRow]:
        """The rows whose key begins with `key`."""
        condition = "substr(key, 1, ?) = ?"
        return list(self._selected(f"SELECT {', '.join(_COLUMNS)} FROM trial WHERE {condition}", len(key), key))  # noqa: S608  # our own text

    def scenes(self) -> Iterator[Scene]:
        """The scenes that trials of this folder were run on, one at a time, in the order of the studies.

        Raises:
            InputError: the file is damaged.
        """
        with self._explained():
            for name, document in self._connection.execute("SELECT name, document FROM scene ORDER BY rowid"):
                where = f"{self._path}: {name}"
                yield scene_yaml.from_document(unpacked(document, where), where, name)

    def study(self) -> StudyRecord | None:
        """The study that last ran in the folder; None if none did.

        Raises:
            InputError: the file is damaged.
        """
        with self._explained():
            found = self._connection.execute("SELECT document FROM study").fetchone()
        if found is None:
            return None
        where = f"{self._path}: study"
        return StudyRecord(**dict(validated(_StudyDocument, unpacked(found[0], where), where)))

    def _selected(self, statement: str, *parameters: Any) -> Iterator[TrialRow]:
        with self._explained():
            for values in self._connection.execute(statement, parameters):
                row = TrialRow(*values)
                if not (math.isfinite(row.time_s) and math.isfinite(row.path_length_m or 0.0)):
                    raise InputError(f"{self._path}: trial {row.key}", "time and path length have to be finite")
                # SQLite has no Booleans.
                yield row if row.verified is None else replace(row, verified=bool(row.verified))

    @contextlib.contextmanager
    def _explained(self, problem: str = "not usable as a study's database") -> Iterator[None]:
        try:
            yield
        except sqlite3.Error as error:
            raise InputError(str(self._path), f"{problem}: {error}") from None


class TrialStore(StoredTrials):
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

    def __exit__(self, *_: object) -> None:
        super().__exit__()
        self._lock.close()

    def add(self, row: TrialRow) -> None:
        """Writes one row.

        Raises:
            InputError: the disk is full or the file cannot be written.
        """
        with self._explained(_UNWRITABLE), self._connection:
            self._connection.execute(_INSERT, astuple(row))

    def add_scenes(self, scenes: Iterable[Scene]) -> None:
        """Writes the scenes that the folder lacks.

        Raises:
            InputError: the disk is full or the file cannot be written.
        """
        with self._explained(_UNWRITABLE), self._connection:
            self._connection.executemany("INSERT OR IGNORE INTO scene VALUES (?, ?, ?)", map(_scene_row, scenes))

    def set_study(self, study: StudyRecord) -> None:
        """Says which study the folder is about from now on.

        Raises:
            InputError: the disk is full or the file cannot be written.
        """
        document = packed(asdict(study))
        with self._explained(_UNWRITABLE), self._connection:
            self._connection.execute("INSERT OR REPLACE INTO study VALUES (1, ?)", (document,))


def read_only(path: Path) -> sqlite3.Connection:
    """A connection that reads a database; others may write to it meanwhile.

    SQLite keeps a database with a write-ahead log from those who may not write beside it, as they could not share the
    log. Where there is no log nobody is writing, and the file can be read as one that does not change.
    """
    is_at_rest = not os.access(path.parent, os.W_OK) and not path.with_name(_LOG).exists()
    uri = f"{path.resolve().as_uri()}?mode=ro{'&immutable=1' if is_at_rest else ''}"
    return sqlite3.connect(uri, uri=True)


def _scene_row(scene: Scene) -> tuple[str, str, bytes]:
    document = packed(scene_yaml.to_document(scene))
    return scene.name, scene.geometry_hash, document


def _opened(path: Path) -> sqlite3.Connection:
    connection = sqlite3.connect(path)
    try:
        _require_version(connection, path)
        _require_tables(connection, path, may_lack_some=True)
        # With a write-ahead log others can read while this process writes, and few commits wait for the disk.
        connection.execute("PRAGMA journal_mode = WAL")
        connection.execute("PRAGMA synchronous = NORMAL")
        for table, columns in _TABLES.items():
            connection.execute(f"CREATE TABLE IF NOT EXISTS {table} ({columns}) STRICT")
        connection.execute(f"PRAGMA user_version = {VERSION}")
    except BaseException:
        connection.close()
        raise
    return connection


def _require_tables(connection: sqlite3.Connection, path: Path, *, may_lack_some: bool = False) -> None:
    found = set(connection.execute("SELECT type, name, sql FROM sqlite_master WHERE sql IS NOT NULL"))
    if not (found <= _SCHEMA if may_lack_some else found == _SCHEMA):
        raise InputError(str(path), "not a study's database: it has other tables")


def _require_version(connection: sqlite3.Connection, path: Path) -> None:
    (version,) = connection.execute("PRAGMA user_version").fetchone()
    if version not in (0, VERSION):
        raise InputError(str(path), f"a database of version {version}, allowed is {VERSION}")


def _require_plain_files(folder: Path, names: Sequence[str]) -> None:
    """Refuses links and pipes in place of our files.

    Whoever made the folder could point links at files of its reader, and opening a pipe waits for ever.
    """
    for path in (folder / name for name in names):
        if path.is_symlink():
            raise InputError(str(path), "a symbolic link, which is not followed for writing")
        if path.is_fifo():
            raise InputError(str(path), "a named pipe, which is not written to")


def _locked(folder: Path) -> IO[str]:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        _require_plain_files(folder, (LOCK_NAME, FILE_NAME, *_BESIDE))
        file = (folder / LOCK_NAME).open("w")
    except OSError as error:
        raise InputError(str(folder), f"cannot be written: {error.strerror}") from None
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        file.close()
        raise InputError(str(folder), "another study is running in this folder") from None
    return file
