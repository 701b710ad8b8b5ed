"""Readings of the paper's protocol where its text leaves it open, or its code did something else.

``literal`` takes the text at its word; ``as-run`` is what explains its tables (docs/readings.md).
"""

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from agents import HarmonicRate
from arena.tournament.entrant import Entrant
from envs.foundation.checks import choice

_CENTRE = -math.pi / 6.0
_NEAR_CENTRE = {"min_start": _CENTRE - 0.01, "max_start": _CENTRE + 0.01}


@dataclass(frozen=True)
class Reading:
    """One way to read the paper.

    Attributes:
        description: what differs from the literal reading, a phrase.
        hill: constants of the hill that it sets.
        parameters: of agents that it sets, where an agent has them and they were not given.
    """

    description: str
    hill: Mapping[str, Any] = field(default_factory=dict)
    parameters: Mapping[str, Any] = field(default_factory=dict)

    def read(self, entrant: Entrant) -> Entrant:
        """The entrant under this reading."""
        changed = {
            name: value
            for name, value in self.parameters.items()
            if name in entrant.parameters and name not in entrant.given
        }
        return entrant.with_parameters(**changed) if changed else entrant


READINGS: dict[str, Reading] = {
    "literal": Reading("zero table, starts in U(-0.6, -0.4), n counts every step"),
    "as-run": Reading(
        "n edges, n - 1 cells a dimension, the goal is a cell like any other, the step there has reward 0, "
        "the wall does not stop the car",
        hill={"inelastic_wall": False, "goal_reward": 0.0},
        parameters={"binning": "digitize", "goal": "bootstrap"},
    ),
    "slow-state-visits": Reading(
        "n counts the visits of the state, C = 0.001, starts within 0.05 of -pi/6, positions end at pi/6, "
        "table from U(-2, 0)",
        hill={"min_start": _CENTRE - 0.05, "max_start": _CENTRE + 0.05, "max_position": -_CENTRE},
        parameters={
            "step_size": HarmonicRate(C=0.001),
            "count_visits": "state",
            "initial_values": (-2.0, 0.0),
        },
    ),
    "state-visits": Reading(
        "n counts the visits of the state, whatever the action", parameters={"count_visits": "state"}
    ),
    "constant-rate": Reading(
        "constant step size 0.2", parameters={"step_size": HarmonicRate(A=1.0, B=5.0, C=0.0)}
    ),
    "explicit-euler": Reading("Eq. (6) as printed", hill={"integrator": "explicit"}),
}
RETIRED: dict[str, Reading] = {
    "episode-visits": Reading(
        "n counts a visit once an episode, starts within 0.01 of -pi/6",
        hill=_NEAR_CENTRE,
        parameters={"count_visits": "episode"},
    ),
    "slow-rate": Reading(
        "C = 0.001, starts within 0.01 of -pi/6",
        hill=_NEAR_CENTRE,
        parameters={"step_size": HarmonicRate(C=0.001)},
    ),
    "bootstrapped-goal": Reading(
        "C = 0.001, starts within 0.01 of -pi/6, the goal is a cell like any other, table from U(-2, 0)",
        hill=_NEAR_CENTRE,
        parameters={
            "step_size": HarmonicRate(C=0.001),
            "goal": "bootstrap",
            "initial_values": (-2.0, 0.0),
        },
    ),
    "zeroed-goal": Reading(
        "n counts a visit once an episode, starts at -pi/6, the goal step sets the value to 0, "
        "the wall does not stop the car",
        hill={"min_start": _CENTRE, "max_start": _CENTRE, "inelastic_wall": False},
        parameters={"count_visits": "episode", "goal": "zero"},
    ),
}
"""Attempts of 0.1 to explain Table 2, which ``as-run`` does; they go in 0.4."""


def find_reading(name: str) -> Reading:
    """The reading of that name; one that will go warns.

    Raises:
        TypeError, ValueError: when there is none; the message lists those there are.
    """
    if isinstance(name, str) and name in RETIRED:
        why = f"reading {name!r} goes in version 0.4: 'as-run' explains what it tried to (docs/readings.md)"
        warnings.warn(why, FutureWarning, stacklevel=2)
        return RETIRED[name]
    return READINGS[choice("reading", name, READINGS)]
