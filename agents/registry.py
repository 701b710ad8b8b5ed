"""The built-in agents by the names they have in files and on the command line."""

from typing import Any

from agents.q_learning import QLearning
from agents.references import MomentumAgent, RandomAgent
from agents.sarsa import Sarsa
from envs.checks import choice

BUILT_IN: dict[str, type[Any]] = {
    "q-learning": QLearning,
    "sarsa": Sarsa,
    "random": RandomAgent,
    "momentum": MomentumAgent,
}


def agent_class(name: str) -> type[Any]:
    """The class of the agent called ``name``.

    Raises:
        ValueError: when there is none; the message lists those there are.
    """
    return BUILT_IN[choice("agent", name, BUILT_IN)]


def agent_name(cls: type[Any]) -> str:
    """The name of the class in files: a built-in's own, else ``module:Class``."""
    for name, known in BUILT_IN.items():
        if known is cls:
            return name
    return f"{cls.__module__}:{cls.__qualname__}"
