"""Choices from a table of action values."""

import numpy as np
from numpy.typing import NDArray

Table = NDArray[np.float64]
Counts = NDArray[np.int64]


def best_action(values: Table, cell: int) -> int:
    """The action with the greatest value in ``cell`` (Eq. 14); of equal ones the lowest."""
    best = 0
    value = values[cell, 0]
    for action in range(1, values.shape[1]):
        if values[cell, action] > value:
            best = action
            value = values[cell, action]
    return best


def epsilon_greedy(values: Table, cell: int, epsilon: float, rng: np.random.Generator) -> int:
    """With probability ``epsilon`` any action, all equally likely, else the best one."""
    if rng.random() < epsilon:
        return int(rng.random() * values.shape[1])
    return best_action(values, cell)
