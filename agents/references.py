"""Two drivers that do not learn, to compare the others with."""

from typing import NamedTuple, Self

import numpy as np

from agents.contract import Observation, Task


class RandomAgent(NamedTuple):
    """Any action, all equally likely, always: the random walk of section 3.2 of the paper."""

    n_actions: int
    rng: np.random.Generator

    @classmethod
    def create(cls, task: Task, *, rng: np.random.Generator | None = None) -> Self:
        """The agent; ``rng`` chooses its actions when it is evaluated."""
        return cls(task.n_actions, rng or np.random.default_rng())

    def act(self, observation: Observation, progress: float, rng: np.random.Generator) -> int:
        """A random action."""
        return int(rng.random() * self.n_actions)

    def learn(
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        next_action: int,
        terminated: bool,
    ) -> None:
        """Nothing."""

    def greedy(self, observation: Observation) -> int:
        """A random action: the policy that is evaluated is the one that drove."""
        return int(self.rng.random() * self.n_actions)


class MomentumAgent(NamedTuple):
    """Thrust the way the car moves, right when it stands: energy grows with every step."""

    last_action: int

    @classmethod
    def create(cls, task: Task) -> Self:
        """The agent; it has no parameters."""
        return cls(task.n_actions - 1)

    def act(self, observation: Observation, progress: float, rng: np.random.Generator) -> int:
        """The same as ``greedy``."""
        return self.greedy(observation)

    def learn(
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        next_action: int,
        terminated: bool,
    ) -> None:
        """Nothing."""

    def greedy(self, observation: Observation) -> int:
        """Right for a velocity of at least 0, else left."""
        return self.last_action if observation[1] >= 0.0 else 0
