"""Cells around centres."""

import math
from typing import NamedTuple

from agents.contract import Floats, Integers, Observation


class Voronoi(NamedTuple):
    """Cells of the points that are nearest to a centre, the first of equally near ones.

    Attributes:
        centres: float64, shape (cells, dimensions), in units of ``scale``.
        scale: of each dimension.
    """

    centres: Floats
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

    def fill(self, observation: Observation, active: Integers) -> None:
        """Write the cell as the only active feature."""
        active[0] = self.encode(observation)
