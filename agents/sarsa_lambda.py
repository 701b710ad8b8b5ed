"""Sarsa(lambda) with binary features: Sutton & Barto 2018, 12.7; Singh & Sutton 1996."""

from typing import Literal, Self

import numpy as np

from agents.contract import Observation, Task
from agents.features import Tiles, make_features
from agents.linear import Linear, common_parts, value_of
from agents.parameters import Count, Positive, Probability, validated
from agents.schedules import LinearDecay
from agents.traces import Kind, Traces


class SarsaLambda(Linear[Traces]):
    """On-policy control in which each error changes the values of the steps before, the latest the most."""

    __slots__ = ()

    @classmethod
    @validated
    def create(
        cls,
        task: Task,
        *,
        trace_decay: Probability = 0.9,
        traces: Literal["accumulating", "replacing"] = "replacing",
        clear_others: bool = False,
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
            traces: ``"accumulating"``: a visit adds 1; ``"replacing"``: it sets to 1.
            clear_others: whether a visit also removes the traces of the actions not taken there.
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
        kind = Kind[traces.upper()]
        return cls(*parts, Traces.of(parts[1], kind, discount * trace_decay, clear_others=clear_others))

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
