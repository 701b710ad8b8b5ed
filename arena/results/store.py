"""The results file: SQLite, one transaction a finished run, written by one process.

Tables (also in ``docs/results.md``): ``tournament`` (key, value), ``runs`` (one row a run) and ``arrays``
(its arrays as the bytes of an ``.npz`` file); runs that the tournament does not need at present are beside
them (``arena.results.past``). Nothing in a results file is ever executed.
"""

import json
import math
import shutil
import sqlite3
import urllib.parse
import weakref
from collections.abc import Container, Iterable, Iterator, Mapping
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from types import MappingProxyType
from typing import Any

from filelock import FileLock

from arena.common.locks import LockedError, lock_file, unlock
from arena.common.npz import Arrays, unpack
from arena.results.continuation import as_read, continued, difference
from arena.results.growth import Growth, growth
from arena.results.past import SCHEMA as PAST_SCHEMA
from arena.results.past import past_keys, past_versions, put_aside, take_back
from arena.results.provenance import versions
from arena.results.schema import COLUMNS, is_valid_config, replicates_of, row_problem
from arena.results.versions import versions_of
from arena.tournament.outcome import Outcome, Status
from envs.foundation.errors import InvalidValueError

APPLICATION_ID = 0x4D434152  # "MCAR"
SCHEMA_VERSION = 2

_SCHEMA = f"""
CREATE TABLE tournament (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE runs (
    entrant TEXT NOT NULL, replicate INTEGER NOT NULL, driver TEXT NOT NULL, status TEXT NOT NULL,
    accuracy REAL, mean_length REAL, iterations INTEGER NOT NULL, seconds REAL NOT NULL,
    error TEXT NOT NULL, PRIMARY KEY (entrant, replicate));
CREATE TABLE arrays (
    entrant TEXT NOT NULL, replicate INTEGER NOT NULL, npz BLOB NOT NULL,
    PRIMARY KEY (entrant, replicate));
{PAST_SCHEMA}
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
        connection: to the database, for the modules of this package.
    """

    config: dict[str, Any]
    versions: dict[str, str]
    sources: dict[str, str]
    _schema: int

    def __init__(self, connection: sqlite3.Connection, path: Path | None) -> None:
        self.path = path
        self.connection = connection
        self._lock: FileLock | None = None
        self._past: dict[str, str] = {}  # versions by what they are shown as
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
        """The file of an earlier start, now of the tournament ``config``: other runs are put aside.

        Raises:
            ResultsError: when it is no results file, or that of a tournament under other conditions.
        """
        store = cls.edit(path)
        try:
            store._grow(as_read(config), sources)  # noqa: SLF001 (its own)
        except BaseException:
            store.close()
            raise
        return store

    @classmethod
    def edit(cls, path: Path) -> "Store":
        """An existing file, to be changed; one of an earlier schema is brought to this one.

        Raises:
            ResultsError: when it is no results file, or cannot be written.
        """
        store = cls._open(path, "rw")
        try:
            store._lock = lock_file(path)  # noqa: SLF001 (its own)
            store._take_over()  # noqa: SLF001 (its own)
        except (LockedError, OSError) as error:
            store.close()
            raise _unwritable(path, error) from error
        except BaseException:
            store.close()
            raise
        return store

    @classmethod
    def read(cls, path: Path, past: Iterable[str] = ()) -> "Store":
        """An existing file, only to be read.

        Args:
            path: of the file.
            past: former versions of entrants that are wanted beside the others, such as ``mine@old``.

        Raises:
            ResultsError: when it is missing or no results file, or has no such version.
        """
        store = cls._open(path, "ro")
        try:
            for label in past:
                store._include(label)  # noqa: SLF001 (its own)
        except BaseException:
            store.close()
            raise
        return store

    @classmethod
    def _open(cls, path: Path, mode: str) -> "Store":
        if not path.is_file():
            raise ResultsError(f"there is no results file {path}")
        uri = f"file:{urllib.parse.quote(str(path.absolute()))}?mode="
        try:
            if mode == "ro" and path.with_name(f"{path.name}-journal").exists():
                # A process that was killed while it wrote: only one that may write can take that back.
                with suppress(sqlite3.Error), closing(_connect(f"{uri}rw")) as connection:
                    connection.execute("SELECT count(*) FROM sqlite_master").fetchone()
            return cls(_connect(f"{uri}{mode}"), path)
        except sqlite3.Error as error:
            raise ResultsError(f"{path} is not a results file of the arena: {first_line(error)}") from error

    def growth(self, config: dict[str, Any], sources: Mapping[str, str], only: Container[int]) -> Growth:
        """What becomes of the runs in the file if it is continued as the tournament ``config``.

        Args:
            config: see ``resume``.
            sources: see ``resume``.
            only: the replicates that are to be run.

        Raises:
            ResultsError: when it is that of a tournament under other conditions.
        """
        config, sources = self._with_what_is_known(as_read(config), sources)
        past = past_keys(self.connection) if self._schema > 1 else {}
        return growth(
            config,
            versions_of(config, sources),
            range(replicates_of(config)),
            only,
            self.config,
            versions_of(self.config, self.sources),
            self.finished(),
            past,
        )

    def _include(self, label: str) -> None:
        """Show a former version of an entrant as one of its own, called ``label``."""
        name, _, which = label.rpartition("@")
        current = versions_of(self.config, self.sources).get(name)
        with self._reading():
            versions = past_versions(self.connection).get(name, []) if self._schema > 1 else []
        found = [
            (version, description)
            for version, description in versions
            if version != current and (which == "old" or (which and version.startswith(which)))
        ]
        if not found:
            raise ResultsError(
                f"{self.path} has no former version {label!r}; it has {_listed(versions, current)}"
            )
        version, description = found[0]
        entrant = {"name": label, **{key: description[key] for key in ("agent", "parameters")}}
        self.config = {**self.config, "entrants": [*self.config["entrants"], entrant]}
        self._past[label] = version

    def _take_over(self) -> None:
        """Bring a file of an earlier schema to this one; a copy is kept until that has succeeded."""
        if self._schema == SCHEMA_VERSION or self.path is None:
            return
        copy = self.path.with_name(f"{self.path.name}.schema-{self._schema}")
        shutil.copy2(self.path, copy)
        with self.transaction():
            for statement in filter(str.strip, PAST_SCHEMA.split(";")):
                self.connection.execute(statement)
            self.connection.execute(f"PRAGMA user_version = {SCHEMA_VERSION}")
        self._schema = SCHEMA_VERSION
        copy.unlink()

    def _grow(self, config: dict[str, Any], sources: Mapping[str, str]) -> None:
        """Make this the file of the tournament ``config``, with those of its runs that there are."""
        config, sources = self._with_what_is_known(config, sources)
        before, after = versions_of(self.config, self.sources), versions_of(config, sources)
        count = replicates_of(config)
        with self.transaction():
            for entrant in self.config["entrants"]:
                name, first = entrant["name"], count
                if after.get(name) != before[name]:
                    first = 0
                description = {**entrant, "code": self.sources.get(entrant["agent"], "")}
                put_aside(self.connection, name, before[name], description, first)
            for name, version in after.items():
                take_back(self.connection, name, version, count)
            self.describe(config, sources)

    def describe(self, config: dict[str, Any], sources: dict[str, str]) -> None:
        """Make ``config`` the tournament, within a transaction that sees to its runs."""
        rows = [(json.dumps(config), "config"), (json.dumps(sources), "sources")]
        self.connection.executemany("UPDATE tournament SET value = ? WHERE key = ?", rows)
        self.config, self.sources, self._stored = config, sources, config

    def _with_what_is_known(
        self, config: dict[str, Any], sources: Mapping[str, str]
    ) -> tuple[dict[str, Any], dict[str, str]]:
        """The tournament ``config`` and the code of its agents, with all that the file knows of them."""
        differs = difference(self.config, config)
        if differs:
            raise ResultsError(
                f"{self.path} holds another tournament ({differs}); name another file or remove this one"
            )
        return continued(self.config, config), {**self.sources, **sources}

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
        with self.transaction():
            self.connection.execute("INSERT OR REPLACE INTO runs VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)", row)
            self.connection.execute(
                "INSERT OR REPLACE INTO arrays VALUES (?, ?, ?)", (*outcome.key, outcome.arrays)
            )

    def outcomes(self) -> Iterator[Outcome]:
        """The runs as they were added."""
        for row in self.rows():
            accuracy, length = (math.nan if row[n] is None else row[n] for n in ("accuracy", "mean_length"))
            yield Outcome(
                row["entrant"],
                row["replicate"],
                row["driver"],
                Status(row["status"]),
                accuracy,
                length,
                row["iterations"],
                row["seconds"],
                self._packed(row["entrant"], row["replicate"]) or b"",
                row["error"],
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
        with self._reading(), self._snapshot():
            if self._value("config") != self._stored:
                raise ResultsError(f"{self.path} was changed by another process; open it again")
            columns = ", ".join(COLUMNS)
            cursor = self.connection.execute(f"SELECT {columns} FROM runs")  # noqa: S608 (names of ours)
            rows = [dict(zip(COLUMNS, row, strict=True)) for row in cursor]
            for label, version in self._past.items():
                query = f"SELECT {columns} FROM past_runs WHERE version = ?"  # noqa: S608 (names of ours)
                cursor = self.connection.execute(query, (version,))
                rows += [{**dict(zip(COLUMNS, row, strict=True)), "entrant": label} for row in cursor]
            orphans = (
                "SELECT count(*) FROM runs LEFT JOIN arrays USING (entrant, replicate) WHERE npz IS NULL"
            )
            (orphaned,) = self.connection.execute(orphans).fetchone()
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
        packed = self._packed(entrant, replicate)
        if packed is None:
            raise KeyError(f"no run {replicate} of {entrant!r}")
        try:
            return unpack(packed) if packed else {}
        except Exception as error:  # of any kind: zip, zlib and numpy each have their own
            raise self._damaged(f"its arrays cannot be read ({first_line(error)})") from error

    def _packed(self, entrant: str, replicate: int) -> bytes | None:
        table, column = ("past_arrays", "version") if entrant in self._past else ("arrays", "entrant")
        query = f"SELECT npz FROM {table} WHERE {column} = ? AND replicate = ?"  # noqa: S608 (names of ours)
        with self._reading():
            row = self.connection.execute(query, (self._past.get(entrant, entrant), replicate)).fetchone()
        return row[0] if row else None

    def close(self) -> None:
        """Close the file; a temporary one is gone."""
        self._closing()
        self.release()

    def __enter__(self) -> "Store":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        self.close()

    def release(self) -> None:
        """Let others write the file: nothing more will be added."""
        unlock(self._lock)
        self._lock = None

    def _load(self) -> None:
        """Read and check all but the runs; errors of SQLite mean that it is no such file."""
        (application,) = self.connection.execute("PRAGMA application_id").fetchone()
        (version,) = self.connection.execute("PRAGMA user_version").fetchone()
        if application != APPLICATION_ID:
            raise ResultsError(f"{self.path} is not a results file of the arena")
        self._schema = int(version)
        if version > SCHEMA_VERSION:
            raise ResultsError(
                f"{self.path} was written by a newer arena (schema {version}, known is {SCHEMA_VERSION})"
            )
        self.config, self.versions, self.sources = map(self._value, ("config", "versions", "sources"))
        self._stored = self.config
        known = isinstance(self.versions, dict) and isinstance(self.sources, dict)
        if not known or not is_valid_config(self.config):
            raise self._damaged("its tournament is incomplete")

    def _value(self, key: str) -> Any:
        query = "SELECT value FROM tournament WHERE key = ?"
        with self._reading():
            row = self.connection.execute(query, (key,)).fetchone()
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
    def _snapshot(self) -> Iterator[None]:
        """Read from one state of the file, whatever is written in the meantime."""
        self.connection.execute("BEGIN")
        try:
            yield
        finally:
            self.connection.execute("ROLLBACK")

    @contextmanager
    def transaction(self) -> Iterator[None]:
        """All that is written meanwhile, or nothing.

        Raises:
            ResultsError: when it cannot be written.
        """
        try:
            with self.connection:
                self.connection.execute("BEGIN IMMEDIATE")
                yield
        except sqlite3.Error as error:
            raise _unwritable(self.path, error) from error


def first_line(error: BaseException) -> str:
    """Of the message; the name of the error's class if it has none."""
    return str(error).splitlines()[0] if str(error) else type(error).__name__


def _listed(versions: Iterable[tuple[str, Any]], current: str | None) -> str:
    return ", ".join(version for version, _ in versions if version != current) or "none of that entrant"


def _unwritable(path: Path | None, error: BaseException) -> ResultsError:
    return ResultsError(f"cannot write the results file {path}: {first_line(error)}")


def _connect(uri: str) -> sqlite3.Connection:
    # Results that are dropped are closed by whichever thread collects them.
    return sqlite3.connect(uri, uri=True, isolation_level=None, check_same_thread=False)


def _fill(connection: sqlite3.Connection, rows: list[tuple[str, str]]) -> None:
    connection.executescript(_SCHEMA)
    with connection:
        connection.executemany("INSERT INTO tournament VALUES (?, ?)", rows)
