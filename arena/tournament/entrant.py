"""An entrant: an agent class with its parameters, under a name."""

import inspect
import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from agents import agent_name
from agents.parameters.declared import settle_all
from agents.registry import check_methods
from arena.common.plain import plain
from arena.plugins.freshness import check_fresh, code_of
from arena.plugins.loading import PluginSource, source_of
from arena.plugins.unavailable import Unavailable
from envs.foundation.errors import InvalidTypeError, InvalidValueError, naming


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
    _code: Mapping[str, str] = field(compare=False, repr=False)

    def __init__(self, name: str, agent: type[Any], /, **parameters: Any) -> None:
        if not isinstance(name, str) or not name.strip() or not name.isprintable():
            raise InvalidValueError(f"name must be a printable text that is not empty, got {name!r}")
        check_methods(agent)
        object.__setattr__(self, "name", name)
        object.__setattr__(self, "agent", agent)
        with naming(f"entrant {name!r}"):
            complete = settle_all(agent, agent_name(agent), parameters)
        object.__setattr__(self, "parameters", complete)
        object.__setattr__(self, "given", frozenset(parameters))
        code_of(agent)  # what is edited from now on is not what this process has imported
        object.__setattr__(self, "_code", {})

    def __reduce__(self) -> tuple[Any, ...]:
        classes = (self.agent, *map(type, self.parameters.values()))
        parts = (self.name, self.agent, dict(self.parameters), self.given)
        return _revive, (source_of(*classes), *parts, code_of(self.agent))

    def create(self, task: Any, rng: np.random.Generator) -> Any:
        """The agent, before it has learned anything.

        Args:
            task: the hill.
            rng: handed to ``create`` if it has a parameter of that name.
        """
        check_fresh(self.agent, self._code)
        maker = getattr(self.agent, "create", None)
        if maker is None:
            return self.agent(**self.parameters)
        extra = {"rng": rng} if "rng" in inspect.signature(maker).parameters else {}
        return maker(task, **self.parameters, **extra)

    def with_parameters(self, **parameters: Any) -> "Entrant":
        """The same entrant with other parameters."""
        given = {name: self.parameters[name] for name in self.given}
        return Entrant(self.name, self.agent, **(given | parameters))

    @property
    def unavailable(self) -> str:
        """Why its agent cannot be had, one sentence; empty if it can."""
        return self.agent.reason if issubclass(self.agent, Unavailable) else ""

    def to_dict(self) -> dict[str, Any]:
        """Name, agent's name and all parameters, as plain values that JSON and TOML can hold.

        Of an agent that cannot be had these are the name and the parameters that were asked for.
        """
        description = {
            "name": self.name,
            "agent": agent_name(self.agent),
            "parameters": plain(self.parameters),
        }
        return (
            description | {"agent": self.agent.asked, "unavailable": True}
            if self.unavailable
            else description
        )


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
        TypeError, ValueError: as ``Entrant`` does, and when a sweep is no list or is empty, or its
            parameter is given as well.
    """
    if not isinstance(over, Mapping):
        raise InvalidTypeError(f"over must be a mapping from parameters to lists of values, got {over!r}")
    for key, values in over.items():
        if key in parameters:
            raise InvalidValueError(
                f"sweep of {key} must not be of a parameter that is given, got {parameters[key]!r}"
            )
        if not isinstance(values, Sequence) or isinstance(values, str) or not values:
            raise InvalidValueError(
                f"sweep of {key} must be a list of values that is not empty, got {values!r}"
            )
    for values in itertools.product(*over.values()):
        chosen = dict(zip(over, values, strict=True))
        label = " ".join([name, *(_label(key, value) for key, value in chosen.items())])
        yield Entrant(label, agent, **parameters, **chosen)


def _revive(
    _plugins: tuple[PluginSource, ...],
    name: str,
    agent: type[Any],
    parameters: dict[str, Any],
    given: frozenset[str],
    code: Mapping[str, str],
) -> Entrant:
    """What was pickled; the plugins come first, so that the classes of the rest are found."""
    entrant = object.__new__(Entrant)
    parts = {"name": name, "agent": agent, "parameters": parameters, "given": given, "_code": code}
    for key, value in parts.items():
        object.__setattr__(entrant, key, value)
    return entrant


def _label(name: str, value: Any) -> str:
    if isinstance(value, (list, tuple)) and all(isinstance(part, int) for part in value):
        return "x".join(map(str, value))
    return f"{name}={value}"
