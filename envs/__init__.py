"""The hill and the environments over it: physics, PettingZoo, Gymnasium, random streams, compilation."""

from envs.foundation.errors import ArenaError, InvalidTypeError, InvalidValueError
from envs.hill import Dynamics, Hill, Integrator
from envs.registration import register_with_gymnasium, register_with_pettingzoo, when_imported

__all__ = ["ArenaError", "Dynamics", "Hill", "Integrator", "InvalidTypeError", "InvalidValueError"]

when_imported("gymnasium", register_with_gymnasium)
when_imported("pettingzoo", register_with_pettingzoo)
