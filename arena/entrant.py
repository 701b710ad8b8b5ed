"""An entrant: an agent class with its parameters, under a name."""

import inspect
import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

import numpy as np

from agents import agent_name
from envs.checks import choice

_METHODS = ("act", "learn", "greedy")


@dataclass(frozen=True, init=False)
class Entrant:
    """Who races: ``Entrant("sarsa 20x30", Sarsa, bins=(20, 30))``.

    Attributes:
        name: what results, and the entrant's random streams, go by.
        agent: the class; see ``agents.Agent`` for what it must have.
        parameters: all of its parameters by name, those not given at their defaults.
        given: names of the parameters that were given.

    Raises:
        TypeError: when the class lacks a method, or a parameter is unknown or missing.
        ValueError: when the name is empty.
    """

    name: str
    agent: type[Any]
    parameters: Mapping[str, Any] = field(hash=False)
    given: frozenset[str] = field(compare=False)

    def __init__(self, name: str, agent: type[Any], /, **parameters: Any) -> None:
        if not isinstance(name, str) or not name.strip() or not name.isprintable():
            raise ValueError(f"name must be a printable text that is not empty, got {name!r}")
        if not isinstance(agent, type):
            raise TypeError(f"agent must be a class, got {agent!r}")
        for method in _METHODS:
            if not callable(getattr(agent, method, None)):
                raise TypeError(
                    f"agent must have the methods {', '.join(_METHODS)}; {agent!r} lacks {method}"
                )
        object.__setattr__(self, "name", name)
        object.__setattr__(self, "agent", agent)
        object.__setattr__(self, "parameters", _complete(agent, parameters))
        object.__setattr__(self, "given", frozenset(parameters))

    def create(self, task: Any, rng: np.random.Generator) -> Any:
        """The agent, before it has learned anything.

        Args:
            task: the hill.
            rng: handed to ``create`` if it has a parameter of that name.
        """
        maker = getattr(self.agent, "create", None)
        if maker is None:
            return self.agent(**self.parameters)
        extra = {"rng": rng} if "rng" in inspect.signature(maker).parameters else {}
        return maker(task, **self.parameters, **extra)

    def with_parameters(self, **parameters: Any) -> "Entrant":
        """The same entrant with other parameters."""
        given = {name: self.parameters[name] for name in self.given}
        return Entrant(self.name, self.agent, **(given | parameters))

    def to_dict(self) -> dict[str, Any]:
        """Name, agent's name and all parameters, as plain values that JSON and TOML can hold."""
        return {
            "name": self.name,
            "agent": agent_name(self.agent),
            "parameters": {name: plain(value) for name, value in self.parameters.items()},
        }


def sweep(
    name: str, agent: type[Any], /, over: Mapping[str, Sequence[Any]], **parameters: Any
) -> Iterator[Entrant]:
    """One entrant for each combination of the values in ``over``.

    Each is called ``name`` and its values: ``sweep("sarsa", Sarsa, over={"bins": [(20, 30)]})``
    gives ``sarsa 20x30``.

    Args:
        name: what the names begin with.
        agent: the class.
        over: the values of each parameter that is swept.
        parameters: those that all have in common.

    Raises:
        TypeError, ValueError: as ``Entrant`` does, and when a sweep is no list or is empty.
    """
    for key, values in over.items():
        if not isinstance(values, Sequence) or isinstance(values, str) or not values:
            raise ValueError(f"sweep of {key} must be a list of values that is not empty, got {values!r}")
    for values in itertools.product(*over.values()):
        chosen = dict(zip(over, values, strict=True))
        label = " ".join([name, *(_label(key, value) for key, value in chosen.items())])
        yield Entrant(label, agent, **parameters, **chosen)


def plain(value: Any) -> Any:
    """``value`` of numbers, texts, lists and dictionaries only."""
    if isinstance(value, Enum):
        return value.name.lower().replace("_", "-")
    if isinstance(value, np.generic):
        return value.item()
    if hasattr(value, "_asdict"):
        return plain(value._asdict())
    if isinstance(value, Mapping):
        return {str(key): plain(part) for key, part in value.items()}
    if isinstance(value, (Sequence, np.ndarray)) and not isinstance(value, (str, bytes)):
        return [plain(part) for part in value]
    return value if value is None or isinstance(value, (bool, int, float, str)) else repr(value)


def _complete(agent: type[Any], given: Mapping[str, Any]) -> dict[str, Any]:
    """``given`` and the defaults of the rest, in the order in which the agent declares them."""
    signature = inspect.signature(getattr(agent, "create", agent))
    declared = {
        name: parameter
        for name, parameter in signature.parameters.items()
        if name != "rng" and (parameter.kind is parameter.KEYWORD_ONLY or not hasattr(agent, "create"))
    }
    free = any(parameter.kind is parameter.VAR_KEYWORD for parameter in declared.values())
    declared = {
        name: parameter
        for name, parameter in declared.items()
        if parameter.kind not in (parameter.VAR_KEYWORD, parameter.VAR_POSITIONAL)
    }
    for name in given:
        if not free:
            choice(f"parameter of {agent_name(agent)}", name, declared)
    missing = [n for n, p in declared.items() if p.default is p.empty and n not in given]
    if missing:
        raise TypeError(f"parameter {missing[0]} of {agent_name(agent)} must be given")
    complete = {}
    for name in [*declared, *(n for n in given if n not in declared)]:
        default = declared[name].default if name in declared else None
        complete[name] = _settle(name, given[name], default) if name in given else default
    return complete


def _settle(name: str, value: Any, default: Any) -> Any:
    """Lists as tuples, and a table of a file as the named tuple that the default is."""
    if isinstance(value, Mapping) and hasattr(type(default), "_fields"):
        kind = type(default)
        for key in value:
            choice(f"field of {name}", key, kind._fields)
        return kind(**value)
    return tuple(value) if isinstance(value, list) else value


def _label(name: str, value: Any) -> str:
    if isinstance(value, (list, tuple)) and all(isinstance(part, int) for part in value):
        return "x".join(map(str, value))
    return f"{name}={value}"
