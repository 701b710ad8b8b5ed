"""What a results file must hold, checked when it is read: nothing else looks for damage."""

from collections.abc import Iterable
from typing import Any

from arena.statistics.sequential import ADAPTIVE, MAX_REPLICATES

_NUMBER = (int, float, type(None))
_LARGEST = 1e15  # more than any score or count
COLUMNS: dict[str, Any] = {
    "entrant": str,
    "replicate": int,
    "driver": str,
    "status": str,
    "accuracy": _NUMBER,
    "mean_length": _NUMBER,
    "iterations": int,
    "seconds": _NUMBER,
    "error": str,
}


def row_problem(row: dict[str, Any], entrants: Iterable[str]) -> str:
    """What is wrong with a row of the table ``runs``; empty if nothing is.

    Args:
        row: by the names of ``COLUMNS``.
        entrants: the names that there may be.
    """
    for name, kinds in COLUMNS.items():
        value = row[name]
        out_of_range = isinstance(value, (int, float)) and not 0 <= value <= _LARGEST
        if out_of_range or not isinstance(value, kinds):
            return f"{name} of a run is {value!r}"
    if row["status"] not in ("finished", "failed"):
        return f"status of a run is {row['status']!r}"
    return "" if row["entrant"] in entrants else f"there is a run of {row['entrant']!r}, who is no entrant"


def replicates_of(config: dict[str, Any]) -> int:
    """How many replicates there may be of each entrant of a tournament."""
    count: int = config["max_replicates" if config["replicates"] == ADAPTIVE else "replicates"]
    return count


def is_valid_config(config: Any) -> bool:
    """Whether a tournament that was read has what the rest of the program looks for."""
    kinds: dict[str, Any] = {"name": str, "reading": str, "seed": int, "replicates": (int, str)}
    kinds |= {"hill": dict, "entrants": list}
    if not isinstance(config, dict) or not all(isinstance(config.get(k), v) for k, v in kinds.items()):
        return False
    if not _are_valid_numbers(config):
        return False
    parts = {"name": str, "agent": str, "parameters": dict}
    if not all(
        isinstance(entrant, dict) and all(isinstance(entrant.get(k), v) for k, v in parts.items())
        for entrant in config["entrants"]
    ):
        return False
    # A name with control characters would command the terminal that it is printed on.
    names = [
        config["name"],
        config["reading"],
        *(e[k] for e in config["entrants"] for k in ("name", "agent")),
    ]
    return all(name.isprintable() for name in names)


def _are_valid_numbers(config: dict[str, Any]) -> bool:
    """Whether the lengths of a tournament are such as scores can be made of."""
    for part in (config.get("training"), config.get("evaluation")):
        lengths = [part.get(name) for name in ("episodes", "max_steps")] if isinstance(part, dict) else [None]
        if not all(isinstance(length, int) and 1 <= length <= _LARGEST for length in lengths):
            return False
    if not 0 <= config["seed"] <= _LARGEST:
        return False
    if isinstance(config["replicates"], int):
        return True
    most, leaders, confidence = (config.get(k) for k in ("max_replicates", "leaders", "confidence"))
    counts = (
        isinstance(most, int) and 1 <= most <= MAX_REPLICATES and isinstance(leaders, int) and leaders >= 1
    )
    level = isinstance(confidence, float) and 0.0 < confidence < 1.0
    return config["replicates"] == ADAPTIVE and counts and level
