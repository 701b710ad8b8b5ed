"""True online Sarsa(lambda): van Seijen & Sutton 2014; Sutton & Barto 2018, 12.7."""

from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from agents.contract import Observation, Task
from agents.features import Tiles, make_features
from agents.linear import Linear, add, common_parts, value_of
from agents.parameters import Count, Positive, Probability, validated
from agents.schedules import LinearDecay
from agents.traces import Kind, Traces


class Memory(NamedTuple):
    """Dutch traces, and the value that the last step gave to where it led, float64, shape (1,)."""

    traces: Traces
    old: NDArray[np.float64]


class TrueOnlineSarsa(Linear[Memory]):
    """On-policy control whose values are, after each step, those of the online lambda-return algorithm."""

    __slots__ = ()

    @classmethod
    @validated
    def create(
        cls,
        task: Task,
        *,
        trace_decay: Probability = 0.9,
        tilings: Count = 8,
        tiles: Tiles = 8,
        bins: Tiles | None = None,
        step_size: Positive = 0.5,
        discount: Probability = 1.0,
        epsilon: LinearDecay | Probability = LinearDecay(0.0, 0.0),  # noqa: B008 (immutable)
        rng: np.random.Generator | None = None,
    ) -> Self:
        """The agent before it has learned anything.

        Args:
            task: the hill.
            trace_decay: lambda, in [0, 1].
            tilings: number of displaced grids of tiles.
            tiles: tiles of each along the range of each dimension.
            bins: cells of a uniform grid in place of tiles.
            step_size: alpha times the number of active features: 0.5 is the book's 0.5/8.
            discount: gamma, in [0, 1].
            epsilon: share of random actions; 0 explores as well, for weights of 0 are optimistic.
            rng: for features that are drawn.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        parts = common_parts(
            task, make_features(task, tilings, tiles, bins, rng), step_size, discount, epsilon
        )
        return cls(*parts, Memory(Traces.of(parts[1], Kind.DUTCH, discount * trace_decay), np.zeros(1)))

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
