"""What results come from: versions of the packages, and the code of the agents."""

import hashlib
import inspect
import platform
from collections.abc import Iterable
from importlib import metadata
from typing import Any

from agents import agent_name
from agents.interop.policy_agent import PolicyAgent
from arena.plugins.loading import source_of


def versions() -> dict[str, str]:
    """Versions of what computes the results."""
    packages = ["mountain-car-arena", "numpy", "numba", "pettingzoo", "gymnasium", "joblib"]
    environment = {"python": platform.python_version(), "platform": platform.platform()}
    for package in packages:
        try:
            environment[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            environment[package] = "not installed"
    return environment


def source_digests(agents: Iterable[type[Any]]) -> dict[str, str]:
    """A hash of each agent's code, of a plugin's whole file, by its name; empty where it is not found."""
    digests = {}
    for agent in agents:
        plugins = source_of(agent)
        try:
            code = "".join(plugin.text for plugin in plugins) or inspect.getsource(_written(agent))
        except (OSError, TypeError):  # typed in at a prompt
            code = ""
        digests[agent_name(agent)] = hashlib.sha256(code.encode()).hexdigest() if code else ""
    return digests


def _written(agent: type[Any]) -> type[Any]:
    """The class whose text there is: ``PolicyAgent`` for the classes that ``PolicyAgent.of`` makes."""
    return PolicyAgent if agent.__bases__ == (PolicyAgent,) and agent.__name__ == "PolicyAgent" else agent
