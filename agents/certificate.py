"""Lower bounds: before which step no drive from a start passes a limit, proved by computation.

By the maximum principle (``agents.switches``) it is enough to look at the blocks of full thrust, with any
thrust in the steps where two blocks meet. For each pattern of switches these thrusts form a box. Over the
box the drive is a drive of its middle, plus the linear response to each thrust, plus a remainder::

    e[k+1] = M[k] e[k] + G''(.) (x - middle)^2 / 2

bounded in the norm sqrt((a x)^2 + v^2) with a = sqrt(g) omega, in which the car's free oscillation hardly
grows, by the spectral norm of its matrix M[k]; ``|G''| <= h g omega^3``. So a whole box of drives
is followed at once. A box that cannot be excluded is halved; one that has been halved often enough counts as
passing the limit, so the bound is valid whatever happens.

The method is that of validated integration: R. E. Moore, Interval Analysis, 1966; R. Lohner 1987.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from agents.bang_bang import first_pattern, next_pattern
from agents.switches import MOST, Relaxed, Spacing

DEPTH = 16
"""A box is halved so often at most."""

Floats = NDArray[np.float64]


class Limit(NamedTuple):
    """What is to be excluded: ``sign * position``, or ``sign * velocity``, of at least ``value``.

    Attributes:
        of_velocity: whether it limits the velocity.
        sign: 1.0 or -1.0.
        value: in units of length, or of length per unit of time.
        spacing: of the switches at the extremes of that.
    """

    of_velocity: bool
    sign: float
    value: float
    spacing: Spacing


class Segment(NamedTuple):
    """Starts on a straight line: from the middle minus, to the middle plus what leads to its end.

    Attributes:
        position, velocity: the middle.
        length, speed: what leads from there to the end, in position and velocity.
    """

    position: float
    velocity: float
    length: float
    speed: float


class Room(NamedTuple):
    """Arrays to work in. The last column is the segment of starts, the others are switches.

    Attributes:
        steps: of the switches, shape (MOST,).
        middles, halves: the boxes that wait, in units of full thrust; shape (DEPTH + 2, MOST + 1).
        depths: how often each was halved, shape (DEPTH + 2,).
        moved, pushed: response of position and velocity to each half, shape (MOST + 1,).
        widest: greatest response of the position so far, shape (MOST + 1,).
    """

    steps: NDArray[np.int64]
    middles: Floats
    halves: Floats
    depths: NDArray[np.int64]
    moved: Floats
    pushed: Floats
    widest: Floats


def make_room() -> Room:
    """Arrays to work in."""
    boxes, responses = np.zeros((2, DEPTH + 2, MOST + 1)), np.zeros((3, MOST + 1))
    return Room(np.zeros(MOST, np.int64), *boxes, np.zeros(DEPTH + 2, np.int64), *responses)


def first_beyond(
    car: Relaxed, start: Segment, limit: Limit, switches: int, box: int, most: int, room: Room
) -> int:
    """The first step at which a drive of the box may be beyond the limit; ``most`` if none is before.

    Args:
        car: what is driven.
        start: where it may start.
        limit: what is looked for.
        switches: how many there are, at ``room.steps``.
        box: number of the box in ``room``.
        most: where to stop.
        room: where the responses are written.
    """
    h, keep, moved, pushed = car.time_step, car.keep, room.moved, room.pushed
    scale = math.sqrt(max(car.stiffness, 1e-6)) / h
    kick = 1.0 if car.explicit else math.sqrt(1.0 + (scale * h) ** 2)
    curvature = 0.5 * car.pull * car.omega**2
    for a in range(switches):
        moved[a] = pushed[a] = room.widest[a] = 0.0
    along, half = room.middles[box, switches], room.halves[box, switches]
    x, v = start.position + along * start.length, start.velocity + along * start.speed
    moved[switches], pushed[switches] = half * start.length, half * start.speed
    room.widest[switches] = abs(moved[switches])
    thrust, switch, rest = (limit.sign if switches % 2 == 0 else -limit.sign), 0, 0.0
    first = room.steps[switches - 1] + limit.spacing.last if switches > 0 else 1
    for step in range(1, most):
        slope = car.pull * car.omega * math.sin(car.omega * x)
        radius = rest / scale
        for a in range(switches + 1):
            radius += abs(moved[a])
            pushed_before = pushed[a]
            pushed[a] = keep * pushed[a] + slope * moved[a]
            moved[a] += h * (pushed_before if car.explicit else pushed[a])
        noise = car.slack * (2.0 + (abs(x) + radius) / car.reach)  # of this loop's own roundings
        rest = growth(car, scale, slope) * rest + kick * (curvature * radius * radius + noise)
        chosen = thrust
        if switch < switches and room.steps[switch] == step - 1:
            chosen, half = room.middles[box, switch], car.impulse * room.halves[box, switch]
            pushed[switch] = half
            moved[switch] = 0.0 if car.explicit else h * half
            thrust, switch = -thrust, switch + 1
        before = v
        v = keep * v + car.impulse * chosen - car.pull * math.cos(car.omega * x)
        x += h * (before if car.explicit else v)
        value = limit.sign * (v if limit.of_velocity else x) + (rest if limit.of_velocity else rest / scale)
        for a in range(switches + 1):
            value += abs(pushed[a] if limit.of_velocity else moved[a])
            room.widest[a] = max(room.widest[a], abs(moved[a]))
        if step >= first and not value < limit.value:  # also where it is NaN
            return step
    return most


def growth(car: Relaxed, scale: float, slope: float) -> float:
    """The spectral norm of a step's matrix, where positions are measured in units of 1 / ``scale``."""
    turn, back = scale * car.time_step, slope / scale
    if car.explicit:
        squares = 1.0 + turn * turn + back * back + car.keep * car.keep
        determinant = car.keep - turn * back
    else:
        one = 1.0 + turn * back
        squares = one * one + (turn * car.keep) ** 2 + back * back + car.keep * car.keep
        determinant = car.keep
    root = math.sqrt(max(squares * squares - 4.0 * determinant * determinant, 0.0))
    return math.sqrt(0.5 * (squares + root)) * (1.0 + 1e-12)


def first_possible(car: Relaxed, start: Segment, limit: Limit, most: int, boxes: int, room: Room) -> int:
    """The first step at which any drive may be beyond the limit; ``most`` if none is before.

    Args:
        car: what is driven.
        start: where it may start.
        limit: what is looked for.
        most: where to stop.
        boxes: after that many no box is halved any more.
        room: to work in.
    """
    switches, gap = 0, limit.spacing.gap
    while switches <= MOST and first_pattern(room.steps, switches, gap, most - 1 - limit.spacing.last):
        more = True
        while more:
            for a in range(switches + 1):
                room.middles[0, a], room.halves[0, a] = 0.0, 1.0
            room.depths[0] = waiting = 0
            while waiting >= 0:
                step = first_beyond(car, start, limit, switches, waiting, most, room)
                boxes -= 1
                if step >= most:
                    waiting -= 1
                elif boxes < 0 or room.depths[waiting] >= DEPTH:
                    most, waiting = step, waiting - 1
                else:
                    halve(room, waiting, switches)
                    waiting += 1
            more = next_pattern(room.steps, switches, gap, most - 1 - limit.spacing.last)
        switches += 1
    return most


def halve(room: Room, box: int, switches: int) -> None:
    """Put the halves of a box, along its widest side, into its place and the next one."""
    side = 0
    for a in range(1, switches + 1):
        if room.widest[a] > room.widest[side]:
            side = a
    room.depths[box] += 1
    room.depths[box + 1] = room.depths[box]
    room.halves[box, side] /= 2.0
    for a in range(switches + 1):
        room.halves[box + 1, a], room.middles[box + 1, a] = room.halves[box, a], room.middles[box, a]
    room.middles[box, side] -= room.halves[box, side]
    room.middles[box + 1, side] += room.halves[box + 1, side]


def exclude(
    car: Relaxed, starts: Floats, limit: Limit, boxes: int, found: NDArray[np.int64], room: Room
) -> None:
    """The first step at which a drive from each segment of starts may be beyond the limit.

    Args:
        car: what is driven.
        starts: the segments, shape (starts, 4).
        limit: what is looked for.
        boxes: for each segment, see ``first_possible``.
        found: where to stop, shape (starts,); lowered in place.
        room: to work in.
    """
    for number in range(starts.shape[0]):
        start = Segment(starts[number, 0], starts[number, 1], starts[number, 2], starts[number, 3])
        found[number] = first_possible(car, start, limit, found[number], boxes, room)
