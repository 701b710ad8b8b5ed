"""Eligibility traces of linear agents, kept only where not negligible (Sutton & Barto 2018, chapter 12)."""

from enum import IntEnum
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from agents.learning.action_values import Table

NEGLIGIBLE = 1e-8
"""A smaller trace becomes 0; with a decay of 0.9 that is 175 steps after the last visit. The weight is
then left where the next error would have moved it by less than 1e-8 of its step at a visit."""


class Kind(IntEnum):
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
        places: int64, shape (weights,): where in the list a weight's trace is; -1: nowhere.
        numbers: int64, shape (weights,): the weight of each place.
        sizes: float64, shape (weights,): the trace in each place.
        length: int64, shape (1,): of the list.
    """

    kind: Kind
    clear_others: bool
    decay: float
    n_actions: int
    places: NDArray[np.int64]
    numbers: NDArray[np.int64]
    sizes: NDArray[np.float64]
    length: NDArray[np.int64]

    @classmethod
    def of(cls, weights: Table, kind: Kind, decay: float, *, clear_others: bool = False) -> Self:
        """No traces yet of ``weights``."""
        n, n_actions = weights.size, weights.shape[1]
        arrays = np.full(n, -1, np.int64), np.zeros(n, np.int64), np.zeros(n), np.zeros(1, np.int64)
        return cls(kind, clear_others, decay, n_actions, *arrays)

    def visit(self, active: NDArray[np.int64], action: int, alpha: float) -> None:
        """Mark the weights of the active features.

        Args:
            active: numbers of the features.
            action: the one taken.
            alpha: step size for one weight; matters to dutch traces.
        """
        growth = self.growth(active, action, alpha)
        for i in range(active.shape[0]):
            number = active[i] * self.n_actions + action
            place = self.places[number]
            if place < 0:
                self.append(number, growth)
            elif self.kind == Kind.REPLACING:
                self.sizes[place] = 1.0
            else:
                self.sizes[place] += growth
        if self.clear_others:
            for i in range(active.shape[0]):
                for other in range(self.n_actions):
                    place = self.places[active[i] * self.n_actions + other]
                    if other != action and place >= 0:
                        self.remove(place)

    def growth(self, active: NDArray[np.int64], action: int, alpha: float) -> float:
        """What a visit adds to a trace."""
        growth = 1.0
        if self.kind == Kind.DUTCH:
            for i in range(active.shape[0]):
                place = self.places[active[i] * self.n_actions + action]
                if place >= 0:
                    growth -= alpha * self.sizes[place]
        return growth

    def learn(self, weights: Table, change: float) -> None:
        """Move the weights by ``change`` times their traces, then let the traces decay."""
        for place in range(self.length[0]):
            weights.flat[self.numbers[place]] += change * self.sizes[place]
        for place in range(self.length[0] - 1, -1, -1):  # backwards: ``remove`` moves the last one here
            self.sizes[place] *= self.decay
            if abs(self.sizes[place]) < NEGLIGIBLE:
                self.remove(place)

    def append(self, number: int, size: float) -> None:
        """Put the trace of a weight that has none at the end of the list."""
        place = self.length[0]
        self.places[number] = place
        self.numbers[place] = number
        self.sizes[place] = size
        self.length[0] = place + 1

    def remove(self, place: int) -> None:
        """Take a trace out of the list; the last one takes its place."""
        last = self.length[0] - 1
        self.places[self.numbers[last]] = place
        self.places[self.numbers[place]] = -1  # second, for it may be the last one itself
        self.numbers[place] = self.numbers[last]
        self.sizes[place] = self.sizes[last]
        self.length[0] = last

    def clear(self) -> None:
        """Remove all traces."""
        for place in range(self.length[0]):
            self.places[self.numbers[place]] = -1
        self.length[0] = 0
