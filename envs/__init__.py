"""The hill and the environments over it: physics, PettingZoo, random streams, compilation."""

from envs.hill import Dynamics, Hill, Integrator

__all__ = ["Dynamics", "Hill", "Integrator"]
