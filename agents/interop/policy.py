"""What an agent has learned as a policy for other environments and libraries."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from agents.contract import Integers
from envs.foundation.errors import InvalidValueError


@dataclass(frozen=True, eq=False)
class Policy:
    """``agent.greedy`` as a function of what environments show; it can be pickled if the agent can.

    Called with an observation, shape (2,), it returns the action, an int; with those of several cars,
    shape (cars, 2), an int64 array, shape (cars,); with a dictionary of observations, a dictionary of
    actions, as PettingZoo has them.

    Observations may be of any kind of float; the agent receives them in float64. Those of Gymnasium are
    rounded to float32: at the edge of a cell, the action may be that of the next cell.

    Args:
        agent: with the method ``greedy``.

    Raises:
        ValueError: when it is called with something of another shape.
    """

    agent: Any

    def __call__(self, observation: Any) -> Any:
        """The action, or an action for each car."""
        if isinstance(observation, Mapping):
            return {car: self(seen) for car, seen in observation.items()}
        seen = np.asarray(observation, np.float64)
        if seen.ndim not in (1, 2) or seen.shape[-1] != 2:
            raise InvalidValueError(f"observation must be of shape (2,) or (cars, 2), got shape {seen.shape}")
        if seen.ndim == 1:
            return int(self.agent.greedy(seen))
        return np.array([self.agent.greedy(row) for row in seen], np.int64)

    def predict(
        self, observation: Any, state: Any = None, episode_start: Any = None, deterministic: bool = True
    ) -> tuple[Integers, Any]:
        """The same for what expects a model of Stable-Baselines3, such as its ``evaluate_policy``.

        Args:
            observation: shape (2,) or (cars, 2).
            state: of a policy with memory; returned as it is.
            episode_start: of a policy with memory; not used.
            deterministic: not used: ``greedy`` is deterministic, except of the agent that drives at random.

        Returns:
            The actions, int64, shape () or (cars,), and ``state``.
        """
        return np.asarray(self(observation), np.int64), state
