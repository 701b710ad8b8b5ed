"""Q-learning on cells."""

from agents.algorithms.tabular import Tabular
from agents.contract import Observation
from agents.learning.targets import greatest_value


class QLearning(Tabular):
    """Off-policy TD control on a grid: learns the value of acting greedily next."""

    __slots__ = ()
    name = "q-learning"
    citation = "Q-learning: Eq. (16) of the paper; Watkins 1989; Sutton & Barto 2018, section 6.5."

    def learn(
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        terminated: bool,
    ) -> None:
        """Towards the reward and the best value of the next cell."""
        cell, next_cell = self.cells.encode(observation), self.cells.encode(next_observation)
        next_value = greatest_value(self.values, next_cell)
        self.update.apply(self.values, self.visits, cell, action, reward, next_value, terminated)
