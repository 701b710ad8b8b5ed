"""What the rules of learning put in the place of what a step returns: one pure function a rule.

R is the reward of a step, S' and A' are the cell that it leads to and the action that is taken there. All
values are float64, of shape (cells, actions). Numbers of equations are those of Sutton & Barto 2018.
"""

import math

from agents.contract import Floats
from agents.learning.action_values import best_action


def bootstrapped(reward: float, discount: float, next_value: float) -> float:
    """R + gamma G', with G' the return or the value of what follows, Eq. (3.9)."""
    return reward + discount * next_value


def greatest_value(values: Floats, cell: int) -> float:
    """max_a Q(S', a): Q-learning, Watkins 1989, Eq. (6.8)."""
    return values[cell, best_action(values, cell)]  # type: ignore[no-any-return]  # an array has it


def double_value(values: Floats, judge: Floats, cell: int) -> float:
    """Q2(S', argmax_a Q1(S', a)): double Q-learning, van Hasselt 2010, Eq. (6.10).

    Args:
        values: Q1, which chooses.
        judge: Q2, which values the choice.
        cell: S'.
    """
    return judge[cell, best_action(values, cell)]  # type: ignore[no-any-return]  # an array has it


def epsilon_greedy_value(values: Floats, cell: int, epsilon: float) -> float:
    """The mean of Q(S', A') over an epsilon-greedy A': Expected SARSA, van Seijen et al. 2009, Eq. (6.9)."""
    total = 0.0
    for action in range(values.shape[1]):
        total += values[cell, action]
    mean: float = total / values.shape[1]
    return epsilon * mean + (1.0 - epsilon) * greatest_value(values, cell)


def softmax_value(values: Floats, cell: int, temperature: float) -> float:
    """The mean of Q(S', A') over A' in proportion to exp(Q(S', A') / temperature), Eq. (6.9)."""
    best, total, weighted = greatest_value(values, cell), 0.0, 0.0
    for action in range(values.shape[1]):
        weight = math.exp((values[cell, action] - best) / temperature)
        total += weight
        weighted += weight * values[cell, action]
    return weighted / total
