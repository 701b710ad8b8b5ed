"""Steps of an episode that wait to be learned."""

from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from agents.learning.action_values import Counts


class Steps(NamedTuple):
    """The latest steps in a ring; a full ring forgets the oldest.

    Attributes:
        cells: int64, shape (places,): where each step began.
        actions: int64, shape (places,).
        rewards: float64, shape (places,): what each step brought.
        now: int64, shape (2,): the place of the step to come, where its cell and action are known
            already, and how many steps wait.
    """

    cells: Counts
    actions: Counts
    rewards: NDArray[np.float64]
    now: Counts

    @classmethod
    def room_for(cls, steps: int) -> Self:
        """An empty ring for ``steps`` steps and the one to come."""
        cells, actions = np.zeros((2, steps + 1), np.int64)
        return cls(cells, actions, np.zeros(steps + 1), np.zeros(2, np.int64))

    def append(self, cell: int, action: int, reward: float, next_cell: int, next_action: int) -> None:
        """Remember a step, and the cell and action of the one to come."""
        here, last = self.now[0], self.cells.shape[0] - 1
        there = here + 1 if here < last else 0
        self.cells[here], self.actions[here], self.rewards[here] = cell, action, reward
        self.cells[there], self.actions[there] = next_cell, next_action
        self.now[0] = there
        self.now[1] = min(self.now[1] + 1, last)

    def back(self, steps: int) -> int:
        """The place of the step so many before the one to come, from the end if below 0; 1 is the newest."""
        return self.now[0] - steps  # type: ignore[no-any-return]  # an array has it
