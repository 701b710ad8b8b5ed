"""The mountain car's hill and physics: Eqs. (1)-(7) of the paper."""

import math
from enum import IntEnum
from typing import NamedTuple, Self

import numpy as np

from envs.foundation.checks import Validated, choice, number
from envs.foundation.errors import InvalidTypeError

State = tuple[float, float]


class _Named(IntEnum):
    """A choice that may be given by the name that it has in files."""

    @classmethod
    def _missing_(cls, value: object) -> Self:
        names = {member.label: member for member in cls}
        return names[choice(cls.__name__.lower(), value, names)]

    @property
    def label(self) -> str:
        """The name in files, such as ``semi-implicit``."""
        return self.name.lower().replace("_", "-")


class Integrator(_Named):
    """Which velocity moves the position in a time step of Euler's method."""

    SEMI_IMPLICIT = 0
    """The new one: the order of Gymnasium, and the only one that gives the paper's walk lengths."""
    EXPLICIT = 1
    """The old one: Eq. (6) as printed."""


class Dynamics(_Named):
    """Which equation of motion is integrated; docs/physics.md derives both."""

    SIMPLIFIED = 0
    """Eq. (5) of the paper, which leaves out the vertical acceleration; that of Gymnasium, too."""
    CONSTRAINED = 1
    """The full equation of a point mass that is held on the curve."""


class _Constants(NamedTuple):
    omega: float
    mass: float
    gravity: float
    friction: float
    time_step: float
    thrust: float
    goal_position: float
    min_position: float
    max_position: float
    min_velocity: float
    max_velocity: float
    min_start: float
    max_start: float
    inelastic_wall: bool
    integrator: Integrator
    dynamics: Dynamics
    goal_reward: float


class Hill(Validated, _Constants):  # type: ignore[misc]  # both have _make
    """A car with a thruster on the hill ``y = sin(omega x)``; by default Eq. (7) of the paper.

    An immutable named tuple of constants. A state is ``(position, velocity)``; the actions are
    0 (thrust left), 1 (none) and 2 (thrust right). Positions are in units of length, velocities in
    units of length per unit of time, horizontal both. With the default constants a trajectory is
    bit-identical to that of Gymnasium's ``MountainCar-v0``.

    Args:
        omega: spatial frequency of the hill, Eq. (1); greater than 0.
        mass: of the car, m in Eq. (2); greater than 0.
        gravity: acceleration g in Eq. (3); at least 0.
        friction: coefficient k_f in Eq. (3); at least 0.
        time_step: h in Eq. (6); greater than 0.
        thrust: force F of the thruster; at least 0.
        goal_position: x_g; the episode ends when ``position >= goal_position``.
        min_position, max_position: the position is clipped to them.
        min_velocity, max_velocity: the velocity is clipped to them.
        min_start, max_start: an episode starts at rest at a position uniform between them.
        inelastic_wall: whether the car loses its velocity at ``min_position``.
        integrator: ``"semi-implicit"`` or ``"explicit"``.
        dynamics: ``"simplified"``, Eq. (5), or ``"constrained"``, the full equation of motion.
        goal_reward: reward of the step that reaches the goal; that of any other is -1.

    Raises:
        TypeError: when a constant is no number.
        ValueError: when it is not finite or breaks its rule.
    """

    __slots__ = ()

    n_actions = 3

    def __new__(  # noqa: D102 (described by the class)
        cls,
        omega: float = 3.0,
        mass: float = 1000.0,
        gravity: float = 0.0025 / 3.0,
        friction: float = 0.0,
        time_step: float = 1.0,
        thrust: float = 1.0,
        goal_position: float = 0.5,
        min_position: float = -1.2,
        max_position: float = 0.6,
        min_velocity: float = -0.07,
        max_velocity: float = 0.07,
        min_start: float = -0.6,
        max_start: float = -0.4,
        inelastic_wall: bool = True,
        integrator: Integrator | str = Integrator.SEMI_IMPLICIT,
        dynamics: Dynamics | str = Dynamics.SIMPLIFIED,
        goal_reward: float = -1.0,
    ) -> Self:
        if not isinstance(inelastic_wall, (bool, np.bool_)):
            raise InvalidTypeError(f"inelastic_wall must be true or false, got {inelastic_wall!r}")
        low = number("min_position", min_position)
        high = number("max_position", max_position, low, exclusive_low=True)
        goal = number("goal_position", goal_position, low, high, exclusive_low=True)
        start = number("min_start", min_start, low, goal)
        return super().__new__(
            cls,
            number("omega", omega, 0.0, exclusive_low=True),
            number("mass", mass, 0.0, exclusive_low=True),
            number("gravity", gravity, 0.0),
            number("friction", friction, 0.0),
            number("time_step", time_step, 0.0, exclusive_low=True),
            number("thrust", thrust, 0.0),
            goal,
            low,
            high,
            number("min_velocity", min_velocity, high=0.0),
            number("max_velocity", max_velocity, low=0.0, exclusive_low=True),
            start,
            number("max_start", max_start, start, goal),
            bool(inelastic_wall),
            Integrator(integrator),  # type: ignore[arg-type]  # its _missing_ takes names
            Dynamics(dynamics),  # type: ignore[arg-type]  # likewise
            number("goal_reward", goal_reward),
        )

    @property
    def low(self) -> State:
        """Least position and velocity."""
        return (self.min_position, self.min_velocity)

    @property
    def high(self) -> State:
        """Greatest position and velocity."""
        return (self.max_position, self.max_velocity)

    def reset(self, rng: np.random.Generator) -> State:
        """A start state: at rest, uniform in [min_start, max_start); draws one number."""
        return (self.min_start + (self.max_start - self.min_start) * rng.random(), 0.0)

    def step(self, state: State, action: int) -> tuple[State, float, bool]:
        """One time step, Eq. (6): the next state, the reward and whether it is the goal."""
        position, velocity = state
        # The order of these operations is Gymnasium's, to the bit.
        acceleration = (action - 1) * (self.thrust / self.mass) + math.cos(self.omega * position) * (
            -(self.gravity * self.omega)
        )
        acceleration -= self.friction / self.mass * velocity
        if self.dynamics == Dynamics.CONSTRAINED:
            slope, bend = self.slope(position), -(self.omega * self.omega) * self.height(position)
            acceleration = (acceleration - slope * bend * velocity * velocity) / (1.0 + slope * slope)
        moving = velocity
        velocity += self.time_step * acceleration
        # Branches, not ``min`` and ``max``: the processor predicts them and need not wait.
        if velocity < self.min_velocity:
            velocity = self.min_velocity
        elif velocity > self.max_velocity:
            velocity = self.max_velocity
        if self.integrator == Integrator.SEMI_IMPLICIT:
            moving = velocity
        position += self.time_step * moving
        if position < self.min_position:
            position = self.min_position
        elif position > self.max_position:
            position = self.max_position
        if self.inelastic_wall and position == self.min_position and velocity < 0.0:
            velocity = 0.0
        reached = position >= self.goal_position
        return (position, velocity), self.goal_reward if reached else -1.0, reached

    def observe(self, state: State) -> State:
        """What the driver sees of the state: all of it, exactly."""
        return state

    def height(self, position: float) -> float:
        """Height of the hill, Eq. (1)."""
        return math.sin(self.omega * position)

    def slope(self, position: float) -> float:
        """Slope of the hill: the derivative of its height."""
        return self.omega * math.cos(self.omega * position)
