"""Drivers that do not learn, to compare the others with."""

from typing import NamedTuple, Self

import numpy as np

from agents.contract import Observation, Task

_BASELINE = "Drivers that do not learn, to compare the others with."


class DoesNotLearn:
    """Mixin of a named tuple that always drives as ``greedy`` says."""

    __slots__ = ()

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
        """What to do."""
        raise NotImplementedError


class _Chance(NamedTuple):
    n_actions: int
    rng: np.random.Generator


class RandomAgent(DoesNotLearn, _Chance):
    """Any action, all equally likely, always: the random walk of section 3.2 of the paper."""

    __slots__ = ()
    name, citation = "random", _BASELINE

    @classmethod
    def create(cls, task: Task, *, rng: np.random.Generator | None = None) -> Self:
        """The agent; ``rng`` chooses its actions when it is evaluated."""
        return cls(task.n_actions, rng or np.random.default_rng())

    def act(self, observation: Observation, progress: float, rng: np.random.Generator) -> int:
        """A random action."""
        return int(rng.random() * self.n_actions)

    def greedy(self, observation: Observation) -> int:
        """A random action: the policy that is evaluated is the one that drove."""
        return int(self.rng.random() * self.n_actions)


class _LastAction(NamedTuple):
    last_action: int


class FixedAgent(DoesNotLearn, _LastAction):
    """Knows how many actions there are, and nothing else."""

    __slots__ = ()

    @classmethod
    def create(cls, task: Task) -> Self:
        """The agent; it has no parameters."""
        return cls(task.n_actions - 1)


class MomentumAgent(FixedAgent):
    """Thrust the way the car moves, right when it stands: energy grows with every step."""

    __slots__ = ()
    name, citation = "momentum", _BASELINE

    def greedy(self, observation: Observation) -> int:
        """Right for a velocity of at least 0, else left."""
        return self.last_action if observation[1] >= 0.0 else 0


class XiaoAgent(FixedAgent):
    """Thrust right between two curves of the velocity over the position, else left; never none.

    The closed form of Zhiqing Xiao on the Gymnasium leaderboard: 105.75 steps on average, over
    100,000 episodes of ``MountainCar-v0``; the curves are made for that hill.
    """

    __slots__ = ()
    name, citation = "xiao", _BASELINE

    def greedy(self, observation: Observation) -> int:
        """Right if the velocity is between the curves."""
        x, v = observation[0], observation[1]
        # Products in place of powers: compiled and interpreted, they are the same bits.
        low, steep, high = (x + 0.25) * (x + 0.25), (x + 0.9) * (x + 0.9), (x + 0.38) * (x + 0.38)
        least = min(-0.09 * low + 0.03, 0.3 * steep * steep - 0.008)
        return self.last_action if least < v < -0.07 * high + 0.07 else 0
