"""Boxes of thrusts and starts, for ``agents.optimal.certificate``."""

from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from agents.learning.action_values import Counts
from agents.optimal.relaxed_car import MOST

DEPTH = 16
"""A box is halved so often at most."""

Floats = NDArray[np.float64]


class Boxes(NamedTuple):
    """Boxes that wait to be looked at, and room for what is found out about one of them.

    Side a of a box is the thrust in the step of switch a; the side after all switches is the segment of
    starts.

    Attributes:
        steps: of the switches, shape (MOST,).
        middles: of all sides, in units of the full thrust or of the segment, shape (DEPTH + 2, MOST + 1).
        halves: of the lengths of all sides, likewise.
        depths: how often each box was halved, shape (DEPTH + 2,).
        moved: response of the position to half of each side, shape (MOST + 1,).
        pushed: response of the velocity, shape (MOST + 1,).
        widest: greatest response of the position in the drive, shape (MOST + 1,).
    """

    steps: Counts
    middles: Floats
    halves: Floats
    depths: Counts
    moved: Floats
    pushed: Floats
    widest: Floats

    @classmethod
    def make(cls) -> Self:
        """Room for the greatest number of switches."""
        middles, halves = np.zeros((2, DEPTH + 2, MOST + 1))
        moved, pushed, widest = np.zeros((3, MOST + 1))
        steps, depths = np.zeros(MOST, np.int64), np.zeros(DEPTH + 2, np.int64)
        return cls(steps, middles, halves, depths, moved, pushed, widest)

    def whole(self, switches: int) -> None:
        """Let the box of all thrusts and starts be the only one."""
        for a in range(switches + 1):
            self.middles[0, a], self.halves[0, a] = 0.0, 1.0
        self.depths[0] = 0

    def halve(self, box: int, switches: int) -> None:
        """Put the halves of a box, across its widest side, into its place and the next one."""
        side = 0
        for a in range(1, switches + 1):
            if self.widest[a] > self.widest[side]:
                side = a
        self.halves[box, side] /= 2.0
        for a in range(switches + 1):
            self.halves[box + 1, a], self.middles[box + 1, a] = self.halves[box, a], self.middles[box, a]
        self.middles[box, side] -= self.halves[box, side]
        self.middles[box + 1, side] += self.halves[box, side]
        self.depths[box] += 1
        self.depths[box + 1] = self.depths[box]
