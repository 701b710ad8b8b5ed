"""R-MAX on cells."""

from typing import NamedTuple

import numpy as np

from agents.algorithms.tabular import OF_THE_UPDATE, Tabular, TabularAgent
from agents.contract import Floats, Integers, Observation
from agents.models.cell_model import CellModel
from agents.parameters.declared import Count, NonNegative
from agents.parameters.validation import extends


class Knowledge(NamedTuple):
    """What R-MAX keeps beside the table.

    Attributes:
        model: what was seen.
        state_values: float64, shape (cells + 1,): the best value of each cell; that of the goal is 0.
        known: visits that make an action in a cell known.
        sweeps: of value iteration at most, each time something is learned.
        tolerance: change of all state values that ends value iteration.
        cells: int64, shape (cells,): those in which something is known, in the order of finding out.
        n_cells: int64, shape (1,): how many these are.
    """

    model: CellModel
    state_values: Floats
    known: int
    sweeps: int
    tolerance: float
    cells: Integers
    n_cells: Integers


class RMax(TabularAgent[Knowledge]):
    """Takes what it does not know for the best there is, so that to act greedily is to explore.

    An action is known in a cell after ``known`` visits; then the values of all that is known are
    computed from the counts by value iteration. The paper stops counting there. That suits states, but
    in cells, where it matters how the car came in, it would settle for the chance of a few visits and
    may circle for ever: here counting goes on, and values are computed anew each time that the visits
    of a pair have doubled (as in UCRL2, Jaksch et al. 2010).
    """

    __slots__ = ()
    name = "r-max"
    citation = "R-MAX: Brafman & Tennenholtz 2002."

    @classmethod
    @extends(Tabular.create, omit=(*OF_THE_UPDATE, "epsilon", "explore", "initial_values"), epsilon=0.0)
    def create(
        cls,
        table: Tabular,
        *,
        known: Count = 5,
        greatest_return: float = 0.0,
        sweeps: Count = 100,
        tolerance: NonNegative = 0.01,
    ) -> "RMax":
        """The agent before it has learned anything.

        Args:
            table: see ``Tabular.create``.
            known: visits that make an action in a cell known.
            greatest_return: value of what is not known; no return can be greater. The hill's rewards
                of -1 leave 0.
            sweeps: of value iteration at most, each time something is learned.
            tolerance: value iteration ends when no state value changes by more.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        table.values.fill(greatest_return)
        model = CellModel.empty(*table.values.shape)
        state_values = np.append(table.values.max(axis=1), 0.0)
        cells, n_cells = np.zeros(table.cells.size, np.int64), np.zeros(1, np.int64)
        knowledge = Knowledge(model, state_values, known, sweeps, tolerance, cells, n_cells)
        return cls.with_memory(table, knowledge)

    def learn(
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        terminated: bool,
    ) -> None:
        """Count the step; compute all values where it completes what makes a difference."""
        memory, cell = self.memory, self.cells.encode(observation)
        successor = self.values.shape[0] if terminated else self.cells.encode(next_observation)
        memory.model.observe(cell * self.values.shape[1] + action, reward, successor)
        self.visits[cell, action] += 1
        times = self.visits[cell, action] // memory.known
        if times * memory.known == self.visits[cell, action] and times & (times - 1) == 0:
            self.note(cell)
            sweeps = 0
            while sweeps < memory.sweeps and self.sweep() > memory.tolerance:
                sweeps += 1

    def note(self, cell: int) -> None:
        """Put a cell of which something is known on the list, if it is not there."""
        memory = self.memory
        for place in range(memory.n_cells[0]):
            if memory.cells[place] == cell:
                return
        memory.cells[memory.n_cells[0]] = cell
        memory.n_cells[0] += 1

    def sweep(self) -> float:
        """Sweep once, in place (Gauss-Seidel), and return the greatest change of a state value.

        The newest cells come first: the way there led through the older ones, whose values follow.
        """
        memory, greatest = self.memory, 0.0
        for place in range(memory.n_cells[0] - 1, -1, -1):
            cell, discount = memory.cells[place], self.update.discount
            change = memory.model.backup(
                self.values, self.visits, memory.state_values, cell, memory.known, discount
            )
            greatest = max(greatest, change)
        return greatest
