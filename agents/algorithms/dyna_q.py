"""Dyna-Q and Dyna-Q+: Sutton 1990; Sutton & Barto 2018, sections 8.2 and 8.3."""

import math
from typing import Annotated, Any, NamedTuple, Self

import numpy as np
from annotated_types import Ge
from numpy.typing import NDArray

from agents.algorithms.tabular import Tabular
from agents.contract import Observation, Task
from agents.learning.action_values import Counts, Table, best_action
from agents.parameters.declared import NonNegative, validated
from agents.parameters.inheritance import inherits


class Recollection(NamedTuple):
    """A deterministic model: what followed each action in each cell the last time.

    Attributes:
        rewards: float64, shape (cells, actions).
        next_cells: int64, shape (cells, actions).
        goals: bool, shape (cells, actions): whether it reached the goal.
        times: int64, shape (cells, actions): the step in which it was tried last.
        seen: int64, shape (cells * actions,): the pairs ``cell * actions + action`` that were tried.
        now: int64, shape (2,): how many pairs were tried, and the number of the step.
        planning: planned updates after each step.
        curiosity: kappa, weight of the bonus for pairs that were not tried for long.
        rng: draws the pairs to plan from.
    """

    rewards: Table
    next_cells: Counts
    goals: NDArray[np.bool_]
    times: Counts
    seen: Counts
    now: Counts
    planning: int
    curiosity: float
    rng: np.random.Generator

    def remember(
        self, visits: int, cell: int, action: int, reward: float, next_cell: int, terminated: bool
    ) -> None:
        """Keep what followed ``action`` in ``cell``, which was taken ``visits`` times, this one included."""
        if visits == 1:
            self.seen[self.now[0]] = cell * self.rewards.shape[1] + action
            self.now[0] += 1
        self.now[1] += 1
        self.times[cell, action] = self.now[1]
        self.rewards[cell, action] = reward
        self.next_cells[cell, action] = next_cell
        self.goals[cell, action] = terminated


class DynaQ(Tabular[Recollection]):
    """Q-learning that repeats, after each step, remembered steps of pairs drawn from all that were tried.

    The step size of a repeated update follows the visits of its pair, and does not count as one. With
    ``curiosity`` it is Dyna-Q+: repeated rewards are raised by ``curiosity * sqrt(steps since the pair
    was tried)``; pairs that were never tried are not planned with, for their initial value of 0 is
    hope enough.
    """

    __slots__ = ()

    @classmethod
    @validated
    @inherits(Tabular.create)
    def create(
        cls,
        task: Task,
        *,
        planning: Annotated[int, Ge(0)] = 5,
        curiosity: NonNegative = 0.0,
        rng: np.random.Generator | None = None,
        **inherited: Any,
    ) -> Self:
        """The agent before it has learned anything.

        Args:
            task: the hill.
            planning: repeated updates after each step; 0 is Q-learning.
            curiosity: kappa of Dyna-Q+.
            rng: draws the initial values, then the pairs to plan with.
            inherited: see ``Tabular.create``.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        rng = rng or np.random.default_rng()
        table: Tabular[None] = Tabular.create(task, rng=rng, **inherited)
        shape = table.values.shape
        next_cells, times = np.zeros((2, *shape), np.int64)
        seen, now = np.zeros(table.values.size, np.int64), np.zeros(2, np.int64)
        model = Recollection(
            np.zeros(shape), next_cells, np.zeros(shape, np.bool_), times, seen, now, planning, curiosity, rng
        )
        return cls(*table[:-1], model)

    def learn(
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        next_action: int,
        terminated: bool,
    ) -> None:
        """As Q-learning does, then remember the step and repeat others."""
        cell, next_cell = self.cells.encode(observation), self.cells.encode(next_observation)
        next_value = self.values[next_cell, best_action(self.values, next_cell)]
        self.update.apply(self.values, self.visits, cell, action, reward, next_value, terminated)
        self.memory.remember(self.visits[cell, action], cell, action, reward, next_cell, terminated)
        for _ in range(self.memory.planning):
            self.repeat()

    def repeat(self) -> None:
        """Learn from a remembered step as if it were taken again."""
        model, update = self.memory, self.update
        pair = model.seen[int(model.rng.random() * model.now[0])]
        cell, action = pair // self.values.shape[1], pair % self.values.shape[1]
        reward, next_cell, goal = (
            model.rewards[cell, action],
            model.next_cells[cell, action],
            model.goals[cell, action],
        )
        if model.curiosity > 0.0:
            reward += model.curiosity * math.sqrt(model.now[1] - model.times[cell, action])
        next_value = self.values[next_cell, best_action(self.values, next_cell)]
        target = update.target(reward, next_value, goal)
        rate = update.step_size.at(self.visits[cell, action])
        self.values[cell, action] += rate * (target - self.values[cell, action])
