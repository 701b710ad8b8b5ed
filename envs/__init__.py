"""The hill and the environments over it: physics, PettingZoo, Gymnasium, random streams, compilation."""

from typing import TYPE_CHECKING

from envs.foundation.errors import ArenaError, InvalidTypeError, InvalidValueError
from envs.foundation.lazy import lazily
from envs.registration import register_with_gymnasium, register_with_pettingzoo, when_imported

if TYPE_CHECKING:
    from envs.hill import Dynamics, Hill, Integrator
else:  # without numpy, until there is a hill
    __getattr__, __dir__ = lazily(__name__, {"envs.hill": ("Dynamics", "Hill", "Integrator")})

__all__ = ["ArenaError", "Dynamics", "Hill", "Integrator", "InvalidTypeError", "InvalidValueError"]

when_imported("gymnasium", register_with_gymnasium)
when_imported("pettingzoo", register_with_pettingzoo)
