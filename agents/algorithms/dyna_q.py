"""Dyna-Q and Dyna-Q+ on cells."""

import math
from typing import Annotated, NamedTuple

import numpy as np
from annotated_types import Ge
from numpy.typing import NDArray

from agents.algorithms.tabular import Tabular, TabularAgent
from agents.contract import Floats, Integers, Observation
from agents.learning.targets import greatest_value
from agents.parameters.declared import NonNegative
from agents.parameters.validation import extends


class Recollection(NamedTuple):
    """A deterministic model: what followed each action in each cell the last time.

    Attributes:
        rewards: float64, shape (cells, actions).
        next_cells: int64, shape (cells, actions).
        goals: bool, shape (cells, actions): whether it reached the goal.
        times: int64, shape (cells, actions): the step in which it was tried last.
        pairs: int64, shape (cells * actions,): the pairs ``cell * actions + action`` that were tried.
        n_pairs: int64, shape (1,): how many these are.
        clock: int64, shape (1,): the number of the step.
        planning: planned updates after each step.
        curiosity: kappa, weight of the bonus for pairs that were not tried for long.
        rng: draws the pairs to plan from.
    """

    rewards: Floats
    next_cells: Integers
    goals: NDArray[np.bool_]
    times: Integers
    pairs: Integers
    n_pairs: Integers
    clock: Integers
    planning: int
    curiosity: float
    rng: np.random.Generator

    def remember(
        self, visits: int, cell: int, action: int, reward: float, next_cell: int, terminated: bool
    ) -> None:
        """Keep what followed ``action`` in ``cell``, which was taken ``visits`` times, this one included."""
        if visits == 1:
            self.pairs[self.n_pairs[0]] = cell * self.rewards.shape[1] + action
            self.n_pairs[0] += 1
        self.clock[0] += 1
        self.times[cell, action] = self.clock[0]
        self.rewards[cell, action] = reward
        self.next_cells[cell, action] = next_cell
        self.goals[cell, action] = terminated


class DynaQ(TabularAgent[Recollection]):
    """Q-learning that repeats, after each step, remembered steps of pairs drawn from all that were tried.

    The step size of a repeated update follows the visits of its pair, and does not count as one. With
    ``curiosity`` it is Dyna-Q+: repeated rewards are raised by ``curiosity * sqrt(steps since the pair
    was tried)``; pairs that were never tried are not planned with, for their initial value of 0 is
    hope enough.
    """

    __slots__ = ()
    name = "dyna-q"
    citation = "Dyna-Q and Dyna-Q+: Sutton 1990; Sutton & Barto 2018, sections 8.2 and 8.3."

    @classmethod
    @extends(Tabular.create)
    def create(
        cls,
        table: Tabular,
        *,
        planning: Annotated[int, Ge(0)] = 5,
        curiosity: NonNegative = 0.0,
        rng: np.random.Generator | None = None,
    ) -> "DynaQ":
        """The agent before it has learned anything.

        Args:
            table: see ``Tabular.create``.
            planning: repeated updates after each step; 0 is Q-learning.
            curiosity: kappa of Dyna-Q+.
            rng: draws the initial values, then the pairs to plan with.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        shape, size = table.values.shape, table.values.size
        model = Recollection(
            rewards=np.zeros(shape),
            next_cells=np.zeros(shape, np.int64),
            goals=np.zeros(shape, np.bool_),
            times=np.zeros(shape, np.int64),
            pairs=np.zeros(size, np.int64),
            n_pairs=np.zeros(1, np.int64),
            clock=np.zeros(1, np.int64),
            planning=planning,
            curiosity=curiosity,
            rng=rng or np.random.default_rng(),
        )
        return cls.with_memory(table, model)

    def learn(
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        terminated: bool,
    ) -> None:
        """As Q-learning does, then remember the step and repeat others."""
        cell, next_cell = self.cells.encode(observation), self.cells.encode(next_observation)
        next_value = greatest_value(self.values, next_cell)
        self.update.apply(self.values, self.visits, cell, action, reward, next_value, terminated)
        self.memory.remember(self.visits[cell, action], cell, action, reward, next_cell, terminated)
        for _ in range(self.memory.planning):
            self.repeat()

    def repeat(self) -> None:
        """Learn from a remembered step as if it were taken again."""
        model, update = self.memory, self.update
        pair = model.pairs[int(model.rng.random() * model.n_pairs[0])]
        cell, action = pair // self.values.shape[1], pair % self.values.shape[1]
        reward = model.rewards[cell, action]
        if model.curiosity > 0.0:
            reward += model.curiosity * math.sqrt(model.clock[0] - model.times[cell, action])
        next_value = greatest_value(self.values, model.next_cells[cell, action])
        target = update.target(reward, next_value, model.goals[cell, action])
        rate = update.step_size.at(self.visits[cell, action])
        self.values[cell, action] += rate * (target - self.values[cell, action])
