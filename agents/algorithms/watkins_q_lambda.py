"""Watkins's Q(lambda) with binary features: Watkins 1989; Sutton & Barto 1998, 7.6 and 8.3; 2018, 12.10."""

from typing import Any, Literal, Self

import numpy as np

from agents.algorithms.linear import Linear, best_action_of, value_of
from agents.contract import Observation, Task
from agents.learning.traces import Kind, Traces
from agents.parameters.declared import Probability, validated
from agents.parameters.inheritance import inherits


class WatkinsQLambda(Linear[Traces]):
    """Off-policy control: errors reach back as far as the actions since were greedy.

    An action that is as good as the best one is greedy.
    """

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
        rng: np.random.Generator | None = None,
        **inherited: Any,
    ) -> Self:
        """The agent before it has learned anything.

        Args:
            task: the hill.
            trace_decay: lambda, in [0, 1].
            traces: ``"accumulating"``: a visit adds 1; ``"replacing"``: it sets to 1.
            rng: for cells that are learned.
            inherited: see ``Linear.create``.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        table: Linear[None] = Linear.create(task, rng=rng, **inherited)
        kind, decay = Kind[traces.upper()], table.discount * trace_decay
        return cls(*table[:-1], Traces.of(table.weights, kind, decay))

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
        """Towards the reward and the best next value; then cut the traces if the next action explores."""
        here, there = self.scratch
        self.features.fill(observation, here)
        target, explores = reward, False
        if not terminated:
            self.features.fill(next_observation, there)
            best = value_of(self.weights, there, best_action_of(self.weights, there))
            explores = value_of(self.weights, there, next_action) < best
            target += self.discount * best
        error = target - value_of(self.weights, here, action)
        self.memory.visit(here, action, self.step_size)
        self.memory.learn(self.weights, self.step_size * error)
        if explores:
            self.memory.clear()
