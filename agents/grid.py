"""Uniform grid over the observations: Eq. (18) of the paper."""

import math
from collections.abc import Iterable
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from agents.contract import Observation, Task
from envs.checks import integer, number


class _Edges(NamedTuple):
    low: tuple[float, ...]
    high: tuple[float, ...]
    bins: tuple[int, ...]
    width: tuple[float, ...]
    scale: tuple[float, ...]


class Grid(_Edges):
    """Cells ``[low + k width, low + (k + 1) width)`` in each of any number of dimensions.

    ``encode`` is exact: a value on an edge, as the float ``low + k * width``, belongs to the cell
    above it, and the float before it to the cell below. Values outside belong to the outermost
    cells, ``high`` to the last.

    Args:
        low: least value of each dimension.
        high: greatest value of each dimension.
        bins: number of cells along each dimension, or one number for all.

    Raises:
        TypeError, ValueError: when a bound or a number of bins breaks its rule, or the bins are too
            fine for floats.
    """

    __slots__ = ()

    def __new__(cls, low: Iterable[float], high: Iterable[float], bins: int | Iterable[int]) -> Self:
        lows = tuple(number("low", x) for x in low)
        highs = tuple(number("high", x) for x in high)
        if len(lows) != len(highs) or not lows:
            raise ValueError(f"low and high must have one value a dimension, got {lows} and {highs}")
        counts = _counts(bins, len(lows))
        for a, b in zip(lows, highs, strict=True):
            number("high", b, a, above=True)
        widths = tuple((b - a) / n for a, b, n in zip(lows, highs, counts, strict=True))
        scales = tuple(map(_scale, lows, widths, counts))
        return super().__new__(cls, lows, highs, counts, widths, scales)

    def __getnewargs__(self) -> tuple[Any, ...]:
        return self.low, self.high, self.bins

    @classmethod
    def over(cls, task: Task, bins: int | Iterable[int]) -> Self:
        """The grid over the observations of ``task``, a hill."""
        return cls(task.low, task.high, bins)

    @property
    def size(self) -> int:
        """Number of cells."""
        return math.prod(self.bins)

    def encode(self, observation: Observation) -> int:
        """The cell's number in [0, size), last dimension fastest (C order)."""
        cell = 0
        for d in range(len(self.bins)):
            last = self.bins[d] - 1
            # ``scale`` is a hair less than 1 / width: k may be one too low, never too high.
            offset = (observation[d] - self.low[d]) * self.scale[d]
            offset = offset if offset > 0.0 else 0.0
            k = int(offset) if offset < last else last
            if k < last and observation[d] >= self.low[d] + (k + 1) * self.width[d]:
                k += 1
            cell = cell * self.bins[d] + k
        return cell

    def edges(self, dimension: int) -> NDArray[np.float64]:
        """The ``bins + 1`` edges along ``dimension``."""
        steps = np.arange(self.bins[dimension] + 1)
        return self.low[dimension] + steps * self.width[dimension]


def _counts(bins: int | Iterable[int], dimensions: int) -> tuple[int, ...]:
    given = bins if isinstance(bins, Iterable) and not isinstance(bins, str) else [bins] * dimensions
    counts = tuple(integer("bins", n, 1) for n in given)
    if len(counts) != dimensions:
        raise ValueError(f"bins must have {dimensions} numbers, one a dimension, got {counts}")
    return counts


def _scale(low: float, width: float, bins: int) -> float:
    """The largest tried factor that makes ``encode`` exact at every edge, hence everywhere.

    ``encode`` grows with the value, so it is exact if it is on both sides of each edge.
    """
    k = np.arange(1, bins)
    edges = low + k * width
    below = np.nextafter(edges, -np.inf)
    for bits in range(52, 20, -1):
        scale = (1.0 - 2.0**-bits) / width
        if np.all((below - low) * scale < k) and np.all((edges - low) * scale >= k - 1):
            return float(scale)
    raise ValueError(f"bins must leave cells that floats can tell apart, got {bins} of width {width!r}")
