"""Versions of entrants: what decides the bits of an entrant's runs, all but the replicate."""

import hashlib
import json
from collections.abc import Mapping
from typing import Any

from arena.results.equivalence import equivalent_code

CONDITIONS = ("hill", "training", "evaluation", "seed")
"""What all runs in a results file have in common."""


def versions_of(config: Mapping[str, Any], sources: Mapping[str, str]) -> dict[str, str]:
    """The version of each entrant of a tournament, by name: equal for two if their runs are the same bits.

    It is a digest of the entrant's name, agent, parameters and code, and of the conditions. Code that is
    known to leave the same bits counts as the same.

    Args:
        config: the tournament as plain values that were read from JSON.
        sources: digests of the agents' code, by their names.
    """
    conditions = {key: config[key] for key in CONDITIONS}
    return {
        entrant["name"]: _digest(
            {
                **conditions,
                **{key: entrant[key] for key in ("name", "agent", "parameters")},
                "code": _canonical(entrant["agent"], sources.get(entrant["agent"], "")),
            }
        )
        for entrant in config["entrants"]
    }


def _canonical(agent: str, code: str) -> str:
    """One digest for all code of a built-in agent that leaves the same bits."""
    same = equivalent_code().get(agent, frozenset())
    return min(same) if code in same else code


def _digest(values: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(values, sort_keys=True).encode()).hexdigest()[:32]
