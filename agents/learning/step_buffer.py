"""Steps of an episode that wait to be learned."""

from typing import Any, NamedTuple, Self

import numpy as np

from agents.contract import Floats, Integers, Observation


class StepBuffer(NamedTuple):
    """The latest steps in a ring; a full ring forgets the oldest.

    A place is a row of the arrays; a negative one counts from the end.

    Attributes:
        states: int64, shape (places, active): the features that are active where a step began; of cells, one.
        actions: int64, shape (places,): what was done there.
        rewards: float64, shape (places,): what that brought.
        cursor: int64, shape (1,): place of the step to come; its state and action are known already.
        pending: int64, shape (1,): how many steps wait.
    """

    states: Integers
    actions: Integers
    rewards: Floats
    cursor: Integers
    pending: Integers

    @classmethod
    def with_capacity(cls, steps: int, active: int = 1) -> Self:
        """An empty ring for ``steps`` steps and the one to come, with so many active features each."""
        places = steps + 1
        states, actions = np.zeros((places, active), np.int64), np.zeros(places, np.int64)
        return cls(states, actions, np.zeros(places), np.zeros(1, np.int64), np.zeros(1, np.int64))

    def append(
        self,
        features: Any,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        next_action: int,
    ) -> None:
        """Remember a step, and the state and action of the one to come; ``features`` are cells or tiles."""
        here, last = self.cursor[0], self.actions.shape[0] - 1
        there = here + 1 if here < last else 0
        features.fill(observation, self.states[here])
        features.fill(next_observation, self.states[there])
        self.actions[here], self.actions[there], self.rewards[here] = action, next_action, reward
        self.cursor[0] = there
        self.pending[0] = min(self.pending[0] + 1, last)

    def back(self, steps: int) -> int:
        """The place of the step so many before the one to come; 1 is the newest."""
        return self.cursor[0] - steps  # type: ignore[no-any-return]  # an array has it

    def is_full(self) -> bool:
        """Whether the next step will push one out."""
        return self.pending[0] == self.actions.shape[0] - 1  # type: ignore[no-any-return]  # an array has it
