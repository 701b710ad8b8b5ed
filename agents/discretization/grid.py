"""Uniform grid over the observations: Eq. (18) of the paper."""

import math
from collections.abc import Iterable
from fractions import Fraction
from typing import NamedTuple, Self

import numpy as np

from agents.contract import Floats, Integers, Observation, Task
from agents.discretization.box import Derived, counts, ranges
from envs.foundation.errors import InvalidValueError


class _Parts(NamedTuple):
    low: tuple[float, ...]
    high: tuple[float, ...]
    bins: tuple[int, ...]
    scale: tuple[float, ...]
    edges: Floats


class Grid(Derived, _Parts):  # type: ignore[misc]  # both have _make
    """Cells ``[a + k h, a + (k + 1) h)`` with ``h = (b - a) / n`` in each of any number of dimensions.

    ``encode`` is exact: the same as Eq. (18) in exact arithmetic for every float, so that a car at
    rest is in the cell whose lower edge is 0, where there is one. Values outside belong to the
    outermost cells, ``high`` to the last.

    Args:
        low: least value a of each dimension.
        high: greatest value b of each dimension.
        bins: number n of cells along each dimension, or one number for all.

    Attributes:
        edges: float64, shape (dimensions, max(bins) + 1): ``edges[d, k]`` is the least float in cell
            k; NaN beyond the last cell's.

    Raises:
        TypeError, ValueError: when a bound or a number of bins breaks its rule, or the bins are too
            fine for floats.
    """

    __slots__ = ()
    _n_first = 3

    def __new__(cls, low: Iterable[float], high: Iterable[float], bins: int | Iterable[int]) -> Self:  # noqa: D102 (described by the class)
        lows, highs = ranges(low, high)
        numbers = counts("bins", bins, len(lows))
        edges = np.full((len(numbers), max(numbers) + 1), np.nan)
        for d, (a, b, n) in enumerate(zip(lows, highs, numbers, strict=True)):
            edges[d, :n] = _edges(a, b, n)
        edges.flags.writeable = False
        scales = tuple(_scale(a, b, n, row) for a, b, n, row in zip(lows, highs, numbers, edges, strict=True))
        return super().__new__(cls, lows, highs, numbers, scales, edges)

    @classmethod
    def over(cls, task: Task, bins: int | Iterable[int]) -> Self:
        """The grid over the observations of ``task``, a hill."""
        return cls(task.low, task.high, bins)

    @property
    def size(self) -> int:
        """Number of cells."""
        return math.prod(self.bins)

    @property
    def active(self) -> int:
        """Features that are active at once: one."""
        return 1

    def encode(self, observation: Observation) -> int:
        """The cell's number in [0, size), last dimension fastest (C order)."""
        cell = 0
        for d in range(len(self.bins)):
            last = self.bins[d] - 1
            # ``scale`` is a hair less than 1 / h: k may be one too low, never too high.
            offset = (observation[d] - self.low[d]) * self.scale[d]
            offset = offset if offset > 0.0 else 0.0  # noqa: FURB136 (max would keep NaN)
            k = int(offset) if offset < last else last
            if observation[d] >= self.edges[d, k + 1]:
                k += 1
            cell = cell * self.bins[d] + k
        return cell

    def fill(self, observation: Observation, active: Integers) -> None:
        """Write the cell as the only active feature."""
        active[0] = self.encode(observation)


def _edges(low: float, high: float, bins: int) -> Floats:
    """The least float in each cell: the exact edge, rounded up."""
    a, h = Fraction(low), (Fraction(high) - Fraction(low)) / bins
    edges = np.empty(bins)
    for k in range(bins):
        edge = float(a + k * h)
        edges[k] = edge if edge >= a + k * h else math.nextafter(edge, math.inf)
    if not np.all(np.diff(edges) > 0.0):
        raise InvalidValueError(
            f"bins must leave cells that floats can tell apart, got {bins} in [{low}, {high}]"
        )
    return edges


def _scale(low: float, high: float, bins: int, edges: Floats) -> float:
    """The largest tried factor with which ``encode`` is exact at every edge, hence everywhere.

    ``encode`` grows with the value, so it is exact if it is on both sides of each edge.
    """
    k = np.arange(1, bins)
    above, below = edges[1:bins], np.nextafter(edges[1:bins], -np.inf)
    for bits in range(52, 20, -1):
        scale = (1.0 - 2.0**-bits) * bins / (high - low)
        if np.all((below - low) * scale < k) and np.all((above - low) * scale >= k - 1):
            return float(scale)
    raise InvalidValueError(
        f"bins must leave cells that floats can tell apart, got {bins} in [{low}, {high}]"
    )
