"""Choices from a table of action values, float64, shape (cells, actions)."""

import numpy as np

from agents.contract import Floats


def best_action(values: Floats, cell: int) -> int:
    """The action with the greatest value in ``cell`` (Eq. 14); of equal ones the lowest."""
    best = 0
    value = values[cell, 0]
    for action in range(1, values.shape[1]):
        if values[cell, action] > value:
            best = action
            value = values[cell, action]
    return best


def epsilon_greedy(values: Floats, cell: int, epsilon: float, rng: np.random.Generator) -> int:
    """With probability ``epsilon`` any action, all equally likely, else the best one."""
    if rng.random() < epsilon:
        return int(rng.random() * values.shape[1])
    return best_action(values, cell)
