"""SARSA on cells."""

from agents.algorithms.tabular import Tabular
from agents.contract import Observation


class Sarsa(Tabular):
    """On-policy TD control on a grid: learns the value of what it does next, exploration included."""

    __slots__ = ()
    name = "sarsa"
    citation = "SARSA: Eq. (17) of the paper; Rummery & Niranjan 1994; Sutton & Barto 2018, section 6.4."

    def learn(
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        next_action: int,
        terminated: bool,
    ) -> None:
        """Towards the reward and the value of the next action in the next cell."""
        cell, next_cell = self.cells.encode(observation), self.cells.encode(next_observation)
        next_value = self.values[next_cell, next_action]
        self.update.apply(self.values, self.visits, cell, action, reward, next_value, terminated)
