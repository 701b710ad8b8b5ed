"""Whether a results file may be continued as a tournament, and what both know of it."""

import json
from typing import Any

from arena.results.versions import CONDITIONS

# Changing these changes no result, so digests leave them out.
MAY_CHANGE = {"time_limit", "memory_limit"}


def difference(theirs: dict[str, Any], ours: dict[str, Any]) -> str:
    """The first of the conditions in which two tournaments differ, in words; empty if none does.

    The name is one of them, though no bit depends on it: another one is hardly meant for the same file.
    """
    for key in ("name", *CONDITIONS):
        if theirs.get(key) == ours.get(key):
            continue
        if isinstance(ours.get(key), (str, int)):
            return f"its {key} is {theirs.get(key)!r}, not {ours[key]!r}"
        return f"its {key} differs"
    return ""


def continued(theirs: dict[str, Any], ours: dict[str, Any]) -> dict[str, Any]:
    """The tournament ``ours``, with all that ``theirs``, of a file, knows of its entrants.

    Of an entrant whose agent cannot be had now only the name and the agent's name are known, for its
    parameters cannot be completed.
    """
    known = {entrant["name"]: entrant for entrant in theirs["entrants"]}
    return {**ours, "entrants": [_known(known.get(now["name"]), now) for now in ours["entrants"]]}


def as_read(config: dict[str, Any]) -> dict[str, Any]:
    """A tournament as it comes back from a file."""
    read: dict[str, Any] = json.loads(json.dumps(config))
    return read


def _known(before: dict[str, Any] | None, now: dict[str, Any]) -> dict[str, Any]:
    if before and "unavailable" in now and before["agent"] == now["agent"]:
        return before
    return now
