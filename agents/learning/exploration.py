"""How an agent with a table of action values explores: epsilon-greedy, softmax, upper confidence bounds.

Each is a named tuple with ``choose``, the action, and ``expected``, the mean value of a cell under what
it would choose (needed by Expected SARSA). Arrays ``values`` and ``visits`` have shape (cells, actions).
"""

import math
from typing import NamedTuple

import numpy as np

from agents.contract import Floats, Integers
from agents.learning.action_values import best_action, epsilon_greedy
from agents.learning.schedules import LinearDecay
from agents.learning.targets import epsilon_greedy_value, greatest_value, softmax_value
from agents.parameters.declared import NonNegative, Positive
from agents.parameters.validation import validated


class EpsilonGreedy(NamedTuple):
    """With probability epsilon any action, else the best one (paper, section 4.3)."""

    epsilon: LinearDecay

    def choose(
        self, values: Floats, visits: Integers, cell: int, progress: float, rng: np.random.Generator
    ) -> int:
        """The action to take in ``cell``."""
        return epsilon_greedy(values, cell, self.epsilon.at(progress), rng)

    def expected(self, values: Floats, visits: Integers, cell: int, progress: float) -> float:
        """The mean value of ``cell`` under this policy."""
        return epsilon_greedy_value(values, cell, self.epsilon.at(progress))


@validated
class Softmax(NamedTuple):
    """Actions with probabilities in proportion to ``exp(value / temperature)`` (Sutton & Barto 2018, 13.1).

    Args:
        start: temperature at first, greater than 0.
        end: what it approaches in a straight line over the training, greater than 0.

    Raises:
        TypeError, ValueError: when one of them breaks its rule.
    """

    start: Positive = 1.0
    end: Positive = 0.05

    def at(self, progress: float) -> float:
        """The temperature when the share ``progress`` of the training is done."""
        return self.start + (self.end - self.start) * progress

    def choose(
        self, values: Floats, visits: Integers, cell: int, progress: float, rng: np.random.Generator
    ) -> int:
        """The action to take in ``cell``."""
        temperature, best = self.at(progress), greatest_value(values, cell)
        total = 0.0
        for action in range(values.shape[1]):
            total += math.exp((values[cell, action] - best) / temperature)
        left = rng.random() * total
        for action in range(values.shape[1]):
            left -= math.exp((values[cell, action] - best) / temperature)
            if left < 0.0:
                return action
        return best_action(values, cell)  # rounding left a rest

    def expected(self, values: Floats, visits: Integers, cell: int, progress: float) -> float:
        """The mean value of ``cell`` under this policy."""
        return softmax_value(values, cell, self.at(progress))


@validated
class UpperConfidence(NamedTuple):
    """The action with the greatest ``value + c sqrt(ln N / n)``, one untried before all others.

    UCB1 (Auer et al. 2002; Sutton & Barto 2018, 2.7), with N the visits of the cell and n those in which
    the action was taken.

    Args:
        c: weight of what is not known, at least 0.

    Raises:
        TypeError, ValueError: when it breaks its rule.
    """

    c: NonNegative = 1.0

    def choose(
        self, values: Floats, visits: Integers, cell: int, progress: float, rng: np.random.Generator
    ) -> int:
        """The action to take in ``cell``."""
        total = 0
        for action in range(values.shape[1]):
            if visits[cell, action] == 0:
                return action
            total += visits[cell, action]
        best, bound = 0, -math.inf
        for action in range(values.shape[1]):
            hope = values[cell, action] + self.c * math.sqrt(math.log(total) / visits[cell, action])
            if hope > bound:
                best, bound = action, hope
        return best

    def expected(self, values: Floats, visits: Integers, cell: int, progress: float) -> float:
        """The value of the action that is the best so far: what is tried beside it is curiosity."""
        return greatest_value(values, cell)


Exploration = EpsilonGreedy | Softmax | UpperConfidence


def make_exploration(epsilon: LinearDecay | float, explore: Softmax | UpperConfidence | None) -> Exploration:
    """``explore`` if it is given, else epsilon-greedy; a number is a constant epsilon."""
    if explore is not None:
        return explore
    return EpsilonGreedy(LinearDecay.of(epsilon))
