"""A tournament as a TOML file."""

import logging
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import fields
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from agents import agent_class
from agents.registry import BrokenAgentError, all_agents
from arena.plugins.loading import PluginError, load_plugin
from arena.plugins.unavailable import unavailable
from arena.tournament.conditions import Evaluation, Training
from arena.tournament.entrant import Entrant, sweep
from arena.tournament.tournament import Tournament
from envs import Hill
from envs.foundation.checks import choice
from envs.foundation.errors import InvalidTypeError, InvalidValueError, naming

_KEYS = (*(field.name for field in fields(Tournament)), "plugins")
_log = logging.getLogger("arena")
_ENTRANT_KEYS = ("name", "agent", "parameters", "sweep")


def load_tournament(path: str | Path, **changes: Any) -> Tournament:
    """The tournament that the TOML file ``path`` describes.

    Its tables are the arguments of ``Tournament``, ``Hill``, ``Training`` and ``Evaluation``; each
    ``[[entrants]]`` has an ``agent`` and may have a ``name``, ``parameters`` and a ``sweep``. Its
    ``plugins`` are files with agents, relative to its folder. The entrants of one that is broken, or of
    an installed package that is, fail; the others race.

    Args:
        path: of the file; its stem is the tournament's name if the file gives none.
        changes: arguments of ``Tournament`` that override the file's.

    Raises:
        TypeError, ValueError: when the file cannot be read or breaks a rule; the message names it.
    """
    path = Path(path)
    content = read_toml(path, "tournament file")
    with naming(str(path)):
        return from_dict({"name": path.stem, **content, **changes}, path.parent)


def read_toml(path: str | Path, what: str = "file") -> dict[str, Any]:
    """What the TOML file ``path`` says.

    Raises:
        ValueError: when it cannot be read; the message names it, and says ``what`` there is not.
    """
    try:
        text = Path(path).read_text(encoding="utf-8-sig")  # some editors begin a file with a mark
        return tomllib.loads(text)
    except FileNotFoundError:
        raise InvalidValueError(f"there is no {what} {path}") from None
    except OSError as error:
        raise InvalidValueError(f"{path}: {error.strerror or error}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InvalidValueError(f"{path} is not a TOML file: {error}") from error


def from_dict(content: Mapping[str, Any], folder: Path = Path()) -> Tournament:
    """The tournament described by plain values, as ``Tournament.to_dict`` tells them.

    Args:
        content: the values.
        folder: where its plugins are.

    Raises:
        TypeError, ValueError: when something breaks its rule.
    """
    for key in content:
        choice("key of the tournament", key, _KEYS)
    arguments = dict(content)
    kinds: dict[str, type[Any]] = {"hill": Hill, "training": Training, "evaluation": Evaluation}
    for key, kind in kinds.items():
        if key in arguments:
            arguments[key] = build(key, kind, arguments[key])
    broken = _load_plugins(arguments.pop("plugins", []), folder)
    tables = arguments.pop("entrants", [])
    if not isinstance(tables, list):
        raise InvalidTypeError(f"entrants must be a list of tables, got {tables!r}")
    return Tournament(tuple(entrant for table in tables for entrant in _entrants(table, broken)), **arguments)


def _load_plugins(plugins: Any, folder: Path) -> list[PluginError]:
    """Load them; what is wrong with those that are broken."""
    if not isinstance(plugins, list) or not all(isinstance(plugin, str) for plugin in plugins):
        raise InvalidTypeError(f"plugins must be a list of files, got {plugins!r}")
    broken = []
    for plugin in plugins:
        try:
            load_plugin(folder / plugin)
        except PluginError as error:
            broken.append(error)
            _log.warning("%s", error)
    return broken


def build(name: str, kind: type[Any], table: Any) -> Any:
    """A ``kind`` from the table ``name``, whose keys are its arguments.

    Raises:
        TypeError, ValueError: when it is no table, or breaks a rule.
    """
    if not isinstance(table, Mapping):
        raise InvalidTypeError(f"{name} must be a table, got {table!r}")
    known = getattr(kind, "_fields", None) or tuple(kind.__dataclass_fields__)
    for key in table:
        choice(f"key of {name}", key, known)
    return kind(**table)


def _agent(name: Any, broken: list[PluginError]) -> type[Any]:
    """The class called ``name``; what stands in for it if it is, or may be, one of a broken plugin.

    Raises:
        ValueError: when there is none, or the name is a misspelt one.
    """
    try:
        return agent_class(name)
    except BrokenAgentError as error:
        _log.warning("%s", error)
        return unavailable(name, str(error))
    except InvalidValueError:
        if not broken or not isinstance(name, str) or not name.isprintable():
            raise
    known = {*all_agents()[0]}.union(*(plugin.agents or () for plugin in broken))
    unread = any(plugin.agents is None for plugin in broken)
    if name not in known and not unread and get_close_matches(name, known, n=1):
        choice("agent", name, known)
    reasons = [str(plugin) for plugin in broken if name in (plugin.agents or ())] or map(str, broken)
    return unavailable(name, f"agent {name!r} is not available: {'; '.join(reasons)}")


def _entrants(table: Any, broken: list[PluginError]) -> Iterator[Entrant]:
    if not isinstance(table, Mapping):
        raise InvalidTypeError(f"each of entrants must be a table, got {table!r}")
    for key in table:
        choice("key of an entrant", key, _ENTRANT_KEYS)
    if "agent" not in table:
        raise InvalidValueError("each of entrants must have an agent")
    name = table.get("name", table["agent"])
    agent = _agent(table["agent"], broken)
    parameters, over = table.get("parameters", {}), table.get("sweep", {})
    for key, value in (("parameters", parameters), ("sweep", over)):
        if not isinstance(value, Mapping):
            raise InvalidTypeError(f"{key} of entrant {name!r} must be a table, got {value!r}")
    yield from sweep(name, agent, over, **parameters) if over else [Entrant(name, agent, **parameters)]
