"""Semi-gradient n-step Sarsa: Sutton & Barto 2018, 10.1 (n = 1) and 10.2."""

from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from agents.algorithms.linear import Linear, add, value_of
from agents.contract import Observation, Task
from agents.parameters.declared import Count, validated
from agents.parameters.inheritance import inherits


class Steps(NamedTuple):
    """The last n steps, in a ring of n + 1 places; the last place is that of the next observation.

    Attributes:
        active: int64, shape (n + 1, active features): where each step began.
        actions: int64, shape (n + 1,).
        rewards: float64, shape (n + 1,): what each step brought.
        now: int64, shape (2,): the place of the step to come, and how many steps are not learned yet.
    """

    active: NDArray[np.int64]
    actions: NDArray[np.int64]
    rewards: NDArray[np.float64]
    now: NDArray[np.int64]


class SemiGradientSarsa(Linear[Steps]):
    """On-policy control that learns from the n next rewards and the value of what follows them.

    The step n - 1 before the current one is learned; at the goal all that wait. Those that wait when a
    time limit ends an episode are learned when the next begins, from the rewards there were and the
    value of the last observation and the action chosen there. After an episode without a next, the
    last one of the training, they stay unlearned: up to n - 1 steps.
    """

    __slots__ = ()

    @classmethod
    @validated
    @inherits(Linear.create)
    def create(
        cls,
        task: Task,
        *,
        n: Count = 1,
        rng: np.random.Generator | None = None,
        **inherited: Any,
    ) -> Self:
        """The agent before it has learned anything.

        Args:
            task: the hill.
            n: steps until an estimated value takes the place of rewards.
            rng: for cells that are learned.
            inherited: see ``Linear.create``.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        table: Linear[None] = Linear.create(task, rng=rng, **inherited)
        steps = Steps(
            np.zeros((n + 1, table.features.active), np.int64),
            np.zeros(n + 1, np.int64),
            np.zeros(n + 1),
            np.zeros(2, np.int64),
        )
        return cls(*table[:-1], steps)

    def begin_episode(self) -> None:
        """Learn what a time limit left over."""
        steps = self.memory
        last = steps.now[0]
        while steps.now[1] > 0:
            self.learn_oldest(value_of(self.weights, steps.active[last], steps.actions[last]))

    def learn(
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        next_action: int,
        terminated: bool,
    ) -> None:
        """Remember this step, learn the one n - 1 before it."""
        steps = self.memory
        here = steps.now[0]
        there = here + 1 if here + 1 < steps.rewards.shape[0] else 0
        self.features.fill(observation, steps.active[here])
        self.features.fill(next_observation, steps.active[there])
        steps.actions[here], steps.actions[there] = action, next_action
        steps.rewards[here] = reward
        steps.now[0] = there
        steps.now[1] += 1
        if terminated:
            while steps.now[1] > 0:
                self.learn_oldest(0.0)
        elif steps.now[1] == steps.rewards.shape[0] - 1:
            self.learn_oldest(value_of(self.weights, steps.active[there], next_action))

    def learn_oldest(self, following: float) -> None:
        """Learn the oldest step that waits.

        Args:
            following: value of what follows the newest step.
        """
        steps = self.memory
        place, target = steps.now[0], following
        for _ in range(steps.now[1]):
            place = place - 1 if place > 0 else steps.rewards.shape[0] - 1
            target = steps.rewards[place] + self.discount * target
        active, action = steps.active[place], steps.actions[place]
        change = self.step_size * (target - value_of(self.weights, active, action))
        add(self.weights, active, action, change)
        steps.now[1] -= 1
