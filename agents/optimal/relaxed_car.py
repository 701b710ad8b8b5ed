"""How far apart the switches of an optimal drive are: the theory behind ``agents.optimal``.

Let go of the hill's clips, and let the thrust be any u in [-1, 1] times the full one. The car is then the
*relaxed car*::

    v[k+1] = b v[k] + c u[k] + G(x[k])      x[k+1] = x[k] + h v[k+1]   (explicit: + h v[k])

with b = 1 - h k_f / m, c = h F / m and G(x) = -h g omega cos(omega x), so that |G'| <= h g omega^2.

*Maximum principle* (Pontryagin; in discrete time, with controls that enter linearly, it is no more than
the condition of first order). Fix n. x[n] is a smooth function of u on the cube [-1, 1]^n and has a
maximum there. At it u[k] is the sign of s[k], the derivative of x[n] by an impulse in step k, wherever
s[k] is not 0. By the chain rule::

    semi-implicit:  s[k-1] = (1 + b + h G'(x[k])) s[k] - b s[k+1],              s[n-1] = h, s[n] = 0
    explicit:       s[k-1] = (1 + b) s[k] - (b - h G'(x[k+1])) s[k+1],          s[n-2] = h, s[n-1] = 0

*Sturm comparison*. Write A and B for the factors of s[k] and s[k+1]; let B > 0. The quotient
r = s[k-1] / s[k] is A - B / r', where r' is the quotient of the step after it; it grows with A and r' and
falls with B. So, until it is 0 or less, it is at least the quotient of the recurrence with the least A
and the greatest B that starts alike; s keeps its sign until that quotient is 0 or less. Beyond a change
of sign, s[k] < 0 < s[k+1], it is r = A + B |s[k+1] / s[k]| >= A: all begins anew as it began at the end,
where r = A. Where s[k] is 0, s[k-1] = -B s[k+1]: the sign changes, and u[k] may be anything.

Hence the maximum of x[n] is attained by blocks of full thrust, alternately left and right, the last one
right, with at least ``gap`` steps in each but the first, ``last`` in the last one; where two blocks meet one
step may have any thrust. Mirrored this holds for the minimum of x[n], and likewise for the extremes of
v[n], where the recurrence starts with r = A - 1.

The condition B > 0 is b > 0 (semi-implicit) or b > h^2 g omega^2 (explicit).

Sources: L. S. Pontryagin et al., The Mathematical Theory of Optimal Processes, 1962; W. Kelley & A.
Peterson, Difference Equations, 2nd ed. 2001, chapter 6 (Sturm comparison).
"""

import math
from typing import NamedTuple, Self

from envs import Dynamics, Hill, Integrator

NEVER = 1_000_000
"""Steps from where the goal is not reached; as a lower bound, it is proved that it cannot be (in fewer)."""

MAX_SWITCHES = 12
"""Switches that are looked at, at most."""

_UNIT = 2.0**-53  # the relative error of a rounding
_DOUBT = 1e-6  # far more than the roundings of a quotient: one as near to 0 may be 0


class Relaxed(NamedTuple):
    """The car without clips and with any thrust, on one hill.

    A step of the hill, rounded as it is, is an exact step of the relaxed car with an impulse of at most
    ``slack`` besides, if v[k] is read as (x[k] - x[k-1]) / h: then a rounding of the position is an impulse,
    too. So ``impulse``, the greatest one, is c + ``slack``, and what is proved for all thrusts of the
    relaxed car is proved for the hill's floats.

    Attributes:
        keep: share b of the velocity that friction leaves in a step.
        impulse: greatest change c of the velocity by the thruster in a step.
        pull: h g omega, greatest change of the velocity by gravity in a step.
        stiffness: h^2 g omega^2, greatest h G'.
        omega: of the hill.
        time_step: h.
        explicit: whether the old velocity moves the position.
        simplified: whether the hill's dynamics are those of the relaxed car, but for its clips.
        reach: the greatest distance of a position from 0.
        slack: more than the error of a step by rounding, as a velocity, where ``|x| <= reach``.
    """

    keep: float
    impulse: float
    pull: float
    stiffness: float
    omega: float
    time_step: float
    explicit: bool
    simplified: bool
    reach: float
    slack: float

    @classmethod
    def of(cls, hill: Hill) -> Self:
        """The relaxed car on ``hill``."""
        h, pull = hill.time_step, hill.time_step * hill.gravity * hill.omega
        thrust = h * hill.thrust / hill.mass
        reach = max(abs(hill.min_position), abs(hill.max_position))
        speed = max(abs(hill.min_velocity), hill.max_velocity)
        # A step has about ten operations; each errs by at most a unit of what it computes.
        slack = 16.0 * _UNIT * (reach / h + speed + thrust + pull * (1.0 + hill.omega * reach))
        return cls(
            1.0 - h * hill.friction / hill.mass,
            thrust + slack,
            pull,
            h * pull * hill.omega,
            hill.omega,
            h,
            hill.integrator == Integrator.EXPLICIT,
            hill.dynamics == Dynamics.SIMPLIFIED,
            reach,
            slack,
        )

    @property
    def applies(self) -> bool:
        """Whether the conditions of the theory hold, with something to spare."""
        return self.simplified and self.keep - (self.stiffness if self.explicit else 0.0) > _DOUBT

    def growth(self, scale: float, slope: float) -> float:
        """How much longer a step makes a small difference (x, v) of two drives with the same thrust, at most.

        Args:
            scale: of positions: the length of (x, v) is that of (``scale`` x, v).
            slope: G'.

        Returns:
            The spectral norm of the step's matrix.
        """
        turn, back = scale * self.time_step, slope / scale
        if self.explicit:
            squares = 1.0 + turn * turn + back * back + self.keep * self.keep
            determinant = self.keep - turn * back
        else:
            first, second = 1.0 + turn * back, turn * self.keep
            squares = first * first + second * second + back * back + self.keep * self.keep
            determinant = self.keep
        root = math.sqrt(max(squares * squares - 4.0 * determinant * determinant, 0.0))
        return math.sqrt(0.5 * (squares + root)) * (1.0 + 1e-12)


class Spacing(NamedTuple):
    """The least number of steps between two switches, and from the last one to the end."""

    gap: int
    last: int


def spacing(car: Relaxed, *, of_velocity: bool) -> Spacing:
    """How far apart the switches are at an extreme of the position or of the velocity.

    Args:
        car: one to which the theory applies.
        of_velocity: whether it is an extreme of the velocity.
    """
    a, b = 1.0 + car.keep, car.keep
    if car.explicit:
        b += car.stiffness
    else:
        a -= car.stiffness
    last = _same_sign(a - 1.0 if of_velocity else a, a, b)
    if car.explicit and not of_velocity:
        last += 1  # the last thrust moves no position any more
    return Spacing(_same_sign(a, a, b), last)


def _same_sign(quotient: float, a: float, b: float) -> int:
    """The number of terms in a row that surely have the same sign, if the first two have that quotient."""
    discriminant = a * a - 4.0 * b
    if discriminant >= 0.0 and quotient >= 0.5 * (a - math.sqrt(discriminant)):
        return NEVER  # no oscillation: the quotient stays above a fixed point of r = a - b / r
    terms = 1
    while quotient > _DOUBT and terms < NEVER:
        terms += 1
        quotient = a - b / quotient
    return terms


def patterns(spacing: Spacing, horizon: int) -> float:
    """Ways to place switches in ``horizon`` steps; infinite if more than ``MAX_SWITCHES`` fit."""
    total, switches = 1, 1
    while (free := horizon - spacing.last - (switches - 1) * spacing.gap) >= 0:
        if switches > MAX_SWITCHES:
            return math.inf
        total += math.comb(free + switches, switches)
        switches += 1
    return total
