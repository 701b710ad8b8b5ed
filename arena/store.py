"""The results file: SQLite, one transaction a finished run, written by one process.

Tables (also in ``docs/results.md``): ``tournament`` (key, value), ``runs`` (one row a run) and
``arrays`` (its arrays as the bytes of an ``.npz`` file). Nothing in a results file is ever executed.
"""

import json
import platform
import sqlite3
import urllib.parse
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from arena.outcome import Arrays, Outcome, unpack

APPLICATION_ID = 0x4D434152  # "MCAR"
SCHEMA_VERSION = 1

_SCHEMA = """
CREATE TABLE tournament (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE runs (
    entrant TEXT NOT NULL, replicate INTEGER NOT NULL, driver TEXT NOT NULL, status TEXT NOT NULL,
    accuracy REAL, mean_length REAL, iterations INTEGER NOT NULL, seconds REAL NOT NULL,
    error TEXT NOT NULL, PRIMARY KEY (entrant, replicate));
CREATE TABLE arrays (
    entrant TEXT NOT NULL, replicate INTEGER NOT NULL, npz BLOB NOT NULL,
    PRIMARY KEY (entrant, replicate));
"""


# Changing these changes no result, so a tournament may be continued with others.
FREE = {"time_limit", "memory_limit"}


class ResultsError(ValueError):
    """A results file cannot be used; the message is one sentence that names it."""


class Store:
    """An open results file, or a temporary one without a name.

    Use ``Store.create``, ``Store.resume`` or ``Store.read``.
    """

    def __init__(
        self, connection: sqlite3.Connection, path: Path | None, lock: FileLock | None = None
    ) -> None:
        self.path = path
        self._connection = connection
        self._lock = lock

    @classmethod
    def create(cls, path: Path | None, config: dict[str, Any]) -> "Store":
        """A new file at ``path`` for the tournament ``config``; a temporary one for None.

        Raises:
            ResultsError: when the file cannot be made.
        """
        lock = None
        try:
            if path is not None:
                path.parent.mkdir(parents=True, exist_ok=True)
                lock = _locked(path)
            connection = sqlite3.connect(path or "", isolation_level=None)
            connection.execute("BEGIN")
            for statement in _SCHEMA.split(";"):
                connection.execute(statement)
            made = {"config": config, "versions": versions()}
            rows = [(key, json.dumps(value)) for key, value in made.items()]
            connection.executemany("INSERT INTO tournament VALUES (?, ?)", rows)
            connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
            connection.execute(f"PRAGMA user_version = {SCHEMA_VERSION}")
            connection.execute("COMMIT")
        except (OSError, sqlite3.Error) as error:
            _unlock(lock)
            raise ResultsError(f"cannot write the results file {path}: {_words(error)}") from error
        return cls(connection, path, lock)

    @classmethod
    def resume(cls, path: Path, config: dict[str, Any]) -> "Store":
        """The file of an earlier start of the same tournament.

        Raises:
            ResultsError: when it is no results file, or that of another tournament.
        """
        store = cls._open(path, "rw")
        try:
            store._lock = _locked(path)  # noqa: SLF001 (its own)
        except ResultsError:
            store.close()
            raise
        difference = _difference(store.config, config)
        if difference:
            store.close()
            raise ResultsError(
                f"{path} holds another tournament ({difference}); name another file or remove this one"
            )
        return store

    @classmethod
    def read(cls, path: Path) -> "Store":
        """An existing file, only to be read.

        Raises:
            ResultsError: when it is missing or no results file.
        """
        return cls._open(path, "ro")

    @classmethod
    def _open(cls, path: Path, mode: str) -> "Store":
        if not path.is_file():
            raise ResultsError(f"there is no results file {path}")
        uri = f"file:{urllib.parse.quote(str(path.absolute()))}?mode={mode}"
        try:
            connection = sqlite3.connect(uri, uri=True, isolation_level=None)
            (application,) = connection.execute("PRAGMA application_id").fetchone()
            (version,) = connection.execute("PRAGMA user_version").fetchone()
            if application != APPLICATION_ID:
                raise ResultsError(f"{path} is not a results file of the arena")
            if version > SCHEMA_VERSION:
                raise ResultsError(
                    f"{path} was written by a newer arena (schema {version}, this one knows {SCHEMA_VERSION})"
                )
            store = cls(connection, path)
            if not isinstance(store.config, dict):
                raise ResultsError(f"{path} is damaged: its tournament is no table")
        except (sqlite3.Error, ValueError, TypeError) as error:
            if isinstance(error, ResultsError):
                raise
            raise ResultsError(f"{path} is not a results file of the arena: {_words(error)}") from error
        return store

    @property
    def config(self) -> dict[str, Any]:
        """The tournament, as ``Tournament.to_dict`` told it."""
        found: dict[str, Any] = self._told("config")
        return found

    @property
    def versions(self) -> dict[str, str]:
        """Of Python and the packages when the file was made."""
        found: dict[str, str] = self._told("versions")
        return found

    def add(self, outcome: Outcome) -> None:
        """Keep a run, for good when this returns.

        Raises:
            ResultsError: when the disk is full or gone.
        """
        key = (outcome.entrant, outcome.replicate)
        scores = (outcome.driver, outcome.status, outcome.accuracy, outcome.mean_length)
        costs = (outcome.iterations, outcome.seconds, outcome.error)
        try:
            with self._connection:
                self._connection.execute("BEGIN IMMEDIATE")
                self._connection.execute(
                    "INSERT OR REPLACE INTO runs VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)", key + scores + costs
                )
                self._connection.execute(
                    "INSERT OR REPLACE INTO arrays VALUES (?, ?, ?)", (*key, outcome.arrays)
                )
        except sqlite3.Error as error:
            raise ResultsError(f"cannot write the results file {self.path}: {_words(error)}") from error

    def finished(self) -> set[tuple[str, int]]:
        """Entrant and replicate of the runs that need not be repeated."""
        query = "SELECT entrant, replicate FROM runs WHERE status = 'finished'"
        return set(self._connection.execute(query))

    def rows(self) -> Iterator[dict[str, Any]]:
        """The runs in the order of their replicates and names; columns by name."""
        cursor = self._connection.execute("SELECT * FROM runs ORDER BY replicate, entrant")
        names = [column[0] for column in cursor.description]
        for row in cursor:
            yield dict(zip(names, row, strict=True))

    def arrays(self, entrant: str, replicate: int) -> Arrays:
        """The arrays of a run by name.

        Raises:
            KeyError: when there is no such run.
        """
        found = self._connection.execute(
            "SELECT npz FROM arrays WHERE entrant = ? AND replicate = ?", (entrant, replicate)
        ).fetchone()
        if found is None:
            raise KeyError(f"no run {replicate} of {entrant!r}")
        return unpack(found[0]) if found[0] else {}

    def close(self) -> None:
        """Close the file; a temporary one is gone."""
        self._connection.close()
        self.release()

    def release(self) -> None:
        """Let others write the file: nothing more will be added."""
        _unlock(self._lock)
        self._lock = None

    def _told(self, key: str) -> Any:
        query = "SELECT value FROM tournament WHERE key = ?"
        return json.loads(self._connection.execute(query, (key,)).fetchone()[0])


def _locked(path: Path) -> FileLock:
    """The right to write ``path``, which a process loses when it ends, however it ends.

    Raises:
        ResultsError: when another process has it, or there can be no lock beside the file.
    """
    lock = FileLock(f"{path}.lock", timeout=0)
    try:
        lock.acquire()
    except Timeout:
        raise ResultsError(f"another process is writing {path}; wait for it, or name another file") from None
    except OSError as error:
        raise ResultsError(f"cannot write the results file {path}: {_words(error)}") from error
    return lock


def _unlock(lock: FileLock | None) -> None:
    if lock is not None:
        Path(lock.lock_file).unlink(missing_ok=True)
        lock.release()


def versions() -> dict[str, str]:
    """Versions of what computes the results."""
    packages = ["mountain-car-arena", "numpy", "numba", "pettingzoo", "gymnasium", "joblib"]
    found = {"python": platform.python_version(), "platform": platform.platform()}
    for package in packages:
        try:
            found[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            found[package] = "not installed"
    return found


def _difference(theirs: dict[str, Any], ours: dict[str, Any]) -> str:
    """The first thing in which two tournaments differ, in words; empty if they are the same."""
    ours = json.loads(json.dumps(ours))
    for key in {**ours, **theirs}:
        if key not in FREE and theirs.get(key) != ours.get(key):
            if isinstance(ours.get(key), (str, int)):
                return f"its {key} is {theirs.get(key)!r}, not {ours[key]!r}"
            return f"its {key} differ"
    return ""


def _words(error: BaseException) -> str:
    return str(error).splitlines()[0] if str(error) else type(error).__name__
