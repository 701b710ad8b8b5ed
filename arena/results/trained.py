"""The agent that a run trained, made again from the arrays in the results file; nothing is trained."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.interop.policy import Policy
from agents.registry import agent_class
from arena.common.html import represent
from arena.common.npz import Arrays
from arena.tournament.conditions import Conditions, Run
from arena.tournament.entrant import Entrant
from arena.tournament.outcome import agent_arrays
from envs import Hill
from envs.foundation.errors import InvalidValueError

_CHECKED_DRIVES = 3  # of the test, driven again to see whether the agent is the one that was trained


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


def restore(
    entrant: str,
    agent: str,
    parameters: Mapping[str, Any],
    replicate: int,
    conditions: Conditions,
    arrays: Arrays,
) -> Trained:
    """The agent that a run trained.

    It is made as it was for the run, then its arrays are filled with those in the file; and it must drive
    the first drives of the test in the steps that it took then.

    Args:
        entrant: its name.
        agent: the name of its agent.
        parameters: of the agent, as plain values.
        replicate: which of its runs.
        conditions: of the tournament.
        arrays: that the run left behind.

    Raises:
        UnknownPolicyError: when its agent is not installed, or it learned more than its arrays tell.
    """
    try:
        run = Run(Entrant(entrant, agent_class(agent), **parameters), replicate)
        untrained = run.entrant.create(conditions.hill, run.stream(conditions.seed, "create"))
    except Exception as error:  # of any kind: the agent's code is anybody's
        reason = " ".join(str(error).split())
        raise UnknownPolicyError(f"the agent of {entrant!r} cannot be made again: {reason}") from error
    for name, array in agent_arrays(untrained).items():
        if name not in arrays or arrays[name].shape != array.shape:
            raise UnknownPolicyError(f"{entrant!r} has other arrays than its agent has now: {name} differs")
        if array.flags.writeable:
            array[...] = arrays[name]
    restored = Trained(
        entrant, replicate, untrained, conditions, arrays["test_lengths"], arrays["test_reached"]
    )
    for start, steps in zip(restored.starts[:_CHECKED_DRIVES], restored.test_lengths):
        if len(restored.drive(float(start))) - 1 != steps:
            raise UnknownPolicyError(f"{entrant!r} has learned more than the arrays in its results tell")
    return restored
