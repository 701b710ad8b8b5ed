"""A chain of cells, whose values are known, and four cells with nothing to choose."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena.execution.loops import learner_and_actor


class Chain(NamedTuple):
    """Cells 0 to 4 in a row; action 1 goes right, 0 left; the goal is right of the last."""

    low: tuple[float, ...] = (0.0,)
    high: tuple[float, ...] = (5.0,)
    n_actions: int = 2


def chain_values(discount: float) -> NDArray[np.float64]:
    """The values of both actions, from the linear equations of the policy that always goes right."""
    rightwards = np.eye(5, k=1)  # from the last cell nothing follows
    worth = np.linalg.solve(np.eye(5) - discount * rightwards, -np.ones(5))
    left, right = np.maximum(np.arange(5) - 1, 0), np.arange(5) + 1
    return np.stack([-1 + discount * worth[left], -1 + discount * np.append(worth, 0.0)[right]], axis=1)


def drive_chain(agent: Any, drives: int) -> None:
    rng = np.random.default_rng(1)
    learn_and_act = learner_and_actor(agent, lambda observation: agent.act(observation, 0.0, rng))
    for _ in range(drives):
        agent.begin_episode()
        cell, action, end = 0, agent.act((0.5,), 0.0, rng), False
        while not end:
            following = cell + 1 if action == 1 else max(cell - 1, 0)
            end = following == 5
            action = learn_and_act(((cell + 0.5,), action, -1.0, (following + 0.5,)), end, end)
            cell = following


class Cells4(NamedTuple):
    """Four cells and nothing to choose."""

    low: tuple[float, ...] = (0.0,)
    high: tuple[float, ...] = (4.0,)
    n_actions: int = 1
