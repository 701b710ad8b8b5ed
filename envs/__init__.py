"""The hill and the environments over it: physics, PettingZoo, Gymnasium, random streams, compilation."""

from envs.hill import Dynamics, Hill, Integrator
from envs.registration import register_with_gymnasium, register_with_pettingzoo, when_imported

__all__ = ["Dynamics", "Hill", "Integrator"]

when_imported("gymnasium", register_with_gymnasium)
when_imported("pettingzoo", register_with_pettingzoo)
