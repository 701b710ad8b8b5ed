"""Whether a results file is of the same tournament, and what it learns when it is continued."""

import json
from typing import Any

# Changing these changes no result, so a tournament may be continued with others.
MAY_CHANGE = {"time_limit", "memory_limit"}


def difference(theirs: dict[str, Any], ours: dict[str, Any]) -> str:
    """The first thing in which two tournaments differ, in words; empty if they are the same.

    Of an entrant whose agent could not be had then, or cannot be had now, only the name and the agent's
    name count: its parameters could not be completed.
    """
    for key in {**ours, **theirs}:
        if key in MAY_CHANGE or theirs.get(key) == ours.get(key):
            continue
        if key == "entrants" and _same_entrants(theirs[key], ours[key]):
            continue
        if isinstance(ours.get(key), (str, int)):
            return f"its {key} is {theirs.get(key)!r}, not {ours[key]!r}"
        return f"its {key} differ"
    return ""


def continued(theirs: dict[str, Any], ours: dict[str, Any]) -> dict[str, Any]:
    """The tournament ``theirs``, of a file, with all that ``ours``, the same, knows of its entrants."""
    pairs = zip(theirs["entrants"], ours["entrants"], strict=True)
    return {**theirs, "entrants": [before if _unavailable(now) else now for before, now in pairs]}


def as_read(config: dict[str, Any]) -> dict[str, Any]:
    """A tournament as it comes back from a file."""
    read: dict[str, Any] = json.loads(json.dumps(config))
    return read


def _same_entrants(theirs: list[dict[str, Any]], ours: list[dict[str, Any]]) -> bool:
    return len(theirs) == len(ours) and all(
        all(before[key] == now[key] for key in ("name", "agent"))
        if _unavailable(before) or _unavailable(now)
        else before == now
        for before, now in zip(theirs, ours, strict=True)
    )


def _unavailable(entrant: dict[str, Any]) -> bool:
    return "unavailable" in entrant
