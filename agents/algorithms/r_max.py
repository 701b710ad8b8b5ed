"""R-MAX: Brafman & Tennenholtz 2002."""

from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from agents.algorithms.tabular import OF_THE_UPDATE, Tabular
from agents.contract import Observation, Task
from agents.learning.action_values import Counts
from agents.models.cell_model import CellModel
from agents.parameters.declared import Count, NonNegative, validated
from agents.parameters.inheritance import inherits


class Knowledge(NamedTuple):
    """What R-MAX keeps beside the table.

    Attributes:
        model: what was seen.
        worth: float64, shape (cells + 1,): the best value of each cell; that of the goal is 0.
        known: visits that make an action in a cell known.
        sweeps: of value iteration at most, each time something is learned.
        tolerance: change of all worths that ends value iteration.
        cells: int64, shape (cells,): those in which something is known, in the order of finding out.
        found: int64, shape (1,): how many these are.
    """

    model: CellModel
    worth: NDArray[np.float64]
    known: int
    sweeps: int
    tolerance: float
    cells: Counts
    found: Counts


class RMax(Tabular[Knowledge]):
    """Takes what it does not know for the best there is, so that to act greedily is to explore.

    An action is known in a cell after ``known`` visits; then the values of all that is known are
    computed from the counts by value iteration. The paper stops counting there. That suits states, but
    in cells, where it matters how the car came in, it would settle for the chance of a few visits and
    may circle for ever: here counting goes on, and values are computed anew each time that the visits
    of a pair have doubled (as in UCRL2, Jaksch et al. 2010).
    """

    __slots__ = ()

    @classmethod
    @validated
    @inherits(Tabular.create, omit=(*OF_THE_UPDATE, "epsilon", "explore", "initial_values"))
    def create(
        cls,
        task: Task,
        *,
        known: Count = 5,
        greatest_return: float = 0.0,
        sweeps: Count = 100,
        tolerance: NonNegative = 0.01,
        rng: np.random.Generator | None = None,
        **inherited: Any,
    ) -> Self:
        """The agent before it has learned anything.

        Args:
            task: the hill.
            known: visits that make an action in a cell known.
            greatest_return: value of what is not known; no return can be greater. The hill's rewards
                of -1 leave 0.
            sweeps: of value iteration at most, each time something is learned.
            tolerance: value iteration ends when no worth changes by more.
            rng: for cells that are drawn.
            inherited: see ``Tabular.create``.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        table: Tabular[None] = Tabular.create(
            task, epsilon=0.0, initial_values=greatest_return, rng=rng, **inherited
        )
        cells, actions = table.values.shape
        worth = np.append(table.values.max(axis=1), 0.0)
        model, room, found = (
            CellModel.of_size(cells, actions),
            np.zeros(cells, np.int64),
            np.zeros(1, np.int64),
        )
        return cls(*table[:-1], Knowledge(model, worth, known, sweeps, tolerance, room, found))

    def learn(
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        next_action: int,
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
        for place in range(memory.found[0]):
            if memory.cells[place] == cell:
                return
        memory.cells[memory.found[0]] = cell
        memory.found[0] += 1

    def sweep(self) -> float:
        """A sweep of value iteration in place (Gauss-Seidel); the greatest change of a worth.

        The newest cells come first: the way there led through the older ones, whose worth follows.
        """
        memory, greatest = self.memory, 0.0
        for place in range(memory.found[0] - 1, -1, -1):
            change = memory.model.back_up(
                self.values,
                self.visits,
                memory.worth,
                memory.cells[place],
                memory.known,
                self.update.discount,
            )
            greatest = max(greatest, change)
        return greatest
