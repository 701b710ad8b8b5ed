"""On-policy every-visit Monte Carlo control: Sutton & Barto 2018, section 5.4; Singh & Sutton 1996."""

from typing import Any, Self

import numpy as np

from agents.algorithms.tabular import Tabular
from agents.contract import Observation, Task
from agents.learning.step_buffer import Steps
from agents.parameters.declared import Count, validated
from agents.parameters.inheritance import inherits


class MonteCarlo(Tabular[Steps]):
    """Learns from what whole episodes return: every visit counts, and no value leans on another.

    An episode is learned at the goal, the newest step first. One that a time limit ends has no return;
    it is learned when the next one begins, and what it misses is taken to be the value of the last
    cell and the action chosen there. Without that the car may never see the goal: the empty table
    thrusts left, and what is never learned never changes. After the last episode of the training, if a
    time limit ends it, nothing is learned from it.
    """

    __slots__ = ()

    @classmethod
    @validated
    @inherits(Tabular.create)
    def create(
        cls, task: Task, *, memory: Count = 30_000, rng: np.random.Generator | None = None, **inherited: Any
    ) -> Self:
        """The agent before it has learned anything.

        Args:
            task: the hill.
            memory: steps of an episode that are remembered; of a longer one the earliest are forgotten.
            rng: draws the initial values.
            inherited: see ``Tabular.create``. ``step_size=HarmonicRate(1, 1, 1)`` is the book's mean of all
                returns; it learns less well, for the returns of early, bad drives weigh as much as any.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        table: Tabular[None] = Tabular.create(task, rng=rng, **inherited)
        return cls(*table[:-1], Steps.room_for(memory))

    def begin_episode(self) -> None:
        """Learn from an episode that a time limit ended."""
        self.learn_episode(False)
        self.update.begin_episode()

    def learn(
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        next_action: int,
        terminated: bool,
    ) -> None:
        """Remember this step; at the goal, learn from the episode."""
        cell, next_cell = self.cells.encode(observation), self.cells.encode(next_observation)
        self.memory.append(cell, action, reward, next_cell, next_action)
        if terminated:
            self.learn_episode(True)

    def learn_episode(self, terminated: bool) -> None:
        """Learn all steps that wait, the newest first.

        Args:
            terminated: whether the newest reached the goal.
        """
        steps, goal = self.memory, terminated
        place = steps.now[0]
        following = self.values[steps.cells[place], steps.actions[place]]
        for age in range(1, steps.now[1] + 1):
            place = steps.back(age)
            cell, action, reward = steps.cells[place], steps.actions[place], steps.rewards[place]
            self.update.apply(self.values, self.visits, cell, action, reward, following, goal)
            following = self.update.target(reward, following, goal)
            goal = False
        steps.now[1] = 0
