"""Prioritized sweeping: Moore & Atkeson 1993; Sutton & Barto 2018, section 8.4."""

from typing import Annotated, Any, NamedTuple, Self

import numpy as np
from annotated_types import Ge
from numpy.typing import NDArray

from agents.algorithms.tabular import OF_THE_UPDATE, Tabular
from agents.contract import Observation, Task
from agents.models.cell_model import SUCCESSORS, CellModel
from agents.models.priority_queue import PriorityQueue
from agents.parameters.declared import NonNegative, validated
from agents.parameters.inheritance import inherits


class Plan(NamedTuple):
    """What prioritized sweeping keeps beside the table.

    Attributes:
        model: what was seen.
        queue: the cells to sweep, by how much that may change them.
        worth: float64, shape (cells + 1,): the best value of each cell; that of the goal is 0.
        planning: cells that are swept after each step, beside the one it began in.
        threshold: the least priority that is worth a sweep.
    """

    model: CellModel
    queue: PriorityQueue
    worth: NDArray[np.float64]
    planning: int
    threshold: float


class PrioritizedSweeping(Tabular[Plan]):
    """Counts what leads where, computes values from that, and first where they change most.

    A sweep of a cell sets the values of the actions tried in it to what the counts let expect. When
    the best of them changes, all cells that lead there are queued, by the change times the probability
    of going there. Values of actions that were never tried stay the initial ones.
    """

    __slots__ = ()

    @classmethod
    @validated
    @inherits(Tabular.create, omit=OF_THE_UPDATE)
    def create(
        cls,
        task: Task,
        *,
        planning: Annotated[int, Ge(0)] = 10,
        threshold: NonNegative = 0.01,
        rng: np.random.Generator | None = None,
        **inherited: Any,
    ) -> Self:
        """The agent before it has learned anything.

        Args:
            task: the hill.
            planning: sweeps after each step, beside that of the cell it began in.
            threshold: the least change, times its probability, that is worth a sweep.
            rng: draws the initial values.
            inherited: see ``Tabular.create``.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        table: Tabular[None] = Tabular.create(task, rng=rng, **inherited)
        cells, actions = table.values.shape
        model, queue = CellModel.of_size(cells, actions), PriorityQueue.of_size(cells)
        worth = np.append(table.values.max(axis=1), 0.0)
        return cls(*table[:-1], Plan(model, queue, worth, planning, threshold))

    def learn(
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        next_action: int,
        terminated: bool,
    ) -> None:
        """Count the step, then sweep its cell and those that head the queue."""
        plan, cell = self.memory, self.cells.encode(observation)
        successor = self.values.shape[0] if terminated else self.cells.encode(next_observation)
        plan.model.observe(cell * self.values.shape[1] + action, reward, successor)
        self.visits[cell, action] += 1
        self.sweep(cell)
        sweeps = 0
        while sweeps < plan.planning and plan.queue.length[0] > 0:
            self.sweep(plan.queue.pop())
            sweeps += 1

    def sweep(self, cell: int) -> None:
        """Compute the values of ``cell`` from the model; queue the cells that lead to it."""
        plan, actions = self.memory, self.values.shape[1]
        discount = self.update.discount
        change = plan.model.back_up(self.values, self.visits, plan.worth, cell, 1, discount)
        link = plan.model.first[cell] if change > plan.threshold else -1
        while link >= 0:
            pair, place = link // SUCCESSORS, link % SUCCESSORS
            priority = change * plan.model.counts[pair, place] / plan.model.tries[pair]
            if priority > max(plan.threshold, plan.queue.priorities[pair // actions]):
                plan.queue.put(pair // actions, priority)
            link = plan.model.following[link]
