"""Boxes of thrusts and starts, for ``agents.optimal.certificate``."""

from typing import NamedTuple, Self

import numpy as np

from agents.contract import Floats, Integers
from agents.optimal.relaxed_car import MAX_SWITCHES

DEPTH = 16
"""A box is halved so often at most."""


class Boxes(NamedTuple):
    """Boxes that wait to be looked at, and room for what is found out about one of them.

    Side a of a box is the thrust in the step of switch a; the side after all switches is the segment of
    starts.

    Attributes:
        steps: of the switches, shape (MAX_SWITCHES,).
        middles: of all sides, in units of the full thrust or of the segment,
            shape (DEPTH + 2, MAX_SWITCHES + 1).
        halves: of the lengths of all sides, likewise.
        depths: how often each box was halved, shape (DEPTH + 2,).
        moved: response of the position to half of each side, shape (MAX_SWITCHES + 1,).
        pushed: response of the velocity, shape (MAX_SWITCHES + 1,).
        widest: greatest response of the position in the drive, shape (MAX_SWITCHES + 1,).
    """

    steps: Integers
    middles: Floats
    halves: Floats
    depths: Integers
    moved: Floats
    pushed: Floats
    widest: Floats

    @classmethod
    def make(cls) -> Self:
        """Room for the greatest number of switches."""
        middles, halves = np.zeros((2, DEPTH + 2, MAX_SWITCHES + 1))
        moved, pushed, widest = np.zeros((3, MAX_SWITCHES + 1))
        steps, depths = np.zeros(MAX_SWITCHES, np.int64), np.zeros(DEPTH + 2, np.int64)
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
