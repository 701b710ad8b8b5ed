"""What an agent has learned, by position and velocity: its actions, its values, and where it has been.

An agent with a rectangular grid is told cell by cell, exactly. Any other, such as one with tile coding, is
asked at the middles of a fine grid, ``FINE``.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.algorithms.linear import best_action_of, value_of
from agents.discretization.edge_grid import EdgeGrid
from agents.discretization.grid import Grid
from arena.common.npz import Floats
from arena.results.trained import Trained, UnknownPolicyError
from envs import Hill

FINE = (90, 60)
"""Cells along position and velocity where the agent has none of its own that could be drawn."""

MAX_CELLS = 10_000  # more of its own are not told apart in a picture


@dataclass(frozen=True)
class PolicyMap:
    """A grid over positions and velocities.

    Attributes:
        positions, velocities: edges of its cells, float64, shapes (m + 1,) and (n + 1,).
        exact: whether these are the agent's own cells.
    """

    positions: Floats
    velocities: Floats
    exact: bool

    @property
    def middles(self) -> list[list[tuple[float, float]]]:
        """The middle of each cell, by position and velocity."""
        x, v = (0.5 * (edges[1:] + edges[:-1]) for edges in (self.positions, self.velocities))
        return [[(float(a), float(b)) for b in v] for a in x]


def map_of(trained: Trained) -> PolicyMap:
    """The agent's own cells if they are a grid, else a fine one."""
    hill, cells = trained.hill, getattr(trained.agent, "cells", None)
    exact = isinstance(cells, (Grid, EdgeGrid)) and cells.size <= MAX_CELLS
    if isinstance(cells, EdgeGrid) and exact:
        return PolicyMap(_inside(cells, hill, 0), _inside(cells, hill, 1), exact)
    bins = cells.bins if isinstance(cells, Grid) and exact else FINE
    return PolicyMap(_even(hill, 0, bins), _even(hill, 1, bins), exact)


def _even(hill: Hill, d: int, bins: tuple[int, ...]) -> Floats:
    return np.linspace(hill.low[d], hill.high[d], bins[d] + 1)


def _inside(cells: EdgeGrid, hill: Hill, d: int) -> Floats:
    """Their edges between the hill's bounds."""
    low, high, inner = hill.low[d], hill.high[d], cells.inner[d, : cells.bins[d] - 1]
    return np.array([low, *inner[(low < inner) & (inner < high)], high])


def policy(trained: Trained, where: PolicyMap) -> NDArray[np.int64]:
    """The action of the learned policy in each cell, shape (m, n).

    Raises:
        UnknownPolicyError: when the agent does not choose the same twice.
    """
    actions = np.array([[int(trained.agent.greedy(o)) for o in row] for row in where.middles])
    middle = actions.shape[1] // 2  # cells of the least speeds are asked again
    again = [int(trained.agent.greedy(row[middle])) for row in where.middles]
    if np.any(actions[:, middle] != again):
        raise UnknownPolicyError(f"{trained.entrant!r} drives by chance: it has no policy to draw")
    return actions


def visits(trained: Trained, where: PolicyMap) -> NDArray[np.int64] | None:
    """How often each action was taken in each cell while it learned, shape (m, n, actions).

    None if the agent does not count them by the cells of the map.
    """
    counts = getattr(trained.agent, "visits", None)
    if counts is None or not where.exact or not _is_table(counts, trained):
        return None
    return np.array([[counts[trained.agent.cells.encode(o)] for o in row] for row in where.middles])


def values(trained: Trained, where: PolicyMap) -> Floats | None:
    """The value of the best action in each cell, shape (m, n): minus the steps to go, discounted.

    None if the agent has no values: of its cells in ``values``, or of its features in ``weights``.
    """
    agent = trained.agent
    if hasattr(agent, "cells") and _is_table(getattr(agent, "values", None), trained):
        return np.array([[agent.values[agent.cells.encode(o)].max() for o in row] for row in where.middles])
    if hasattr(agent, "features") and hasattr(agent, "weights"):
        return np.array([[_linear(agent, o) for o in row] for row in where.middles])
    return None


def _is_table(array: Any, trained: Trained) -> bool:
    """Whether it has a row a cell and a column an action."""
    size = getattr(getattr(trained.agent, "cells", None), "size", None)
    return isinstance(array, np.ndarray) and array.shape == (size, trained.hill.n_actions)


def _linear(agent: Any, observation: tuple[float, float]) -> float:
    active = np.zeros(agent.features.active, np.int64)
    agent.features.fill(observation, active)
    return value_of(agent.weights, active, best_action_of(agent.weights, active))
