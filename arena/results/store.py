"""The results file: SQLite, one transaction a finished run, written by one process.

Tables (also in ``docs/results.md``): ``tournament`` (key, value), ``runs`` (one row a run) and
``arrays`` (its arrays as the bytes of an ``.npz`` file). Nothing in a results file is ever executed.
"""

import json
import sqlite3
import urllib.parse
import weakref
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from pathlib import Path
from types import MappingProxyType
from typing import Any

from filelock import FileLock

from arena.common.locks import LockedError, lock_file, unlock
from arena.common.npz import Arrays, unpack
from arena.results.continuation import as_read, continued, difference
from arena.results.equivalence import are_equivalent
from arena.results.provenance import versions
from arena.results.schema import COLUMNS, is_valid_config, row_problem
from arena.tournament.outcome import Outcome
from envs.foundation.errors import InvalidValueError

APPLICATION_ID = 0x4D434152  # "MCAR"
SCHEMA_VERSION = 1

_SCHEMA = f"""
CREATE TABLE tournament (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE runs (
    entrant TEXT NOT NULL, replicate INTEGER NOT NULL, driver TEXT NOT NULL, status TEXT NOT NULL,
    accuracy REAL, mean_length REAL, iterations INTEGER NOT NULL, seconds REAL NOT NULL,
    error TEXT NOT NULL, PRIMARY KEY (entrant, replicate));
CREATE TABLE arrays (
    entrant TEXT NOT NULL, replicate INTEGER NOT NULL, npz BLOB NOT NULL,
    PRIMARY KEY (entrant, replicate));
PRAGMA application_id = {APPLICATION_ID};
PRAGMA user_version = {SCHEMA_VERSION};
"""


class ResultsError(InvalidValueError):
    """A results file cannot be used; the message is one sentence that names it."""


class Store:
    """An open results file, or a temporary one without a name.

    Use ``Store.create``, ``Store.resume`` or ``Store.read``. Whoever opens it closes it; one that is dropped
    is closed by the thread that collects it.

    Attributes:
        path: of the file; None for a temporary one.
        config: the tournament, as ``Tournament.to_dict`` describes it.
        versions: of Python and the packages when the file was made.
        sources: digests of the agents' code, see ``source_digests``.
    """

    config: dict[str, Any]
    versions: dict[str, str]
    sources: dict[str, str]

    def __init__(self, connection: sqlite3.Connection, path: Path | None) -> None:
        self.path = path
        self._connection = connection
        self._lock: FileLock | None = None
        self._closing = weakref.finalize(self, connection.close)
        try:
            self._load()
        except BaseException:
            self._closing()
            raise

    @classmethod
    def create(
        cls, path: Path | None, config: dict[str, Any], sources: Mapping[str, str] = MappingProxyType({})
    ) -> "Store":
        """A new file at ``path`` for the tournament ``config``; a temporary one for None.

        Raises:
            ResultsError: when the file cannot be made.
        """
        metadata = {"config": config, "versions": versions(), "sources": dict(sources)}
        rows = [(key, json.dumps(value)) for key, value in metadata.items()]
        if path is None:
            connection = _connect(":memory:")
            _fill(connection, rows)
            return cls(connection, None)
        lock = None
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            lock = lock_file(path)
            # Under another name until it is whole: a process may be killed at any moment.
            draft = path.with_name(f"{path.name}.new")
            draft.unlink(missing_ok=True)
            with closing(sqlite3.connect(draft)) as connection:
                _fill(connection, rows)
            draft.replace(path)
        except (OSError, ValueError, sqlite3.Error) as error:  # a path with a null character is a ValueError
            unlock(lock)
            raise _unwritable(path, error) from error
        store = cls._open(path, "rw")
        store._lock = lock  # noqa: SLF001 (its own)
        return store

    @classmethod
    def resume(
        cls, path: Path, config: dict[str, Any], sources: Mapping[str, str] = MappingProxyType({})
    ) -> "Store":
        """The file of an earlier start of the same tournament.

        Raises:
            ResultsError: when it is no results file, or that of another tournament or of agents whose
                code has changed since.
        """
        store = cls._open(path, "rw")
        try:
            store._lock = lock_file(path)  # noqa: SLF001 (its own)
            store._continue(as_read(config), sources)  # noqa: SLF001 (its own)
        except (LockedError, OSError) as error:
            store.close()
            raise _unwritable(path, error) from error
        except BaseException:
            store.close()
            raise
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
            return cls(_connect(uri), path)
        except sqlite3.Error as error:
            raise ResultsError(f"{path} is not a results file of the arena: {first_line(error)}") from error

    def _continue(self, config: dict[str, Any], sources: Mapping[str, str]) -> None:
        """See that this is the same tournament, and keep what was not known of agents until now."""
        differs = difference(self.config, config)
        if differs:
            raise ResultsError(
                f"{self.path} holds another tournament ({differs}); name another file or remove this one"
            )
        for agent, digest in self.sources.items():
            if not are_equivalent(agent, digest, sources.get(agent, digest)):
                raise ResultsError(
                    f"{self.path} holds runs of other code of {agent!r}; name another file or remove this one"
                )
        metadata = {"config": continued(self.config, config), "sources": {**self.sources, **sources}}
        if metadata != {"config": self.config, "sources": self.sources}:
            rows = [(json.dumps(value), key) for key, value in metadata.items()]
            with self._transaction():
                self._connection.executemany("UPDATE tournament SET value = ? WHERE key = ?", rows)
            self.config, self.sources = metadata["config"], metadata["sources"]

    def add(self, outcome: Outcome) -> None:
        """Keep a run, for good when this returns.

        Raises:
            ResultsError: when the disk is full or gone.
        """
        row = (
            *outcome.key,
            outcome.driver,
            outcome.status,
            outcome.accuracy,
            outcome.mean_length,
            outcome.iterations,
            outcome.seconds,
            outcome.error,
        )
        with self._transaction():
            self._connection.execute("INSERT OR REPLACE INTO runs VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)", row)
            self._connection.execute(
                "INSERT OR REPLACE INTO arrays VALUES (?, ?, ?)", (*outcome.key, outcome.arrays)
            )

    def finished(self) -> set[tuple[str, int]]:
        """Entrant and replicate of the runs that need not be repeated."""
        return {(row["entrant"], row["replicate"]) for row in self.rows() if row["status"] == "finished"}

    def rows(self) -> list[dict[str, Any]]:
        """The runs in the order of the entrants in the tournament, and of their replicates.

        Raises:
            ResultsError: when the file is damaged.
        """
        order = {entrant["name"]: place for place, entrant in enumerate(self.config["entrants"])}
        with self._reading():
            cursor = self._connection.execute(f"SELECT {', '.join(COLUMNS)} FROM runs")  # noqa: S608
            rows = [dict(zip(COLUMNS, row, strict=True)) for row in cursor]
            orphans = (
                "SELECT count(*) FROM runs LEFT JOIN arrays USING (entrant, replicate) WHERE npz IS NULL"
            )
            (orphaned,) = self._connection.execute(orphans).fetchone()
        problem = next(filter(None, (row_problem(row, order) for row in rows)), "")
        if problem or orphaned:
            raise self._damaged(problem or "a run lacks its arrays")
        return sorted(rows, key=lambda row: (order[row["entrant"]], row["replicate"]))

    def arrays(self, entrant: str, replicate: int) -> Arrays:
        """The arrays of a run by name.

        Raises:
            KeyError: when there is no such run.
            ResultsError: when the file is damaged.
        """
        query = "SELECT npz FROM arrays WHERE entrant = ? AND replicate = ?"
        with self._reading():
            row = self._connection.execute(query, (entrant, replicate)).fetchone()
        if row is None:
            raise KeyError(f"no run {replicate} of {entrant!r}")
        try:
            return unpack(row[0]) if row[0] else {}
        except Exception as error:  # of any kind: zip, zlib and numpy each have their own
            raise self._damaged(f"its arrays cannot be read ({first_line(error)})") from error

    def close(self) -> None:
        """Close the file; a temporary one is gone."""
        self._closing()
        self.release()

    def __del__(self) -> None:
        self.close()

    def release(self) -> None:
        """Let others write the file: nothing more will be added."""
        unlock(self._lock)
        self._lock = None

    def _load(self) -> None:
        """Read and check all but the runs; errors of SQLite mean that it is no such file."""
        (application,) = self._connection.execute("PRAGMA application_id").fetchone()
        (version,) = self._connection.execute("PRAGMA user_version").fetchone()
        if application != APPLICATION_ID:
            raise ResultsError(f"{self.path} is not a results file of the arena")
        if version > SCHEMA_VERSION:
            raise ResultsError(
                f"{self.path} was written by a newer arena (schema {version}, known is {SCHEMA_VERSION})"
            )
        self.config, self.versions, self.sources = map(self._value, ("config", "versions", "sources"))
        known = isinstance(self.versions, dict) and isinstance(self.sources, dict)
        if not known or not is_valid_config(self.config):
            raise self._damaged("its tournament is incomplete")

    def _value(self, key: str) -> Any:
        query = "SELECT value FROM tournament WHERE key = ?"
        with self._reading():
            row = self._connection.execute(query, (key,)).fetchone()
        try:
            return json.loads(row[0]) if row and isinstance(row[0], str) else None
        except (ValueError, RecursionError) as error:  # of an integer with too many digits, too
            raise self._damaged(first_line(error)) from error

    def _damaged(self, reason: str) -> ResultsError:
        return ResultsError(f"{self.path} is damaged: {reason}")

    @contextmanager
    def _reading(self) -> Iterator[None]:
        """Tell what SQLite says of a damaged file in one sentence."""
        try:
            yield
        except (sqlite3.Error, UnicodeDecodeError, MemoryError) as error:  # SQLite quotes the file
            raise self._damaged(first_line(error)) from error

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        try:
            with self._connection:
                self._connection.execute("BEGIN IMMEDIATE")
                yield
        except sqlite3.Error as error:
            raise _unwritable(self.path, error) from error


def first_line(error: BaseException) -> str:
    """Of the message; the name of the error's class if it has none."""
    return str(error).splitlines()[0] if str(error) else type(error).__name__


def _unwritable(path: Path | None, error: BaseException) -> ResultsError:
    return ResultsError(f"cannot write the results file {path}: {first_line(error)}")


def _connect(uri: str) -> sqlite3.Connection:
    # Results that are dropped are closed by whichever thread collects them.
    return sqlite3.connect(uri, uri=True, isolation_level=None, check_same_thread=False)


def _fill(connection: sqlite3.Connection, rows: list[tuple[str, str]]) -> None:
    connection.executescript(_SCHEMA)
    with connection:
        connection.executemany("INSERT INTO tournament VALUES (?, ?)", rows)
