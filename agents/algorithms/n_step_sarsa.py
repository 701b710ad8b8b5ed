"""n-step SARSA: Watkins 1989, Cichosz 1995; Sutton & Barto 2018, section 7.2."""

from typing import Any, Self

import numpy as np

from agents.algorithms.tabular import Tabular
from agents.contract import Observation, Task
from agents.learning.step_buffer import Steps
from agents.parameters.declared import Count, validated
from agents.parameters.inheritance import inherits


class NStepSarsa(Tabular[Steps]):
    """On-policy control that learns from the n next rewards and the value of what follows them.

    The step n - 1 before the current one is learned; at the goal all that wait, the oldest first.
    Those that wait when a time limit ends an episode are learned when the next one begins, from the
    rewards there were and the value of the last cell and the action chosen there. After the last
    episode of the training, if a time limit ends it, up to n - 1 steps stay unlearned.
    """

    __slots__ = ()

    @classmethod
    @validated
    @inherits(Tabular.create)
    def create(
        cls, task: Task, *, n: Count = 4, rng: np.random.Generator | None = None, **inherited: Any
    ) -> Self:
        """The agent before it has learned anything.

        Args:
            task: the hill.
            n: steps until an estimated value takes the place of rewards; 1 is SARSA.
            rng: draws the initial values.
            inherited: see ``Tabular.create``.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        table: Tabular[None] = Tabular.create(task, rng=rng, **inherited)
        return cls(*table[:-1], Steps.room_for(n))

    def begin_episode(self) -> None:
        """Learn what a time limit left over."""
        while self.memory.now[1] > 0:
            self.learn_oldest(False)
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
        """Remember this step, learn the one n - 1 before it."""
        steps, next_cell = self.memory, self.cells.encode(next_observation)
        steps.append(self.cells.encode(observation), action, reward, next_cell, next_action)
        if terminated:
            while steps.now[1] > 0:
                self.learn_oldest(True)
        elif steps.now[1] == steps.cells.shape[0] - 1:
            self.learn_oldest(False)

    def learn_oldest(self, terminated: bool) -> None:
        """Learn the oldest step that waits.

        Args:
            terminated: whether the newest step reached the goal.
        """
        steps = self.memory
        waiting, place = steps.now[1], steps.now[0]
        following, goal = self.values[steps.cells[place], steps.actions[place]], terminated
        for age in range(1, waiting):
            following = self.update.target(steps.rewards[steps.back(age)], following, goal)
            goal = False
        place = steps.back(waiting)
        cell, action, reward = steps.cells[place], steps.actions[place], steps.rewards[place]
        self.update.apply(self.values, self.visits, cell, action, reward, following, goal)
        steps.now[1] -= 1
