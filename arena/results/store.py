"""The results file: SQLite, one transaction a finished run, written by one process.

Tables (also in ``docs/results.md``): ``tournament`` (key, value), ``runs`` (one row a run) and
``arrays`` (its arrays as the bytes of an ``.npz`` file). Nothing in a results file is ever executed.
"""

import json
import sqlite3
import urllib.parse
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager, nullcontext
from pathlib import Path
from types import MappingProxyType
from typing import Any

from filelock import FileLock

from arena.common.locks import LockedError, lock_file, unlock
from arena.common.npz import Arrays, unpack
from arena.results.continuation import as_read, continued, difference
from arena.results.provenance import versions
from arena.results.schema import _COLUMNS, _MOST, _sound
from arena.tournament.outcome import Outcome

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
    def create(
        cls, path: Path | None, config: dict[str, Any], sources: Mapping[str, str] = MappingProxyType({})
    ) -> "Store":
        """A new file at ``path`` for the tournament ``config``; a temporary one for None.

        ``sources`` are the digests of the agents' code, see ``source_digests``.

        Raises:
            ResultsError: when the file cannot be made.
        """
        told = {"config": config, "versions": versions(), "sources": dict(sources)}
        rows = [(key, json.dumps(value)) for key, value in told.items()]
        lock = None
        try:
            if path is not None:
                path.parent.mkdir(parents=True, exist_ok=True)
                lock = lock_file(path)
                path.with_name(f"{path.name}.new").unlink(missing_ok=True)
            # Under another name until it is whole: a process may be killed at any moment.
            new = path.with_name(f"{path.name}.new") if path else ""
            opened = sqlite3.connect(new, check_same_thread=False)  # see ``_open``
            with closing(opened) if path else nullcontext(opened) as connection:
                connection.executescript(_SCHEMA)
                connection.executemany("INSERT INTO tournament VALUES (?, ?)", rows)
                connection.commit()
            if path is not None:
                Path(new).replace(path)
        except (OSError, sqlite3.Error, LockedError) as error:
            unlock(lock)
            raise ResultsError(f"cannot write the results file {path}: {_words(error)}") from error
        if path is None:
            return cls(connection, None)
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
        except (LockedError, OSError) as error:
            store.close()
            raise ResultsError(f"cannot write the results file {path}: {_words(error)}") from error
        try:
            store._continue(as_read(config), sources)  # noqa: SLF001 (its own)
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
        store = None
        try:
            # Results that are dropped are closed by whichever thread collects them.
            connection = sqlite3.connect(uri, uri=True, isolation_level=None, check_same_thread=False)
            store = cls(connection, path)
            store._check()
        except (sqlite3.Error, ResultsError) as error:
            if store:
                store.close()
            if isinstance(error, ResultsError):
                raise
            raise ResultsError(f"{path} is not a results file of the arena: {_words(error)}") from error
        return store

    def _continue(self, config: dict[str, Any], sources: Mapping[str, str]) -> None:
        """See that this is the same tournament, and keep what was not known of agents until now."""
        before, code = self.config, self._told("sources")
        differs = difference(before, config)
        if differs:
            raise ResultsError(
                f"{self.path} holds another tournament ({differs}); name another file or remove this one"
            )
        for agent, digest in code.items():
            if sources.get(agent, digest) != digest:
                raise ResultsError(
                    f"{self.path} holds runs of other code of {agent!r}; name another file or remove this one"
                )
        told = {"config": continued(before, config), "sources": {**code, **sources}}
        if told != {"config": before, "sources": code}:
            rows = [(json.dumps(value), key) for key, value in told.items()]
            with self._writing():
                self._connection.executemany("UPDATE tournament SET value = ? WHERE key = ?", rows)

    def _check(self) -> None:
        (application,) = self._connection.execute("PRAGMA application_id").fetchone()
        (version,) = self._connection.execute("PRAGMA user_version").fetchone()
        if application != APPLICATION_ID:
            raise ResultsError(f"{self.path} is not a results file of the arena")
        if version > SCHEMA_VERSION:
            raise ResultsError(
                f"{self.path} was written by a newer arena (schema {version}, known is {SCHEMA_VERSION})"
            )
        with self._reading():
            told = self.versions, self._told("sources")
            if not _sound(self.config) or not all(isinstance(one, dict) for one in told):
                raise TypeError("its tournament is incomplete")

    @contextmanager
    def _reading(self) -> Iterator[None]:
        """Tell whatever comes of a damaged file in one sentence."""
        try:
            yield
        except ResultsError:
            raise
        except (sqlite3.Error, ValueError, TypeError, LookupError, OSError, EOFError, MemoryError) as error:
            raise ResultsError(f"{self.path} is damaged: {_words(error)}") from error
        except (zipfile.BadZipFile, zlib.error, RuntimeError, NotImplementedError) as error:
            raise ResultsError(
                f"{self.path} is damaged: its arrays cannot be read ({_words(error)})"
            ) from error

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """One transaction."""
        try:
            with self._connection:
                self._connection.execute("BEGIN IMMEDIATE")
                yield
        except sqlite3.Error as error:
            raise ResultsError(f"cannot write the results file {self.path}: {_words(error)}") from error

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
        with self._writing():
            self._connection.execute(
                "INSERT OR REPLACE INTO runs VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)", key + scores + costs
            )
            self._connection.execute("INSERT OR REPLACE INTO arrays VALUES (?, ?, ?)", (*key, outcome.arrays))

    def finished(self) -> set[tuple[str, int]]:
        """Entrant and replicate of the runs that need not be repeated."""
        return {(row["entrant"], row["replicate"]) for row in self.rows() if row["status"] == "finished"}

    def rows(self) -> list[dict[str, Any]]:
        """The runs in the order of the entrants in the tournament, and of their replicates.

        Raises:
            ResultsError: when the file is damaged.
        """
        with self._reading():
            order = {entrant["name"]: place for place, entrant in enumerate(self.config["entrants"])}
            cursor = self._connection.execute(f"SELECT {', '.join(_COLUMNS)} FROM runs")  # noqa: S608
            rows = [dict(zip(_COLUMNS, row, strict=True)) for row in cursor]
            for row in rows:
                for name, kinds in _COLUMNS.items():
                    absurd = isinstance(row[name], (int, float)) and not 0 <= row[name] <= _MOST
                    if absurd or not isinstance(row[name], kinds):
                        raise TypeError(f"{name} of a run is {row[name]!r}")
            orphans = (
                "SELECT count(*) FROM runs LEFT JOIN arrays USING (entrant, replicate) WHERE npz IS NULL"
            )
            if self._connection.execute(orphans).fetchone()[0]:
                raise LookupError("a run lacks its arrays")
            return sorted(rows, key=lambda row: (order[row["entrant"]], row["replicate"]))

    def arrays(self, entrant: str, replicate: int) -> Arrays:
        """The arrays of a run by name.

        Raises:
            KeyError: when there is no such run.
            ResultsError: when the file is damaged.
        """
        query = "SELECT npz FROM arrays WHERE entrant = ? AND replicate = ?"
        with self._reading():
            found = self._connection.execute(query, (entrant, replicate)).fetchone()
            if found:
                return unpack(found[0]) if found[0] else {}
        raise KeyError(f"no run {replicate} of {entrant!r}")

    def close(self) -> None:
        """Close the file; a temporary one is gone."""
        self._connection.close()
        self.release()

    def __del__(self) -> None:
        self.close()

    def release(self) -> None:
        """Let others write the file: nothing more will be added."""
        unlock(self._lock)
        self._lock = None

    def _told(self, key: str) -> Any:
        query = "SELECT value FROM tournament WHERE key = ?"
        with self._reading():
            return json.loads(self._connection.execute(query, (key,)).fetchone()[0])


def _words(error: BaseException) -> str:
    return str(error).splitlines()[0] if str(error) else type(error).__name__
