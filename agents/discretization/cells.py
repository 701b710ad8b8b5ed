"""Cells of any kind: what divides the observations, chosen by ``bins`` and ``binning``.

Each kind has ``encode(observation)``, the cell's number, and ``size``, the number of cells; and ``fill``,
which makes of the cell the only active feature of a linear agent.
"""

import warnings
from collections.abc import Sequence
from typing import Any, Literal, cast

import numpy as np

from agents.contract import Floats
from agents.discretization.edge_grid import EdgeGrid
from agents.discretization.grid import Grid
from agents.discretization.voronoi import Voronoi
from agents.parameters.declared import Count
from envs.foundation.errors import InvalidValueError

Bins = Count | Sequence[Count] | Sequence[Sequence[float]]
Binning = Literal["uniform", "digitize", "quantile", "kmeans"]

_SAMPLES = 20_000  # observations from which cells are learned
_EPISODE = 500  # of them in a row
_HOLD = 64  # steps that an action is held at most: a car that trembles stays in the valley


Cells = Grid | EdgeGrid | Voronoi


def make_cells(task: Any, bins: Bins, binning: Binning, rng: np.random.Generator | None) -> Cells:
    """The cells that ``bins`` and ``binning`` describe, in the manner of scikit-learn's ``KBinsDiscretizer``.

    Args:
        task: the hill; for cells that are learned it must have ``reset`` and ``step``.
        bins: number of cells along each dimension; or, as ``numpy.histogramdd`` has it, the edges.
        binning: ``"uniform"``; ``"digitize"``: as many *edges* along each dimension, from the least to the
            greatest value, so that the last cell has nothing but the greatest; ``"quantile"``: equally many
            of the visited observations in the bins of each dimension; ``"kmeans"``: as many cells in all,
            around the centres of clusters.
        rng: draws the drives whose observations cells are learned from.

    Raises:
        TypeError, ValueError: when something breaks its rule.
    """
    if isinstance(bins, Sequence) and any(isinstance(part, Sequence) for part in bins):
        if len(bins) != len(task.low) or not all(isinstance(part, Sequence) for part in bins):
            raise InvalidValueError(
                f"bins must have a list of edges for each of {len(task.low)} dimensions, got {bins}"
            )
        if binning != "uniform":
            raise InvalidValueError(f"binning must be left out where bins are edges, got {binning!r}")
        return EdgeGrid.from_edges(cast("Sequence[Sequence[float]]", bins))
    grid = Grid.over(task, cast("int | Sequence[int]", bins))
    if binning == "uniform":
        return grid
    if binning == "digitize":
        return EdgeGrid.digitizing(task.low, task.high, grid.bins)
    visited = _visited(task, rng or np.random.default_rng())
    if binning == "kmeans":
        return _clusters(visited, grid.size)
    rows = [
        np.unique(np.quantile(x, np.linspace(0, 1, n + 1))) for x, n in zip(visited.T, grid.bins, strict=True)
    ]
    return EdgeGrid.from_edges([tuple(map(float, row)) for row in rows])


def _clusters(visited: Floats, size: int) -> Voronoi:
    from scipy.cluster.vq import kmeans2

    scale = visited.std(axis=0)
    points = visited / scale
    # Started at points that are spread evenly over the drives; ``kmeans2`` then draws nothing.
    start = points[np.linspace(0, len(points) - 1, size).astype(int)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # a cluster that has lost its points keeps its centre
        centres, _ = kmeans2(points, start, iter=20, minit="matrix", missing="warn")
    return Voronoi(centres, tuple(map(float, scale)))


def _visited(task: Any, rng: np.random.Generator) -> Floats:
    """Observations of drives that hold random actions for random times."""
    visited = np.empty((_SAMPLES, len(task.low)))
    hold, action = 0, 0
    state = task.reset(rng)
    for step in range(_SAMPLES):
        visited[step] = task.observe(state)
        if hold == 0:
            hold, action = int(rng.integers(1, _HOLD + 1)), int(rng.integers(task.n_actions))
        hold -= 1
        state, _, terminated = task.step(state, action)
        if terminated or step % _EPISODE == _EPISODE - 1:
            state = task.reset(rng)
    return visited
