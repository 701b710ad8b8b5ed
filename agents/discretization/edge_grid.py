"""A grid with edges at any places."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from agents.contract import Floats, Integers, Observation
from envs.foundation.checks import number
from envs.foundation.errors import InvalidValueError


class EdgeGrid(NamedTuple):
    """A grid with edges at any places: cell k of a dimension is ``[edge k, edge k + 1)``.

    Observations outside belong to the outermost cells.

    Attributes:
        bins: number of cells along each dimension.
        inner: float64, shape (dimensions, most edges): the edges between cells, then infinity.
    """

    bins: tuple[int, ...]
    inner: Floats

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
                raise InvalidValueError(
                    f"bins must be 2 or more ascending edges a dimension, got {tuple(given)!r}"
                )
            rows.append(row[1:-1])
        return cls._between(rows)

    @classmethod
    def digitizing(cls, low: Sequence[float], high: Sequence[float], bins: Sequence[int]) -> Self:
        """The grid of the video tutorials: ``numpy.digitize(value, numpy.linspace(low, high, n)) - 1``.

        So ``n`` numbers of cells, but ``n - 1`` cells of the same size: the last has only ``high``.

        Args:
            low: least value of each dimension.
            high: greatest value of each dimension.
            bins: number of edges along each dimension.
        """
        edges = (np.linspace(a, b, n) for a, b, n in zip(low, high, bins, strict=True))
        return cls._between([row[1:] for row in edges])

    @classmethod
    def _between(cls, rows: Sequence[ArrayLike]) -> Self:
        """The grid with these edges between its cells."""
        edges = [np.asarray(row, float) for row in rows]
        inner = np.full((len(edges), max(1, *map(len, edges))), np.inf)
        for row, target in zip(edges, inner, strict=True):
            target[: len(row)] = row
        inner.flags.writeable = False
        return cls(tuple(len(row) + 1 for row in edges), inner)

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

    def fill(self, observation: Observation, active: Integers) -> None:
        """Write the cell as the only active feature."""
        active[0] = self.encode(observation)
