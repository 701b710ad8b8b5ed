"""The hill and the environments over it: physics, PettingZoo, random streams, compilation."""

from envs.hill import Hill, Integrator

__all__ = ["Hill", "Integrator"]
