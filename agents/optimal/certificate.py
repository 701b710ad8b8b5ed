"""Lower bounds: before which step no relaxed car is beyond a limit, proved by computation.

By the maximum principle (``agents.optimal.relaxed_car``) it is enough to look at drives of blocks of full
thrust, with any thrust in the steps where two blocks meet. For each pattern of switches these thrusts form
a box. Any drive of the box is the drive of its middle, plus its linear response to each thrust, plus a
remainder e::

    e[k+1] = M[k] e[k] + (0, G''(.) (x[k] - middle)^2 / 2),      |G''| <= h g omega^3

The length of e, with positions in a unit in which a free oscillation hardly grows, is bounded by the
spectral norm of the step's matrix M[k]. So all drives of a box are followed at once. A box that cannot be
excluded is halved; one that was halved often enough counts as beyond the limit: the bound is valid
whatever happens, and tight if that is rare.

Source: validated integration, R. E. Moore, Interval Analysis, 1966.
"""

import math
from typing import NamedTuple

from agents.contract import Floats, Integers
from agents.optimal.bang_bang import first_pattern, next_pattern
from agents.optimal.boxes import DEPTH, Boxes
from agents.optimal.relaxed_car import MAX_SWITCHES, Relaxed, Spacing


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
    """States on a straight line, from its middle minus, to its middle plus what leads to an end.

    Attributes:
        position: of the middle.
        velocity: of the middle.
        length: of position from there to the end.
        speed: of velocity from there to the end.
    """

    position: float
    velocity: float
    length: float
    speed: float


def first_beyond(
    car: Relaxed, start: Segment, limit: Limit, switches: int, box: int, most: int, boxes: Boxes
) -> int:
    """The first step after which a drive of the box may be beyond the limit; ``most`` if none is before.

    Steps after which the last block is still too short for an extreme are not looked at.

    Args:
        car: what is driven.
        start: where it may start.
        limit: what is looked for.
        switches: how many there are, in ``boxes.steps``.
        box: its number in ``boxes``.
        most: where to stop.
        boxes: where the responses are written, too.
    """
    h, moved, pushed = car.time_step, boxes.moved, boxes.pushed
    scale = math.sqrt(max(car.stiffness, 1e-6)) / h
    kick = 1.0 if car.explicit else math.hypot(1.0, scale * h)  # the length of a unit impulse after its step
    for a in range(switches):
        moved[a] = pushed[a] = boxes.widest[a] = 0.0
    along, half = boxes.middles[box, switches], boxes.halves[box, switches]
    x, v = start.position + along * start.length, start.velocity + along * start.speed
    moved[switches], pushed[switches] = half * start.length, half * start.speed
    boxes.widest[switches] = abs(moved[switches])
    thrust, switch, rest = (limit.sign if switches % 2 == 0 else -limit.sign), 0, 0.0
    first = boxes.steps[switches - 1] + limit.spacing.last if switches > 0 else 1
    for step in range(1, most):
        slope = car.pull * car.omega * math.sin(car.omega * x)
        radius = rest / scale
        for a in range(switches + 1):
            radius += abs(moved[a])
            before = pushed[a]
            pushed[a] = car.keep * before + slope * moved[a]
            moved[a] += h * (before if car.explicit else pushed[a])
        bend = 0.5 * car.pull * car.omega**2 * radius * radius
        noise = car.slack * (2.0 + (abs(x) + radius) / car.reach)  # the roundings of this loop
        rest = car.growth(scale, slope) * rest + kick * (bend + noise)
        chosen = thrust
        if switch < switches and boxes.steps[switch] == step - 1:
            chosen = boxes.middles[box, switch]
            pushed[switch] = car.impulse * boxes.halves[box, switch]
            moved[switch] = 0.0 if car.explicit else h * pushed[switch]
            thrust, switch = -thrust, switch + 1
        before = v
        v = car.keep * v + car.impulse * chosen - car.pull * math.cos(car.omega * x)
        x += h * (before if car.explicit else v)
        greatest = limit.sign * v + rest if limit.of_velocity else limit.sign * x + rest / scale
        for a in range(switches + 1):
            greatest += abs(pushed[a] if limit.of_velocity else moved[a])
            boxes.widest[a] = max(boxes.widest[a], abs(moved[a]))
        if step >= first and not greatest < limit.value:  # beyond also where it is NaN
            return step
    return most


def first_possible(car: Relaxed, start: Segment, limit: Limit, most: int, patience: int, boxes: Boxes) -> int:
    """The first step after which any drive may be beyond the limit; ``most`` if none is before.

    Args:
        car: what is driven.
        start: where it may start.
        limit: what is looked for.
        most: where to stop; no more than ``MAX_SWITCHES`` switches fit in it.
        patience: after that many boxes none is halved any more.
        boxes: room to work in.
    """
    switches, gap = 0, limit.spacing.gap
    while switches <= MAX_SWITCHES and first_pattern(
        boxes.steps, switches, gap, most - 1 - limit.spacing.last
    ):
        more = True
        while more:
            boxes.whole(switches)
            waiting = 0
            while waiting >= 0:
                step = first_beyond(car, start, limit, switches, waiting, most, boxes)
                patience -= 1
                if step >= most:
                    waiting -= 1
                elif patience < 0 or boxes.depths[waiting] >= DEPTH:
                    most, waiting = step, waiting - 1
                else:
                    boxes.halve(waiting, switches)
                    waiting += 1
            more = next_pattern(boxes.steps, switches, gap, most - 1 - limit.spacing.last)
        switches += 1
    return most


def exclude(car: Relaxed, starts: Floats, limit: Limit, patience: int, lower: Integers, boxes: Boxes) -> None:
    """The first step after which a car from each segment of starts may be beyond the limit.

    Args:
        car: what is driven.
        starts: the segments, shape (starts, 4).
        limit: what is looked for.
        patience: for each segment, see ``first_possible``.
        lower: where to stop, shape (starts,); lowered in place.
        boxes: room to work in.
    """
    for number in range(starts.shape[0]):
        start = Segment(starts[number, 0], starts[number, 1], starts[number, 2], starts[number, 3])
        lower[number] = first_possible(car, start, limit, lower[number], patience, boxes)
