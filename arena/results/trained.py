"""The agent that a run trained, made again from the arrays in the results file; nothing is trained."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.interop.policy import Policy
from arena.common.html import represent
from arena.tournament.conditions import Conditions
from envs import Hill
from envs.foundation.errors import InvalidValueError


class UnknownPolicyError(InvalidValueError):
    """What a run has learned cannot be told from its results file; the message says why."""


@dataclass(frozen=True)
class Trained:
    """An agent as it was when its training ended.

    Attributes:
        entrant, replicate: which run.
        agent: to be asked for ``greedy``; not to be trained further, for its memory is not restored.
        conditions: of the tournament.
        test_lengths: steps of each test drive, int64, shape (episodes,).
        test_reached: whether it reached the goal, bool, shape (episodes,).
    """

    entrant: str
    replicate: int
    agent: Any
    conditions: Conditions
    test_lengths: NDArray[np.int64]
    test_reached: NDArray[np.bool_]

    @property
    def hill(self) -> Hill:
        """What it drives on."""
        return self.conditions.hill

    @property
    def policy(self) -> Policy:
        """What it has learned, for environments elsewhere: ``policy(observation)`` is the action."""
        return Policy(self.agent)

    @cached_property
    def starts(self) -> NDArray[np.float64]:
        """Positions where the test drives began, shape (episodes,)."""
        return self.conditions.start_states(self.replicate)[:, 0]

    def drive(self, position: float) -> NDArray[np.float64]:
        """A test drive from rest at ``position``: positions and velocities, shape (steps + 1, 2).

        It ends at the goal or at the limit of the test.
        """
        return drive(self.hill, self.agent, position, self.conditions.evaluation.max_steps)

    def _repr_html_(self) -> str:
        return represent(self)


def drive(hill: Hill, agent: Any, position: float, limit: int) -> NDArray[np.float64]:
    """A drive by ``agent.greedy`` from rest at ``position``, until the goal or for ``limit`` steps.

    Returns:
        Positions and velocities, float64, shape (steps + 1, 2).
    """
    state, states = (position, 0.0), [(position, 0.0)]
    for _ in range(limit):
        state, _, terminated = hill.step(state, int(agent.greedy(hill.observe(state))))
        states.append(state)
        if terminated:
            break
    return np.array(states)
