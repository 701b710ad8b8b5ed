"""Sarsa(lambda) with binary features: Sutton & Barto 2018, 12.7; Singh & Sutton 1996."""

from typing import Any, Literal, Self

import numpy as np

from agents.algorithms.linear import Linear, value_of
from agents.contract import Observation, Task
from agents.learning.traces import Kind, Traces
from agents.parameters.declared import Probability, validated
from agents.parameters.inheritance import inherits


class SarsaLambda(Linear[Traces]):
    """On-policy control in which each error changes the values of the steps before, the latest the most."""

    __slots__ = ()

    @classmethod
    @validated
    @inherits(Linear.create)
    def create(
        cls,
        task: Task,
        *,
        trace_decay: Probability = 0.9,
        traces: Literal["accumulating", "replacing"] = "replacing",
        clear_others: bool = False,
        rng: np.random.Generator | None = None,
        **inherited: Any,
    ) -> Self:
        """The agent before it has learned anything.

        Args:
            task: the hill.
            trace_decay: lambda, in [0, 1].
            traces: ``"accumulating"``: a visit adds 1; ``"replacing"``: it sets to 1.
            clear_others: whether a visit also removes the traces of the actions not taken there.
            rng: for cells that are learned.
            inherited: see ``Linear.create``.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        table: Linear[None] = Linear.create(task, rng=rng, **inherited)
        kind, decay = Kind[traces.upper()], table.discount * trace_decay
        return cls(*table[:-1], Traces.of(table.weights, kind, decay, clear_others=clear_others))

    def begin_episode(self) -> None:
        """Forget the traces of the episode before."""
        self.memory.clear()

    def learn(
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        next_action: int,
        terminated: bool,
    ) -> None:
        """Towards the reward and the value of the next action, in proportion to the traces."""
        here, there = self.scratch
        self.features.fill(observation, here)
        target = reward
        if not terminated:
            self.features.fill(next_observation, there)
            target += self.discount * value_of(self.weights, there, next_action)
        error = target - value_of(self.weights, here, action)
        self.memory.visit(here, action, self.step_size)
        self.memory.learn(self.weights, self.step_size * error)
