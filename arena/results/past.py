"""Runs that the tournament in a results file does not need at present: those of former versions of entrants.

They are kept beside the others, for they may be needed again: of an entrant that is renamed back, of more
replicates, of code that is taken back, or to see whether an edit helped.
"""

import json
import sqlite3
from collections.abc import Iterable, Mapping
from typing import Any

SCHEMA = """
CREATE TABLE IF NOT EXISTS versions (
    version TEXT PRIMARY KEY, entrant TEXT NOT NULL, description TEXT NOT NULL, number INTEGER NOT NULL);
CREATE TABLE IF NOT EXISTS past_runs (
    version TEXT NOT NULL, entrant TEXT NOT NULL, replicate INTEGER NOT NULL, driver TEXT NOT NULL,
    status TEXT NOT NULL, accuracy REAL, mean_length REAL, iterations INTEGER NOT NULL, seconds REAL NOT NULL,
    error TEXT NOT NULL, PRIMARY KEY (version, replicate));
CREATE TABLE IF NOT EXISTS past_arrays (
    version TEXT NOT NULL, entrant TEXT NOT NULL, replicate INTEGER NOT NULL, npz BLOB NOT NULL,
    PRIMARY KEY (version, replicate));
"""
_TABLES = ("runs", "arrays")
_COLUMNS = {
    "runs": "entrant, replicate, driver, status, accuracy, mean_length, iterations, seconds, error",
    "arrays": "entrant, replicate, npz",
}


def put_aside(
    connection: sqlite3.Connection, name: str, version: str, description: Any, first: int = 0
) -> None:
    """Move the finished runs of an entrant from replicate ``first`` on out of the way; forget failed ones.

    Args:
        connection: within a transaction.
        name: of the entrant.
        version: of the entrant until now.
        description: of that version, as plain values.
        first: the least replicate that goes.
    """
    finished = "(SELECT replicate FROM runs WHERE entrant = ? AND status = 'finished')"
    moved = 0
    for table in _TABLES:
        columns = _COLUMNS[table]
        moved += connection.execute(
            f"INSERT OR REPLACE INTO past_{table} (version, {columns}) SELECT ?, {columns} FROM {table} "  # noqa: S608 (names of ours)
            f"WHERE entrant = ? AND replicate >= ? AND replicate IN {finished}",
            (version, name, first, name),
        ).rowcount
    for table in _TABLES:
        connection.execute(f"DELETE FROM {table} WHERE entrant = ? AND replicate >= ?", (name, first))  # noqa: S608 (names of ours)
    if moved:
        _note(connection, version, name, description)


def take_back(connection: sqlite3.Connection, name: str, version: str, count: int) -> None:
    """Move the runs of a version, of the first ``count`` replicates, back among those of the tournament."""
    chosen = "version = ? AND entrant = ? AND replicate < ?"
    for table in _TABLES:
        columns = _COLUMNS[table]
        connection.execute(
            f"INSERT OR IGNORE INTO {table} ({columns}) SELECT {columns} FROM past_{table} WHERE {chosen}",  # noqa: S608 (names of ours)
            (version, name, count),
        )
        connection.execute(f"DELETE FROM past_{table} WHERE {chosen}", (version, name, count))  # noqa: S608 (names of ours)
    connection.execute(
        "DELETE FROM versions WHERE version = ? AND version NOT IN (SELECT version FROM past_runs)",
        (version,),
    )


def past_keys(connection: sqlite3.Connection) -> dict[str, set[tuple[str, int]]]:
    """Entrant and replicate of the past runs, by version."""
    keys: dict[str, set[tuple[str, int]]] = {}
    for version, entrant, replicate in connection.execute(
        "SELECT version, entrant, replicate FROM past_runs"
    ):
        keys.setdefault(version, set()).add((entrant, replicate))
    return keys


def past_versions(connection: sqlite3.Connection) -> dict[str, list[tuple[str, Mapping[str, Any]]]]:
    """The past versions of each entrant and their descriptions, the latest first."""
    found: dict[str, list[tuple[str, Mapping[str, Any]]]] = {}
    query = "SELECT entrant, version, description FROM versions ORDER BY number DESC"
    for entrant, version, description in connection.execute(query):
        found.setdefault(entrant, []).append((version, json.loads(description)))
    return found


def copy_aside(
    connection: sqlite3.Connection,
    other: sqlite3.Connection,
    entrant: Mapping[str, Any],
    version: str,
    sources: Mapping[str, str],
) -> None:
    """Make past runs, within a transaction, of an entrant's finished runs in another file."""
    name = entrant["name"]
    query = f"SELECT {_COLUMNS['runs']} FROM runs WHERE entrant = ? AND status = 'finished'"  # noqa: S608 (names of ours)
    rows = other.execute(query, (name,)).fetchall()
    _insert(connection, "past_runs", ((version, *row) for row in rows))
    done = {row[1] for row in rows}
    arrays = other.execute(f"SELECT {_COLUMNS['arrays']} FROM arrays WHERE entrant = ?", (name,))  # noqa: S608 (names of ours)
    _insert(connection, "past_arrays", ((version, *row) for row in arrays if row[1] in done))
    if rows:
        _note(connection, version, name, {**entrant, "code": sources.get(entrant["agent"], "")})


def copy_past(connection: sqlite3.Connection, other: sqlite3.Connection) -> None:
    """Take over, within a transaction, the past runs in another file; one of an earlier schema has none."""
    if other.execute("PRAGMA user_version").fetchone() == (1,):
        return
    for table in _TABLES:
        columns = f"version, {_COLUMNS[table]}"
        _insert(connection, f"past_{table}", other.execute(f"SELECT {columns} FROM past_{table}"))  # noqa: S608 (names of ours)
    for version, name, description in other.execute(
        "SELECT version, entrant, description FROM versions ORDER BY number"
    ):
        _note(connection, version, name, json.loads(description))


def _insert(connection: sqlite3.Connection, table: str, rows: Iterable[tuple[Any, ...]]) -> None:
    marks = {"past_runs": 10, "past_arrays": 4}[table]
    connection.executemany(f"INSERT OR IGNORE INTO {table} VALUES ({', '.join('?' * marks)})", rows)  # noqa: S608 (names of ours)


def _note(connection: sqlite3.Connection, version: str, name: str, description: Any) -> None:
    (number,) = connection.execute("SELECT coalesce(max(number), 0) + 1 FROM versions").fetchone()
    row = (version, name, json.dumps(description), number)
    connection.execute("INSERT OR REPLACE INTO versions VALUES (?, ?, ?, ?)", row)


def forget(connection: sqlite3.Connection) -> int:
    """Remove all past runs; how many there were."""
    (count,) = connection.execute("SELECT count(*) FROM past_runs").fetchone()
    for table in ("past_runs", "past_arrays", "versions"):
        connection.execute(f"DELETE FROM {table}")  # noqa: S608 (names of ours)
    return int(count)
