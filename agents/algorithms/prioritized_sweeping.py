"""Prioritized sweeping on cells."""

from typing import Annotated, NamedTuple

import numpy as np
from annotated_types import Ge

from agents.algorithms.tabular import OF_THE_UPDATE, Tabular, TabularAgent
from agents.contract import Floats, Observation
from agents.models.cell_model import SUCCESSORS, CellModel
from agents.models.priority_queue import PriorityQueue
from agents.parameters.declared import NonNegative
from agents.parameters.validation import extends


class Plan(NamedTuple):
    """What prioritized sweeping keeps beside the table.

    Attributes:
        model: what was seen.
        queue: the cells to sweep, by how much that may change them.
        state_values: float64, shape (cells + 1,): the best value of each cell; that of the goal is 0.
        planning: cells that are swept after each step, beside the one it began in.
        threshold: the least priority that is worth a sweep.
    """

    model: CellModel
    queue: PriorityQueue
    state_values: Floats
    planning: int
    threshold: float


class PrioritizedSweeping(TabularAgent[Plan]):
    """Counts what leads where, computes values from that, and first where they change most.

    A sweep of a cell sets the values of the actions tried in it to what the counts let expect. When
    the best of them changes, all cells that lead there are queued, by the change times the probability
    of going there. Values of actions that were never tried stay the initial ones.
    """

    __slots__ = ()
    name = "prioritized-sweeping"
    citation = "Prioritized sweeping: Moore & Atkeson 1993; Sutton & Barto 2018, section 8.4."

    @classmethod
    @extends(Tabular.create, omit=OF_THE_UPDATE)
    def create(
        cls, table: Tabular, *, planning: Annotated[int, Ge(0)] = 10, threshold: NonNegative = 0.01
    ) -> "PrioritizedSweeping":
        """The agent before it has learned anything.

        Args:
            table: see ``Tabular.create``.
            planning: sweeps after each step, beside that of the cell it began in.
            threshold: the least change, times its probability, that is worth a sweep.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        model, queue = CellModel.empty(*table.values.shape), PriorityQueue.empty(table.cells.size)
        state_values = np.append(table.values.max(axis=1), 0.0)
        return cls.with_memory(table, Plan(model, queue, state_values, planning, threshold))

    def learn(
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
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
        change = plan.model.backup(self.values, self.visits, plan.state_values, cell, 1, discount)
        link = plan.model.first[cell] if change > plan.threshold else -1
        while link >= 0:
            pair, place = link // SUCCESSORS, link % SUCCESSORS
            priority = change * plan.model.counts[pair, place] / plan.model.tries[pair]
            if priority > max(plan.threshold, plan.queue.priorities[pair // actions]):
                plan.queue.put(pair // actions, priority)
            link = plan.model.next_link[link]
