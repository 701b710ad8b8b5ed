"""Eligibility traces of linear agents, kept only where not negligible (Sutton & Barto 2018, chapter 12)."""

from enum import IntEnum
from typing import NamedTuple, Self

import numpy as np

from agents.contract import Floats, Integers

NEGLIGIBLE = 1e-8
"""A smaller trace becomes 0; with a decay of 0.9 that is 175 steps after the last visit. The weight is
then left where the next error would have moved it by less than 1e-8 of its step at a visit."""


class TraceKind(IntEnum):
    """What a visit does to the traces of the action taken."""

    ACCUMULATING = 0
    """They grow by 1."""
    REPLACING = 1
    """They become 1 (Singh & Sutton 1996)."""
    DUTCH = 2
    """They grow by 1 - alpha * their sum (van Seijen & Sutton 2014)."""


class Traces(NamedTuple):
    """Traces of weights of shape (features, actions): a list of those that are not 0.

    Attributes:
        kind: what a visit does.
        clear_others: whether it also removes the traces of the actions not taken.
        decay: discount times lambda: what becomes of the traces in each step.
        n_actions: weights are numbered row by row: feature * n_actions + action.
        positions: int64, shape (weights,): where in the list a weight's trace is; -1: nowhere.
        weights: int64, shape (weights,): the weight at each position.
        values: float64, shape (weights,): the trace at each position.
        length: int64, shape (1,): of the list.
    """

    kind: TraceKind
    clear_others: bool
    decay: float
    n_actions: int
    positions: Integers
    weights: Integers
    values: Floats
    length: Integers

    @classmethod
    def of(cls, weights: Floats, kind: TraceKind, decay: float, *, clear_others: bool = False) -> Self:
        """No traces yet of ``weights``."""
        n, n_actions = weights.size, weights.shape[1]
        arrays = np.full(n, -1, np.int64), np.zeros(n, np.int64), np.zeros(n), np.zeros(1, np.int64)
        return cls(kind, clear_others, decay, n_actions, *arrays)

    def visit(self, active: Integers, action: int, alpha: float) -> None:
        """Mark the weights of the active features.

        Args:
            active: numbers of the features.
            action: the one taken.
            alpha: step size for one weight; matters to dutch traces.
        """
        growth = self.growth(active, action, alpha)
        for i in range(active.shape[0]):
            weight = active[i] * self.n_actions + action
            position = self.positions[weight]
            if position < 0:
                self.append(weight, growth)
            elif self.kind == TraceKind.REPLACING:
                self.values[position] = 1.0
            else:
                self.values[position] += growth
        if self.clear_others:
            for i in range(active.shape[0]):
                for other in range(self.n_actions):
                    position = self.positions[active[i] * self.n_actions + other]
                    if other != action and position >= 0:
                        self.remove(position)

    def growth(self, active: Integers, action: int, alpha: float) -> float:
        """What a visit adds to a trace."""
        growth = 1.0
        if self.kind == TraceKind.DUTCH:
            for i in range(active.shape[0]):
                position = self.positions[active[i] * self.n_actions + action]
                if position >= 0:
                    growth -= alpha * self.values[position]
        return growth

    def learn(self, weights: Floats, change: float) -> None:
        """Move the weights by ``change`` times their traces, then let the traces decay."""
        for position in range(self.length[0]):
            weights.flat[self.weights[position]] += change * self.values[position]
        for position in range(self.length[0] - 1, -1, -1):  # backwards: ``remove`` moves the last one here
            self.values[position] *= self.decay
            if abs(self.values[position]) < NEGLIGIBLE:
                self.remove(position)

    def append(self, weight: int, value: float) -> None:
        """Put the trace of a weight that has none at the end of the list."""
        position = self.length[0]
        self.positions[weight] = position
        self.weights[position] = weight
        self.values[position] = value
        self.length[0] = position + 1

    def remove(self, position: int) -> None:
        """Take a trace out of the list; the last one takes its position."""
        last = self.length[0] - 1
        self.positions[self.weights[last]] = position
        self.positions[self.weights[position]] = -1  # second, for it may be the last one itself
        self.weights[position] = self.weights[last]
        self.values[position] = self.values[last]
        self.length[0] = last

    def clear(self) -> None:
        """Remove all traces."""
        for position in range(self.length[0]):
            self.positions[self.weights[position]] = -1
        self.length[0] = 0
