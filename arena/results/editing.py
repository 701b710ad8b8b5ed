"""Results files made smaller, or one of several."""

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from arena.common.npz import unpack
from arena.results.continuation import difference
from arena.results.digests import run_digest
from arena.results.equivalence import are_equivalent
from arena.results.past import copy_aside, copy_past, forget
from arena.results.schema import replicates_of
from arena.results.store import ResultsError, Store
from arena.results.versions import versions_of
from arena.statistics.sequential import ADAPTIVE
from arena.tournament.outcome import Status
from envs.foundation.checks import choice
from envs.foundation.errors import InvalidValueError


def prune(path: Path) -> int:
    """Remove the runs that the tournament in the file does not need any more; how many there were.

    Raises:
        ResultsError: when it is no results file, or another process is writing it.
    """
    with Store.edit(path) as store:
        with store.transaction():
            count = forget(store.connection)
        store.connection.execute("VACUUM")
    return count


def drop(path: Path, names: Sequence[str]) -> None:
    """Remove entrants and their runs, former versions included.

    Raises:
        ResultsError: when it is no results file, or another process is writing it.
        InvalidValueError: when there is no such entrant, or no other would be left.
    """
    with Store.edit(path) as store:
        known = [entrant["name"] for entrant in store.config["entrants"]]
        for name in names:
            choice("entrant", name, known)
        if set(known) == set(names):
            raise InvalidValueError(f"entrant must leave another one, got all {len(known)} of {path}")
        entrants = [entrant for entrant in store.config["entrants"] if entrant["name"] not in names]
        with store.transaction():
            for table in ("runs", "arrays", "past_runs", "past_arrays", "versions"):
                rows = [(name,) for name in names]
                store.connection.executemany(f"DELETE FROM {table} WHERE entrant = ?", rows)  # noqa: S608 (names of ours)
            store.describe({**store.config, "entrants": entrants}, store.sources)
        store.connection.execute("VACUUM")


def merge(paths: Sequence[Path], out: Path) -> None:
    """Write a new results file with the runs of several, which have the same conditions.

    A run that is in more than one of them must be the same, to the bit. Of an entrant that is not the same
    in all, the first file's version is the entrant, and those of the others are former versions.

    Args:
        paths: of the files, two or more.
        out: the new file; there must be none yet.

    Raises:
        ResultsError: when the files cannot be joined.
    """
    if len(paths) < 2:
        raise InvalidValueError(f"files must be two or more, got {len(paths)}")
    if out.exists():
        raise ResultsError(f"{out} is there already; name another file")
    with ExitStack() as stack:
        stores = [stack.enter_context(Store.read(path)) for path in paths]
        config, sources = _joined(stores)
        try:
            store = stack.enter_context(Store.create(out, config, sources))
            origins: dict[tuple[str, int], tuple[str, Path | None]] = {}
            versions = versions_of(config, sources)
            for other in stores:
                _add(store, other, versions, origins)
        except BaseException:
            out.unlink(missing_ok=True)
            raise


def _joined(stores: Sequence[Store]) -> tuple[dict[str, Any], dict[str, str]]:
    """The tournament of all files, and the code of its agents."""
    first = stores[0]
    config, sources = dict(first.config), dict(first.sources)
    for other in stores[1:]:
        differs = difference(other.config, config)
        if differs or (config["replicates"] == ADAPTIVE) != (other.config["replicates"] == ADAPTIVE):
            raise ResultsError(
                f"{other.path} holds another tournament than {first.path} ({differs or 'its replicates'})"
            )
        known = {entrant["name"] for entrant in config["entrants"]}
        more = [entrant for entrant in other.config["entrants"] if entrant["name"] not in known]
        for agent in {entrant["agent"] for entrant in more}:
            code = other.sources.get(agent, "")
            if not are_equivalent(agent, code, sources.setdefault(agent, code)):
                raise ResultsError(f"{other.path} holds runs of other code of {agent!r} than {first.path}")
        key = "replicates" if config["replicates"] != ADAPTIVE else "max_replicates"
        count = max(replicates_of(config), replicates_of(other.config))
        config = {**config, "entrants": [*config["entrants"], *more], key: count}
    return config, sources


def _add(
    store: Store,
    other: Store,
    versions: dict[str, str],
    origins: dict[tuple[str, int], tuple[str, Path | None]],
) -> None:
    """Take over the runs of ``other``; ``origins`` has the bits of those that are there, and their file."""
    theirs = versions_of(other.config, other.sources)
    for outcome in other.outcomes():
        if theirs[outcome.entrant] != versions[outcome.entrant]:
            continue
        bits = run_digest(outcome, unpack(outcome.arrays)) if outcome.status == Status.FINISHED else ""
        before, origin = origins.get(outcome.key, ("", None))
        if bits and before and bits != before:
            which = f"replicate {outcome.replicate} of {outcome.entrant!r}"
            raise ResultsError(f"{which} is not the same in {origin} and {other.path}")
        if not before:
            store.add(outcome)
            origins[outcome.key] = bits, other.path
    with store.transaction():
        for entrant in other.config["entrants"]:
            if theirs[entrant["name"]] != versions[entrant["name"]]:
                copy_aside(
                    store.connection, other.connection, entrant, theirs[entrant["name"]], other.sources
                )
        copy_past(store.connection, other.connection)
