"""Steps to learn from all at once."""

from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from agents.contract import Floats, Integers, Observation


class Batch(NamedTuple):
    """Places for steps.

    Attributes:
        observations: float64, shape (places, dimensions).
        actions: int64, shape (places,).
        rewards: float64, shape (places,).
        next_observations: float64, shape (places, dimensions).
        goes_on: bool, shape (places,): whether the step did not reach the goal.
    """

    observations: Floats
    actions: Integers
    rewards: Floats
    next_observations: Floats
    goes_on: NDArray[np.bool_]

    @classmethod
    def with_capacity(cls, places: int, dimensions: int) -> Self:
        """A batch of steps that are still to be written."""
        observations, next_observations = np.zeros((2, places, dimensions))
        actions, rewards = np.zeros(places, np.int64), np.zeros(places)
        return cls(observations, actions, rewards, next_observations, np.zeros(places, np.bool_))

    def first(self, places: int) -> "Batch":
        """What is in the first so many places."""
        return Batch._make(part[:places] for part in self)

    def write(
        self,
        place: int,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        terminated: bool,
    ) -> None:
        """Write a step into a place."""
        self.observations[place], self.next_observations[place] = observation, next_observation
        self.actions[place], self.rewards[place], self.goes_on[place] = action, reward, not terminated
