"""Double Q-learning on cells."""

from copy import deepcopy
from typing import NamedTuple

import numpy as np

from agents.algorithms.tabular import Tabular, TabularAgent
from agents.contract import Floats, Integers, Observation
from agents.learning.targets import double_value
from agents.learning.updates import Update
from agents.parameters.validation import extends


class Twin(NamedTuple):
    """One of the two tables, with the visits in which it learned, shape (cells, actions) each."""

    values: Floats
    visits: Integers
    update: Update


class Twins(NamedTuple):
    """Both tables, and the coin that says which of them learns."""

    first: Twin
    second: Twin
    coin: np.random.Generator


class DoubleQLearning(TabularAgent[Twins]):
    """Off-policy TD control without the bias of taking the greatest of uncertain values.

    Of two tables a coin chooses one to learn: it says which next action is the best, the other one
    what that is worth. Step sizes follow the visits in which the table itself learned. ``values``, by
    which the agent drives, is the mean of both tables, which rank actions as their sum does;
    ``visits`` counts all visits.
    """

    __slots__ = ()
    name = "double-q-learning"
    citation = "Double Q-learning: van Hasselt 2010; Sutton & Barto 2018, section 6.7."

    @classmethod
    @extends(Tabular.create)
    def create(cls, table: Tabular, *, rng: np.random.Generator | None = None) -> "DoubleQLearning":
        """The agent before it has learned anything; both tables begin with the same values.

        Args:
            table: see ``Tabular.create``.
            rng: draws the initial values, then tosses the coin.
        """
        parts = table.values, table.visits, table.update
        first, second = Twin(*deepcopy(parts)), Twin(*deepcopy(parts))
        return cls.with_memory(table, Twins(first, second, rng or np.random.default_rng()))

    def begin_episode(self) -> None:
        """Let the updates count episodes."""
        self.memory.first.update.begin_episode()
        self.memory.second.update.begin_episode()

    def learn(
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        terminated: bool,
    ) -> None:
        """In one table, towards the reward and the other's value of what the one deems best."""
        cell, next_cell = self.cells.encode(observation), self.cells.encode(next_observation)
        first, second = self.memory.first, self.memory.second
        learner, judge = (first, second) if self.memory.coin.random() < 0.5 else (second, first)
        next_value = double_value(learner.values, judge.values, next_cell)
        learner.update.apply(learner.values, learner.visits, cell, action, reward, next_value, terminated)
        self.values[cell, action] = 0.5 * (first.values[cell, action] + second.values[cell, action])
        self.visits[cell, action] += 1
