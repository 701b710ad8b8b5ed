"""How far apart the switches of an optimal drive are.

The theory behind ``agents.optimal``. Let go of the hill's clips, and let the thrust be any u in [-1, 1]
times the full one. The car is then the *relaxed car*::

    v[k+1] = b v[k] + c u[k] + G(x[k])      x[k+1] = x[k] + h v[k+1]   (explicit: h v[k])

with b = 1 - h k_f / m, c = h F / m and G(x) = -h g omega cos(omega x), so |G'| <= h g omega^2.

*Maximum principle* (Pontryagin; in discrete time, with controls that enter linearly, it is no more than the
condition of first order). Fix n. x[n] is a smooth function of u on the cube [-1, 1]^n and has a
maximum there. At it u[k] is the sign of s[k], the derivative of x[n] by an impulse at step k, wherever
s[k] is not 0. By the chain rule, with s[n] = 0 and s[n-1] = h > 0::

    semi-implicit:  s[k-1] = (1 + b + h G'(x[k])) s[k] - b s[k+1]
    explicit:       s[k-1] = (1 + b) s[k] - (b - h G'(x[k+1])) s[k+1],  s[n-1] = 0, s[n-2] = h

*Sturm comparison*. With the factors A of s[k] and B > 0 of s[k+1], the quotient r = s[k-1] / s[k] obeys
r = A - B / r', where r' is the one of the step after it. It grows with r', with A, and as B falls. So it
is never less than the quotient of the recurrence with the least A and the greatest B, started alike; and
s cannot change its sign before that quotient reaches 0. After a change of sign r = A + B |s[k+1] / s[k]|
>= A: all begins anew as it began at the end, where r = A. An s[k] that is exactly 0 only separates two
signs, as s[k-1] = -B s[k+1] then; its u[k] is undetermined.

Hence the maximum of x[n] is attained by blocks of full thrust, alternately left and right, the last one
right, with at least ``gap`` steps in each but the first and ``last`` in the last one; where two blocks
meet one step may have any thrust. Mirrored this holds for the minimum of x[n], and likewise for v[n],
where the recurrence starts with r = A - 1.

The conditions are B > 0: b > 0 (semi-implicit) or b > h^2 g omega^2 (explicit).

Sources: L. S. Pontryagin et al., The Mathematical Theory of Optimal Processes, 1962; W. Kelley & A.
Peterson, Difference Equations, 2nd ed. 2001, chapter 6 (Sturm comparison).
"""

import math
from typing import NamedTuple, Self

from envs import Hill, Integrator

FAR = 1_000_000
"""A number of steps that stands for infinity."""

MOST = 12
"""Switches that are looked at, at most."""

_UNIT = 2.0**-53  # the relative error of a rounding
_DOUBT = 1e-6  # quotients are computed to 1e-12; one that is as near to 0 may be 0


class Relaxed(NamedTuple):
    """The car without clips and with any thrust, on one hill.

    A step of the hill, rounded as it is, is an exact step of the relaxed car with an impulse of at most
    ``slack`` besides, if v[k] is read as (x[k] - x[k-1]) / h: a rounding of the position is an impulse,
    too. So ``impulse``, the greatest one, is c + ``slack``, and what is true of all thrusts of the
    relaxed car is true of the hill's floats.

    Attributes:
        keep: share b of the velocity that friction leaves in a step.
        impulse: greatest change c of the velocity by the thruster, in units of velocity.
        pull: h g omega, greatest change of the velocity by gravity.
        stiffness: h^2 g omega^2, greatest h G'.
        omega: of the hill.
        time_step: h.
        explicit: whether the old velocity moves the position.
        reach: the greatest distance of a position from 0.
        slack: the greatest error of a step, in units of velocity, while ``|x| <= reach``.
    """

    keep: float
    impulse: float
    pull: float
    stiffness: float
    omega: float
    time_step: float
    explicit: bool
    reach: float
    slack: float

    @classmethod
    def of(cls, hill: Hill) -> Self:
        """The relaxed car on ``hill``."""
        h, pull = hill.time_step, hill.time_step * hill.gravity * hill.omega
        thrust = h * hill.thrust / hill.mass
        reach = max(abs(hill.min_position), abs(hill.max_position))
        speed = max(abs(hill.min_velocity), hill.max_velocity)
        # Each of a step's ten operations errs by a unit of what it computes.
        slack = 16.0 * _UNIT * (reach / h + speed + thrust + pull * (1.0 + hill.omega * reach))
        keep = 1.0 - h * hill.friction / hill.mass
        explicit = hill.integrator == Integrator.EXPLICIT
        stiffness = h * pull * hill.omega
        return cls(keep, thrust + slack, pull, stiffness, hill.omega, h, explicit, reach, slack)

    @property
    def applies(self) -> bool:
        """Whether the conditions of the theory hold, with something to spare."""
        return self.keep - (self.stiffness if self.explicit else 0.0) > _DOUBT


class Spacing(NamedTuple):
    """The least number of steps between two switches, and after the last one."""

    gap: int
    last: int


def spacing(car: Relaxed, *, of_velocity: bool) -> Spacing:
    """How far apart the switches are at an extreme of the position or of the velocity.

    Args:
        car: one to which the theory applies.
        of_velocity: whether it is an extreme of the velocity.
    """
    stiffness, implicit = car.stiffness, not car.explicit
    a = 1.0 + car.keep - (stiffness if implicit else 0.0)
    b = car.keep + (0.0 if implicit else stiffness)
    useless = 0 if implicit or of_velocity else 1  # the last thrust moves no position
    return Spacing(
        _same_sign(a, a, b),
        useless + _same_sign(a - 1.0, a, b) if of_velocity else useless + _same_sign(a, a, b),
    )


def _same_sign(quotient: float, a: float, b: float) -> int:
    """The number of terms in a row that surely have the same sign."""
    terms = 1
    while quotient > _DOUBT and terms < FAR:
        terms += 1
        following = a - b / quotient
        if following == quotient:  # it stays there for ever
            return FAR
        quotient = following
    return terms


def patterns(spacing: Spacing, horizon: int) -> float:
    """How many ways there are to place the switches in ``horizon`` steps; infinite if more than ``MOST`` fit."""
    total, switches = 1, 1
    while (free := horizon - spacing.last - (switches - 1) * spacing.gap) >= 0:
        if switches > MOST:
            return math.inf
        total += math.comb(free + switches, switches)
        switches += 1
    return total
