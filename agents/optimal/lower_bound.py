"""A lower bound of the steps to the goal, from the certificates and what the hill's clips may change.

Until a car touches the wall or its velocity is clipped, it is a relaxed car
(``agents.optimal.relaxed_car``). So it needs at least the least of

- the steps that the relaxed car needs from its start;
- the steps to the wall, and then those from the wall: the last touch leaves the car at ``min_position`` with
  a velocity in a small range, and what follows is a relaxed car again;
- the steps until its velocity to the left can be clipped, and then those that
  ``agents.optimal.conservative_cells`` asks for from that velocity, wherever the car is;
- the steps until its velocity to the right can be clipped, and then as many as it takes to turn around,
  but no more than ``Spacing.last``. For a clip is an impulse to the left. It does not help in the last
  steps of a drive, in which each impulse to the right helps; and until the car has turned, nothing
  else happens to it that a relaxed car does not know.
"""

import numpy as np

from agents.contract import Floats, Integers
from agents.optimal.boxes import Boxes
from agents.optimal.certificate import Limit, exclude
from agents.optimal.conservative_cells import index
from agents.optimal.relaxed_car import Relaxed, Spacing, patterns, spacing
from envs import Hill
from envs.compilation.kernels import compile_loop

WORK = 10_000_000
"""Steps that are driven for one certificate, about: 0.5 s."""

_BLOCKS = 128  # parts of the track whose starts are looked at together
_PER_PATTERN = 8  # boxes, before no more are halved


def affordable(spacing: Spacing, horizon: int) -> int:
    """The most steps, up to ``horizon``, in which all patterns of switches can be tried."""
    low, high = 1, horizon
    while low < high:
        middle = (low + high + 1) // 2
        if patterns(spacing, middle) * middle <= WORK:
            low = middle
        else:
            high = middle - 1
    return low


def lower_bound(hill: Hill, positions: Floats, upper: Integers, cells: Integers) -> Integers:
    """No drive from rest at ``positions`` reaches the goal in fewer steps.

    Args:
        hill: one for whose relaxed car the theory applies.
        positions: shape (starts,).
        upper: steps that are enough, or many; where the search stops.
        cells: lower bounds for cells of position and velocity, shape (positions, velocities).
    """
    if len(positions) == 0:
        return upper
    before_goal = cells[: index(hill.goal_position, hill.min_position, hill.max_position, len(cells)) + 1]
    proofs = _Proofs(hill, max(int(before_goal[:, 0].min()), 1))
    alone = _segments(positions)
    free = proofs.exclude(alone, upper, proofs.goal)
    most = np.array([free.max()])
    leaving = departure(hill)
    touched = int(proofs.clipped(leaving, proofs.exclude(leaving, most, proofs.goal))[0])
    blocks, block = _blocks(hill, positions)
    longest = np.zeros(len(blocks), np.int64)
    np.maximum.at(longest, block, free)
    lower = np.minimum(free, proofs.with_clips(blocks, longest, touched)[block])
    doubtful = (lower < free) & (lower < proofs.horizon(longest[block]))  # maybe not alone
    lower[doubtful] = proofs.with_clips(alone[doubtful], free[doubtful], touched)
    return lower


class _Proofs:
    """What is excluded on one hill."""

    def __init__(self, hill: Hill, from_left: int) -> None:
        self._car, self._boxes = car, _ = Relaxed.of(hill), Boxes.make()
        slack, brake = car.slack, car.impulse + car.pull + (1.0 - car.keep) * hill.max_velocity
        position, velocity = (spacing(car, of_velocity=of) for of in (False, True))
        from_right = max(min(position.last, int(hill.max_velocity / brake)), 1)
        self.goal = Limit(False, 1.0, hill.goal_position - slack, position)
        self._wall = Limit(False, -1.0, -hill.min_position - slack, position)
        self._clips = (
            (Limit(True, 1.0, hill.max_velocity - slack, velocity), from_right),
            (Limit(True, -1.0, -hill.min_velocity - slack, velocity), from_left),
        )

    def horizon(self, most: Integers) -> Integers:
        """The most steps, up to ``most``, for which clips of the velocity can be excluded."""
        return np.minimum(most, affordable(self._clips[0][0].spacing, int(most.max())))

    def exclude(self, segments: Floats, most: Integers, limit: Limit) -> Integers:
        """The first step at which a drive may be beyond ``limit``, at most ``most``."""
        if len(segments) == 0:
            return most
        horizon = affordable(limit.spacing, int(most.max()))
        lower = np.minimum(most, horizon)
        patience = int(_PER_PATTERN * patterns(limit.spacing, horizon)) + 1000
        arguments = (self._car, segments, limit, patience, lower, self._boxes)
        compile_loop(exclude, *arguments)(*arguments)
        return lower

    def clipped(self, segments: Floats, most: Integers) -> Integers:
        """A lower bound, at most ``most``, of the drives whose velocity is clipped."""
        for limit, rest in self._clips:
            first = self.exclude(segments, np.maximum(most - rest, 1), limit)
            most = np.minimum(most, first + rest)
        return most

    def with_clips(self, segments: Floats, most: Integers, touched: int) -> Integers:
        """A lower bound, at most ``most``, of the drives that touch the wall or whose velocity is clipped."""
        most = self.clipped(segments, most)
        wall = self.exclude(segments, np.maximum(most - touched, 1), self._wall)
        return np.minimum(most, wall + touched)


def departure(hill: Hill) -> Floats:
    """The states in which a car leaves the wall, as a segment: its velocities after the last touch.

    With the semi-implicit integrator it leaves when its next velocity is positive; an inelastic wall has
    stopped it before, an elastic one has not. With the explicit one it leaves when its velocity is positive,
    which it was not in the step before.
    """
    car = Relaxed.of(hill)
    kick = car.impulse + car.pull
    if car.explicit:
        low, high = 0.0, kick
    else:
        low, high = (0.0, 0.0) if hill.inelastic_wall else (-kick / car.keep, 0.0)
    low, high = low - car.slack, high + car.slack
    return np.array([[hill.min_position, 0.5 * (low + high), 0.0, 0.5 * (high - low)]])


def _segments(positions: Floats) -> Floats:
    """Starts at rest at one position each."""
    segments = np.zeros((len(positions), 4))
    segments[:, 0] = positions
    return segments


def _blocks(hill: Hill, positions: Floats) -> tuple[Floats, Integers]:
    """Parts of the track that together hold all positions, and in which of them each is."""
    width = (hill.max_position - hill.min_position) / _BLOCKS
    numbers, where = np.unique(np.floor((positions - hill.min_position) / width), return_inverse=True)
    blocks = _segments(hill.min_position + (numbers + 0.5) * width)
    blocks[:, 2] = 0.5 * width * (1.0 + 1e-9)
    return blocks, where
