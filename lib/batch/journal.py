# SPDX-License-Identifier: GPL-3.0-or-later
"""The journal of a batch: the result of each comparison.

It is kept through interruptions, and written by one batch at a time.
"""

from __future__ import annotations

import json
import os
import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import astuple, dataclass, fields
from pathlib import Path

from ..errors import EtalonError
from ..files.ownership import lock

FILE, LOCK = "journal.sqlite", "journal.lock"
# Grows when a table changes; a journal of a newer format is left alone.
FORMAT = 2
_BUSY = {sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED}
_DISK = {
    sqlite3.SQLITE_FULL,
    sqlite3.SQLITE_IOERR,
    sqlite3.SQLITE_READONLY,
    sqlite3.SQLITE_CANTOPEN,
    sqlite3.SQLITE_PERM,
}


@dataclass(frozen=True)
class Entry:
    """The result of one comparison.

    `key` stands for all that its result depends on, `assignments` are its values as JSON, `status` is 'finished', 'refused', 'failed' or
    'ended' (from outside), `message` the reason where it is not finished, `folder` its results' own below the batch's.
    """

    key: str
    scene: str
    assignments: str
    status: str
    exit_code: int
    seconds: float
    message: str
    folder: str


_COLUMNS = ", ".join(field.name for field in fields(Entry))
_TYPES = {"int": "integer", "float": "real", "str": "text"}
_TABLE = ", ".join(f"{field.name} {_TYPES[str(field.type)]}" for field in fields(Entry)).replace(
    "text", "text primary key", 1
)


class Journal:
    """An open journal; every method raises EtalonError where the file cannot serve."""

    def __init__(self, path: Path, connection: sqlite3.Connection) -> None:
        self._path, self._connection = path, connection
        with _explained(path):
            (number,) = connection.execute("pragma user_version").fetchone()
            if number > FORMAT:
                raise EtalonError(
                    f"{path}: is a journal of format {number}, and this Étalon knows {FORMAT}; update Étalon, or name another 'out'"
                )
            # Readers and the one writer do not wait for each other, and a crash leaves whole transactions.
            connection.execute("pragma journal_mode = wal")
            connection.execute("begin immediate")
            connection.execute(f"create table if not exists units ({_TABLE})")
            connection.execute(f"select {_COLUMNS} from units limit 0")
            connection.execute("create table if not exists files (digest text primary key, paths text)")
            connection.execute("create table if not exists digests (path text primary key, stamp text, digest text)")
            connection.execute(f"pragma user_version = {FORMAT}")
            connection.execute("commit")

    def read_all(self) -> dict[str, Entry]:
        """All entries by their keys."""
        with _explained(self._path):
            rows = self._connection.execute(f"select {_COLUMNS} from units").fetchall()
        return {row[0]: Entry(*row) for row in rows}

    def read_files(self, digest: str) -> list[str] | None:
        """The paths that the scene of that content refers to; None where they are not known."""
        row = self._one("select paths from files where digest = ?", digest)
        return None if row is None else json.loads(row[0])

    def write_files(self, digest: str, paths: Sequence[str]) -> None:
        """Keep the paths that a scene refers to."""
        with _explained(self._path):
            self._connection.execute("insert or replace into files values (?, ?)", (digest, json.dumps(list(paths))))

    def read_digest(self, path: str, stamp: str) -> str | None:
        """The hash of a file whose time and size are as they were; None otherwise."""
        row = self._one("select digest from digests where path = ? and stamp = ?", path, stamp)
        return None if row is None else row[0]

    def write_digest(self, path: str, stamp: str, digest: str) -> None:
        """Keep the hash of a file."""
        with _explained(self._path):
            self._connection.execute("insert or replace into digests values (?, ?, ?)", (path, stamp, digest))

    def _one(self, query: str, *values: str) -> tuple[str, ...] | None:
        with _explained(self._path):
            return self._connection.execute(query, values).fetchone()

    def write(self, entry: Entry) -> None:
        """Add an entry, in the place of the one of its key."""
        with _explained(self._path):
            marks = ", ".join("?" * len(fields(Entry)))
            self._connection.execute(f"insert or replace into units ({_COLUMNS}) values ({marks})", astuple(entry))


@contextmanager
def open_journal(folder: Path) -> Iterator[Journal]:
    """Open the journal in `folder`, made where it is missing, for this process alone.

    Raises EtalonError where another process has it.
    """
    path = folder / FILE
    with _locked(folder / LOCK), _explained(path), closing(sqlite3.connect(path, isolation_level=None)) as connection:
        yield Journal(path, connection)


@contextmanager
def _locked(path: Path) -> Iterator[None]:
    """Hold the file locked, and remove it at the end; a process that is killed lets it go."""
    try:
        descriptor = lock(path)
    except OSError as error:
        raise EtalonError(f"{path} cannot be locked ({error.strerror}); name another folder as 'out'") from error
    if descriptor is None:
        raise EtalonError(f"{path.parent}: another batch is running there; wait for it, or name another 'out'")
    try:
        yield
    finally:
        with suppress(OSError):  # Windows removes no open file
            path.unlink()
        os.close(descriptor)
        if os.name == "nt":
            with suppress(OSError):
                path.unlink()


@contextmanager
def _explained(path: Path) -> Iterator[None]:
    """Turn an error of the database into one line."""
    try:
        yield
    except sqlite3.DatabaseError as error:
        code = getattr(error, "sqlite_errorcode", 0) & 0xFF
        if code in _BUSY:
            raise EtalonError(f"{path}: is open in another program; close it there and run the batch again") from error
        if code in _DISK:
            raise EtalonError(f"{path}: cannot be written ({error}); make room or name another 'out'") from error
        raise EtalonError(f"{path}: is not a journal of this command ({error}); move it away") from error
