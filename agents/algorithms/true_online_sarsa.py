"""True online Sarsa(lambda) with binary features."""

from typing import NamedTuple

import numpy as np

from agents.algorithms.linear import Linear, LinearAgent, add, value_of
from agents.contract import Floats, Observation
from agents.learning.targets import bootstrapped
from agents.learning.traces import TraceKind, Traces
from agents.parameters.declared import Probability
from agents.parameters.validation import extends


class Memory(NamedTuple):
    """Dutch traces, and the value that the last step gave to where it led, float64, shape (1,)."""

    traces: Traces
    old: Floats


class TrueOnlineSarsa(LinearAgent[Memory]):
    """On-policy control whose values are, after each step, those of the online lambda-return algorithm."""

    __slots__ = ()
    name = "true-online-sarsa"
    citation = "True online Sarsa(lambda): van Seijen & Sutton 2014; Sutton & Barto 2018, 12.7."

    @classmethod
    @extends(Linear.create)
    def create(cls, linear: Linear, *, trace_decay: Probability = 0.9) -> "TrueOnlineSarsa":
        """The agent before it has learned anything.

        Args:
            linear: see ``Linear.create``.
            trace_decay: lambda, in [0, 1].

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        traces = Traces.of(linear.weights, TraceKind.DUTCH, linear.discount * trace_decay)
        return cls.with_memory(linear, Memory(traces, np.zeros(1)))

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
        error = bootstrapped(reward, self.discount, next_value) - value
        traces.visit(here, action, self.step_size)
        traces.learn(self.weights, self.step_size * (error + value - old[0]))
        add(self.weights, here, action, -self.step_size * (value - old[0]))
        old[0] = next_value
