"""Expected SARSA on cells."""

import numpy as np

from agents.algorithms.tabular import Tabular, TabularAgent
from agents.contract import Floats, Observation
from agents.parameters.validation import extends


class ExpectedSarsa(TabularAgent[Floats]):
    """On-policy TD control that takes the mean over the next action, not the one that chance took.

    Attributes:
        memory: float64, shape (1,): the share of the training that is done, on which exploration depends.
    """

    __slots__ = ()
    name = "expected-sarsa"
    citation = "Expected SARSA: van Seijen et al. 2009; Sutton & Barto 2018, section 6.6."

    @classmethod
    @extends(Tabular.create)
    def create(cls, table: Tabular) -> "ExpectedSarsa":
        """The agent before it has learned anything; parameters as those of ``Tabular.create``."""
        return cls.with_memory(table, np.zeros(1))

    def act(self, observation: Observation, progress: float, rng: np.random.Generator) -> int:
        """What the exploration chooses in the observation's cell."""
        self.memory[0] = progress
        return self.policy.choose(self.values, self.visits, self.cells.encode(observation), progress, rng)

    def learn(
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        terminated: bool,
    ) -> None:
        """Towards the reward and the mean value of what the exploration does in the next cell."""
        cell, next_cell = self.cells.encode(observation), self.cells.encode(next_observation)
        next_value = self.policy.expected(self.values, self.visits, next_cell, self.memory[0])
        self.update.apply(self.values, self.visits, cell, action, reward, next_value, terminated)
