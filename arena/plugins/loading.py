"""Agents from a file: loaded by path, sent to workers as text, never run stale.

The file becomes a module whose name ends in a hash of its text. So an edited file is another module, in
this process and in warm workers, and its machine code is cached like any other's.
"""

import hashlib
import linecache
import os
import re
import sys
import types
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from agents.registry import forget, register
from envs.foundation.errors import ArenaError, InvalidValueError


class PluginError(InvalidValueError):
    """A plugin that cannot be used; the message is one sentence that names it.

    Attributes:
        agents: what its agents would be called; None if it cannot even be read.
    """

    agents: frozenset[str] | None = None


@dataclass(frozen=True)
class PluginSource:
    """The text of a plugin. To unpickle it is to load it, so that classes after it are found.

    Attributes:
        module: name of the module it becomes.
        path: of the file, for tracebacks.
        text: what was in the file.
    """

    module: str
    path: str
    text: str

    @property
    def agents(self) -> frozenset[str]:
        """What its classes would be called as agents, even if it is not Python."""
        return frozenset(map(kebab, re.findall(r"^[ \t]*class[ \t]+(\w+)", self.text, re.MULTILINE)))

    def load(self) -> types.ModuleType:
        """The module; run once a process."""
        if self.module not in sys.modules:
            module = types.ModuleType(self.module)
            module.__file__ = self.path
            vars(module)["__arena_plugin__"] = self
            lines = self.text.splitlines(keepends=True)
            linecache.cache[self.path] = (len(self.text), None, lines, self.path)
            sys.modules[self.module] = module
            try:
                exec(compile(self.text, self.path, "exec", dont_inherit=True), vars(module))  # noqa: S102 (named by the user)
            except BaseException:
                del sys.modules[self.module]
                raise
        return sys.modules[self.module]

    def __reduce__(self) -> tuple[Any, ...]:
        return _revive, (self.module, self.path, self.text)


def load_plugin(path: str | Path) -> dict[str, type[Any]]:
    """Load the agents that the file ``path`` defines, and make them known by name.

    An agent is a class, defined there and public, with the methods of ``agents.Agent``. ``SpeedSeeker``
    is called ``speed-seeker``. What the file defined before it was edited is forgotten.

    Returns:
        The classes by name.

    Raises:
        PluginError: when the file cannot be read or run, or defines no agent or a bad one.
    """
    path = Path(path)
    origin = f"plugin {os.path.realpath(path)}"
    forget(origin)
    source = _read(path)
    try:
        return _register(path, source, origin)
    except PluginError as error:
        error.agents = source.agents
        raise


def source_of(*classes: type[Any]) -> tuple[PluginSource, ...]:
    """The plugins that the classes or their bases come from."""
    modules = {base.__module__ for cls in classes for base in cls.__mro__}
    plugins = (getattr(sys.modules.get(name), "__arena_plugin__", None) for name in sorted(modules))
    return tuple(plugin for plugin in plugins if plugin is not None)


def kebab(name: str) -> str:
    """What an agent is called whose class is ``name``: ``speed-seeker`` for ``SpeedSeeker``."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "-", name).lower().replace("_", "-")


def _revive(module: str, path: str, text: str) -> PluginSource:
    source = PluginSource(module, path, text)
    source.load()
    return source


def _read(path: Path) -> PluginSource:
    try:
        text = path.read_text(encoding="utf-8-sig")  # some editors begin a file with a mark
    except FileNotFoundError:
        raise PluginError(f"there is no plugin file {path}") from None
    except (OSError, ValueError) as error:  # undecodable, or a path with a null character
        raise PluginError(f"plugin {path} cannot be read: {error}") from error
    stem = re.sub(r"\W", "_", path.stem)
    digest = hashlib.sha256(text.encode()).hexdigest()[:12]
    return PluginSource(f"{stem}_{digest}", str(path.resolve()), text)


def _register(path: Path, source: PluginSource, origin: str) -> dict[str, type[Any]]:
    try:
        module = source.load()
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # whatever its code raises; sys.exit, too
        raise PluginError(f"plugin {path}{_place(error, source.path)}: {_reason(error)}") from error
    classes: dict[str, type[Any]] = {}
    for cls in vars(module).values():
        if _meant_as_agent(cls, source.module):
            other = classes.setdefault(kebab(cls.__name__), cls)
            if other is not cls:
                raise PluginError(
                    f"plugin {path}: {other.__name__} and {cls.__name__} would both be called "
                    f"{kebab(cls.__name__)!r}"
                )
    if not classes:
        raise PluginError(f"plugin {path} defines no agent: a class with the methods act, learn and greedy")
    for name, cls in classes.items():
        try:
            register(name, cls, origin)
        except ArenaError as error:
            forget(origin)  # all of it or nothing
            raise PluginError(f"plugin {path}: {error}") from error
    return classes


def _meant_as_agent(cls: Any, module: str) -> bool:
    if not isinstance(cls, type) or cls.__module__ != module or cls.__name__.startswith("_"):
        return False
    methods = sum(callable(getattr(cls, name, None)) for name in ("act", "learn", "greedy"))
    return methods > 1  # one that lacks one is an agent with a mistake


def _place(error: BaseException, path: str) -> str:
    """The line of the plugin where it went wrong."""
    if isinstance(error, SyntaxError) and error.filename == path:
        return f", line {error.lineno}"
    line, trace = 0, error.__traceback__
    while trace:
        if trace.tb_frame.f_code.co_filename == path:
            line = trace.tb_lineno
        trace = trace.tb_next
    return f", line {line}" if line else ""


def _reason(error: BaseException) -> str:
    text = " ".join((error.msg if isinstance(error, SyntaxError) else str(error)).split())
    return f"{type(error).__name__}: {text}" if text else type(error).__name__
