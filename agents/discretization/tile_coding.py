"""Tile coding: several grids over the observations, each displaced (Sutton & Barto 2018, 9.5.4)."""

import math
from collections.abc import Iterable
from typing import NamedTuple, Self

import numpy as np

from agents.contract import Integers, Observation, Task
from agents.discretization.box import Derived, counts, ranges
from envs.foundation.checks import integer, number


class _Parts(NamedTuple):
    low: tuple[float, ...]
    high: tuple[float, ...]
    tilings: int
    tiles: tuple[int, ...]
    features: Integers


class TileCoding(Derived, _Parts):  # type: ignore[misc]  # both have _make
    """Binary features: in each of ``tilings`` grids, the tile that the observation is in.

    A tile is 1/tiles of a dimension's range. Tiling t is displaced by t times the vector (1, 3, 5, ...)
    in units of 1/tilings of a tile, modulo a tile; to cover the range it has tiles + 1 tiles along each
    dimension. Nothing is hashed: each tile is a feature of its own. Observations outside the bounds, and
    those that are not a number, belong to an outermost tile.

    Args:
        low: least value of each dimension.
        high: greatest value of each dimension.
        tilings: number of grids.
        tiles: tiles along the range of each dimension, or one number for all.

    Attributes:
        features: int64, shape (dimensions, max(tiles) * tilings + 1, tilings): what the place along a
            dimension, in units of 1/tilings of a tile, adds to the number of each tiling's feature.

    Raises:
        TypeError, ValueError: when one of them breaks its rule.
    """

    __slots__ = ()
    _n_first = 4

    def __new__(  # noqa: D102 (described by the class)
        cls, low: Iterable[float], high: Iterable[float], tilings: int = 8, tiles: int | Iterable[int] = 8
    ) -> Self:
        lows, highs = ranges(low, high)
        for a, b in zip(lows, highs, strict=True):
            number("high - low", b - a)
        numbers, n = counts("tiles", tiles, len(lows)), integer("tilings", tilings, 1)
        return super().__new__(cls, lows, highs, n, numbers, _features(n, numbers))

    @classmethod
    def over(cls, task: Task, tilings: int = 8, tiles: int | Iterable[int] = 8) -> Self:
        """The tilings over the observations of ``task``, a hill."""
        return cls(task.low, task.high, tilings, tiles)

    @property
    def size(self) -> int:
        """Number of features."""
        return self.tilings * math.prod(n + 1 for n in self.tiles)

    @property
    def active(self) -> int:
        """Features that are active at once: one a tiling."""
        return self.tilings

    def fill(self, observation: Observation, active: Integers) -> None:
        """Write the numbers, in [0, size), of the features that are active.

        Args:
            observation: where the car is.
            active: int64, shape (tilings,); place t receives the tile of tiling t.
        """
        for t in range(active.shape[0]):  # the array's own length: twice as fast as ``tilings``
            active[t] = 0
        for d in range(len(self.tiles)):
            last = self.tiles[d] * self.tilings
            # The range is divided before it is multiplied, so that halves and quarters are exact.
            offset = (observation[d] - self.low[d]) / (self.high[d] - self.low[d]) * last
            offset = offset if offset > 0.0 else 0.0  # noqa: FURB136 (max would keep NaN)
            place = int(offset) if offset < last else last
            for t in range(active.shape[0]):
                active[t] += self.features[d, place, t]


def _features(tilings: int, tiles: tuple[int, ...]) -> Integers:
    """What ``fill`` adds up; the features of tiling t are one block, its last dimension fastest."""
    t = np.arange(tilings)
    features = np.zeros((len(tiles), max(tiles) * tilings + 1, tilings), np.int64)
    stride = 1
    for d in reversed(range(len(tiles))):
        place = np.arange(tiles[d] * tilings + 1)[:, np.newaxis]
        features[d, : len(place)] = (place + t * (2 * d + 1) % tilings) // tilings * stride
        stride *= tiles[d] + 1
    features[0] += t * stride
    features.flags.writeable = False
    return features
