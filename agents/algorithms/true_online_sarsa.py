"""True online Sarsa(lambda): van Seijen & Sutton 2014; Sutton & Barto 2018, 12.7."""

from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from agents.algorithms.linear import Linear, add, value_of
from agents.contract import Observation, Task
from agents.learning.traces import Kind, Traces
from agents.parameters.declared import Probability, validated
from agents.parameters.inheritance import inherits


class Memory(NamedTuple):
    """Dutch traces, and the value that the last step gave to where it led, float64, shape (1,)."""

    traces: Traces
    old: NDArray[np.float64]


class TrueOnlineSarsa(Linear[Memory]):
    """On-policy control whose values are, after each step, those of the online lambda-return algorithm."""

    __slots__ = ()

    @classmethod
    @validated
    @inherits(Linear.create)
    def create(
        cls,
        task: Task,
        *,
        trace_decay: Probability = 0.9,
        rng: np.random.Generator | None = None,
        **inherited: Any,
    ) -> Self:
        """The agent before it has learned anything.

        Args:
            task: the hill.
            trace_decay: lambda, in [0, 1].
            rng: for cells that are learned.
            inherited: see ``Linear.create``.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        table: Linear[None] = Linear.create(task, rng=rng, **inherited)
        traces = Traces.of(table.weights, Kind.DUTCH, table.discount * trace_decay)
        return cls(*table[:-1], Memory(traces, np.zeros(1)))

    def begin_episode(self) -> None:
        """Forget the episode before."""
        self.memory.traces.clear()
        self.memory.old[0] = 0.0

    def learn(
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        next_action: int,
        terminated: bool,
    ) -> None:
        """The box of the book's section 12.7, line by line."""
        (here, there), (traces, old) = self.scratch, self.memory
        self.features.fill(observation, here)
        value, next_value = value_of(self.weights, here, action), 0.0
        if not terminated:
            self.features.fill(next_observation, there)
            next_value = value_of(self.weights, there, next_action)
        error = reward + self.discount * next_value - value
        traces.visit(here, action, self.step_size)
        traces.learn(self.weights, self.step_size * (error + value - old[0]))
        add(self.weights, here, action, -self.step_size * (value - old[0]))
        old[0] = next_value
