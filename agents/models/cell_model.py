"""What actions in cells lead to, by counts: a model of the hill as a driver of cells sees it."""

from typing import NamedTuple, Self

import numpy as np

from agents.contract import Floats, Integers
from agents.learning.targets import greatest_value

SUCCESSORS = 8
"""Different cells that are kept for a pair; on the hill, cells of any kind were seen to need six."""


class CellModel(NamedTuple):
    """For each pair of a cell and an action: how often it led to which cell, and the mean reward.

    Pairs are numbered ``cell * actions + action``. The goal is one more cell, after all others. A pair
    that leads to more than ``SUCCESSORS`` cells forgets the rarest for a new one. The pairs that lead to
    a cell are a chain of links; a link is a pair with one of its places, numbered
    ``pair * SUCCESSORS + place``.

    Attributes:
        tries: int64, shape (pairs,): how often it was taken, less what is forgotten.
        rewards: float64, shape (pairs,): the mean reward.
        successors: int64, shape (pairs, SUCCESSORS): the cells it led to.
        counts: int64, shape (pairs, SUCCESSORS): how often; 0 from the first free place on.
        first: int64, shape (cells + 1,): the first link to each cell, -1 if there is none.
        next_link: int64, shape (pairs * SUCCESSORS,): the next one to the same cell, -1 after the last.
    """

    tries: Integers
    rewards: Floats
    successors: Integers
    counts: Integers
    first: Integers
    next_link: Integers

    @classmethod
    def empty(cls, cells: int, actions: int) -> Self:
        """A model that has seen nothing."""
        pairs = cells * actions
        successors, counts = np.zeros((2, pairs, SUCCESSORS), np.int64)
        first, next_link = np.full(cells + 1, -1), np.full(pairs * SUCCESSORS, -1)
        return cls(np.zeros(pairs, np.int64), np.zeros(pairs), successors, counts, first, next_link)

    def observe(self, pair: int, reward: float, successor: int) -> None:
        """Count a step of ``pair`` that led to ``successor``."""
        place, rarest = 0, 0
        while place < SUCCESSORS and self.counts[pair, place] > 0:
            if self.successors[pair, place] == successor:
                break
            if self.counts[pair, place] < self.counts[pair, rarest]:
                rarest = place
            place += 1
        if place == SUCCESSORS:
            place = rarest
            self.forget(pair, place)
        if self.counts[pair, place] == 0:
            link = pair * SUCCESSORS + place
            self.successors[pair, place] = successor
            self.next_link[link] = self.first[successor]
            self.first[successor] = link
        self.counts[pair, place] += 1
        self.tries[pair] += 1
        self.rewards[pair] += (reward - self.rewards[pair]) / self.tries[pair]

    def forget(self, pair: int, place: int) -> None:
        """Free a place, and take its link out of the chain."""
        link, successor = pair * SUCCESSORS + place, self.successors[pair, place]
        if self.first[successor] == link:
            self.first[successor] = self.next_link[link]
        else:
            before = self.first[successor]
            while self.next_link[before] != link:
                before = self.next_link[before]
            self.next_link[before] = self.next_link[link]
        self.tries[pair] -= self.counts[pair, place]
        self.counts[pair, place] = 0

    def expected(self, pair: int, state_values: Floats, discount: float) -> float:
        """The mean of the reward and the discounted value of what follows.

        Args:
            pair: one that was tried.
            state_values: of each cell and of the goal, shape (cells + 1,).
            discount: gamma.
        """
        place, total = 0, 0.0
        while place < SUCCESSORS and self.counts[pair, place] > 0:
            total += self.counts[pair, place] * state_values[self.successors[pair, place]]
            place += 1
        return self.rewards[pair] + discount * total / self.tries[pair]  # type: ignore[no-any-return]  # an array has it

    def backup(
        self, values: Floats, visits: Integers, state_values: Floats, cell: int, known: int, discount: float
    ) -> float:
        """Set the values of a cell to what is expected, and return by how much that changes the best of them.

        Args:
            values: float64, shape (cells, actions); changed where an action is known.
            visits: int64, shape (cells, actions).
            state_values: the best value of each cell, and 0 of the goal, shape (cells + 1,); changed.
            cell: the cell.
            known: visits that make an action of it known, at least 1.
            discount: gamma.
        """
        for action in range(values.shape[1]):
            if visits[cell, action] >= known:
                values[cell, action] = self.expected(cell * values.shape[1] + action, state_values, discount)
        before = state_values[cell]
        state_values[cell] = greatest_value(values, cell)
        return abs(state_values[cell] - before)  # type: ignore[no-any-return]  # an array has it
