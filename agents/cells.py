"""Cells of any kind: what divides the observations, chosen by ``bins`` and ``binning``.

Each kind has ``encode(observation)``, the cell's number, and ``size``, the number of cells; and ``fill``,
which makes of the cell the only active feature of a linear agent.
"""

import math
import warnings
from collections.abc import Sequence
from itertools import pairwise
from typing import Any, Literal, NamedTuple, Self, cast

import numpy as np
from numpy.typing import NDArray

from agents.contract import Observation
from agents.grid import Grid
from agents.parameters import Count
from envs.checks import number

Bins = Count | Sequence[Count] | Sequence[Sequence[float]]
Binning = Literal["uniform", "quantile", "kmeans"]

_SAMPLES = 20_000  # observations from which cells are learned
_EPISODE = 500  # of them in a row
_HOLD = 64  # steps that an action is held at most: a car that trembles stays in the valley


class EdgeGrid(NamedTuple):
    """A grid with edges at any places: cell k of a dimension is ``[edge k, edge k + 1)``.

    Observations outside belong to the outermost cells.

    Attributes:
        bins: number of cells along each dimension.
        inner: float64, shape (dimensions, most edges): the edges between cells, then infinity.
    """

    bins: tuple[int, ...]
    inner: NDArray[np.float64]

    @classmethod
    def from_edges(cls, edges: Sequence[Sequence[float]]) -> Self:
        """The grid with these edges, the outermost included, along each dimension.

        Raises:
            TypeError, ValueError: when they are not two or more ascending numbers.
        """
        rows = []
        for given in edges:
            row = [number("bins", edge) for edge in given]
            if len(row) < 2 or not all(a < b for a, b in pairwise(row)):
                raise ValueError(f"bins must be 2 or more ascending edges a dimension, got {tuple(given)!r}")
            rows.append(row[1:-1])
        inner = np.full((len(rows), max(1, *map(len, rows))), np.inf)
        for row, target in zip(rows, inner, strict=True):
            target[: len(row)] = row
        inner.flags.writeable = False
        return cls(tuple(len(row) + 1 for row in rows), inner)

    @property
    def size(self) -> int:
        """Number of cells."""
        return math.prod(self.bins)

    @property
    def active(self) -> int:
        """Features that are active at once: one."""
        return 1

    def encode(self, observation: Observation) -> int:
        """The cell's number in [0, size), last dimension fastest."""
        cell = 0
        for d in range(len(self.bins)):
            low, high = 0, self.bins[d] - 1  # the number of inner edges at or below the value
            while low < high:
                middle = (low + high) // 2
                if observation[d] >= self.inner[d, middle]:
                    low = middle + 1
                else:
                    high = middle
            cell = cell * self.bins[d] + low
        return cell

    def fill(self, observation: Observation, active: NDArray[np.int64]) -> None:
        """Write the cell as the only active feature."""
        active[0] = self.encode(observation)


class Voronoi(NamedTuple):
    """Cells of the points that are nearest to a centre, the first of equally near ones.

    Attributes:
        centres: float64, shape (cells, dimensions), in units of ``scale``.
        scale: of each dimension.
    """

    centres: NDArray[np.float64]
    scale: tuple[float, ...]

    @property
    def size(self) -> int:
        """Number of cells."""
        return len(self.centres)

    @property
    def active(self) -> int:
        """Features that are active at once: one."""
        return 1

    def encode(self, observation: Observation) -> int:
        """The number of the nearest centre."""
        nearest, least = 0, math.inf
        for cell in range(self.centres.shape[0]):
            distance = 0.0
            for d in range(len(self.scale)):
                difference = observation[d] / self.scale[d] - self.centres[cell, d]
                distance += difference * difference
            if distance < least:
                nearest, least = cell, distance
        return nearest

    def fill(self, observation: Observation, active: NDArray[np.int64]) -> None:
        """Write the cell as the only active feature."""
        active[0] = self.encode(observation)


Cells = Grid | EdgeGrid | Voronoi


def make_cells(task: Any, bins: Bins, binning: Binning, rng: np.random.Generator | None) -> Cells:
    """The cells that ``bins`` and ``binning`` describe, in the manner of scikit-learn's ``KBinsDiscretizer``.

    Args:
        task: the hill; for cells that are learned it must have ``reset`` and ``step``.
        bins: number of cells along each dimension; or, as ``numpy.histogramdd`` has it, the edges.
        binning: ``"uniform"``; ``"quantile"``: equally many of the visited observations in the bins of
            each dimension; ``"kmeans"``: as many cells in all, around the centres of clusters.
        rng: draws the drives whose observations cells are learned from.

    Raises:
        TypeError, ValueError: when something breaks its rule.
    """
    if isinstance(bins, Sequence) and any(isinstance(part, Sequence) for part in bins):
        if len(bins) != len(task.low) or not all(isinstance(part, Sequence) for part in bins):
            raise ValueError(
                f"bins must have a list of edges for each of {len(task.low)} dimensions, got {bins}"
            )
        if binning != "uniform":
            raise ValueError(f"binning must be left out where bins are edges, got {binning!r}")
        return EdgeGrid.from_edges(cast("Sequence[Sequence[float]]", bins))
    grid = Grid.over(task, cast("int | Sequence[int]", bins))
    if binning == "uniform":
        return grid
    visited = _visited(task, rng or np.random.default_rng())
    if binning == "kmeans":
        return _clusters(visited, grid.size)
    rows = [
        np.unique(np.quantile(x, np.linspace(0, 1, n + 1))) for x, n in zip(visited.T, grid.bins, strict=True)
    ]
    return EdgeGrid.from_edges([tuple(map(float, row)) for row in rows])


def _clusters(visited: NDArray[np.float64], size: int) -> Voronoi:
    from scipy.cluster.vq import kmeans2

    scale = visited.std(axis=0)
    points = visited / scale
    # Started at points that are spread evenly over the drives; ``kmeans2`` then draws nothing.
    start = points[np.linspace(0, len(points) - 1, size).astype(int)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # a cluster that has lost its points keeps its centre
        centres, _ = kmeans2(points, start, iter=20, minit="matrix", missing="warn")
    return Voronoi(centres, tuple(map(float, scale)))


def _visited(task: Any, rng: np.random.Generator) -> NDArray[np.float64]:
    """Observations of drives that hold random actions for random times."""
    found = np.empty((_SAMPLES, len(task.low)))
    hold, action = 0, 0
    state = task.reset(rng)
    for step in range(_SAMPLES):
        found[step] = task.observe(state)
        if hold == 0:
            hold, action = int(rng.integers(1, _HOLD + 1)), int(rng.integers(task.n_actions))
        hold -= 1
        state, _, terminated = task.step(state, action)
        if terminated or step % _EPISODE == _EPISODE - 1:
            state = task.reset(rng)
    return found
