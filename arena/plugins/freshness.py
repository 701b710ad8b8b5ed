"""Edited code: no worker runs another version of an agent than this process has.

A class of an importable module travels by its name, and so does what any class uses of such modules. A
warm worker may have imported them before they were edited and reloaded here, a new one after they were
edited on disk.
"""

import functools
import hashlib
import sys
import types
from collections.abc import Iterable, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any
from weakref import WeakKeyDictionary

from arena.plugins.source_modules import own_modules
from envs.compilation.reachable import ReachableCode, module_code

_LOADED = ""  # the key of what this process runs of the class itself; the others are names of modules
_codes: WeakKeyDictionary[type[Any], tuple[dict[str, Any], dict[str, str]]] = WeakKeyDictionary()
_loaded: WeakKeyDictionary[type[Any], str] = WeakKeyDictionary()
_texts: dict[str, tuple[Any, str]] = {}
_sent: dict[str, Mapping[str, str]] = {}
_specs: dict[str, Any] = {}


def code_of(agent: type[Any]) -> Mapping[str, str]:
    """Digests of the code that is not sent with the agent: of its class, and of the modules it uses.

    A text is read when it is first asked for, and again only when its module was reloaded: what is edited
    in between is not what this process runs.
    """
    specs, code = _codes.get(agent, ({}, {}))
    if agent not in _codes or any(_spec(name) is not spec for name, spec in specs.items()):
        names = {base.__module__ for base in agent.__mro__ if not _travels(base)}
        module = sys.modules.get(agent.__module__)
        files: dict[str, Path | None] = {**dict.fromkeys(names), **(own_modules(module) if module else {})}
        specs = {name: _spec(name) for name in files}
        digests = {name: _text(name, file) for name, file in sorted(files.items())}
        code = {name: digest for name, digest in digests.items() if digest}
        code |= {} if _travels(agent) else {_LOADED: _loaded_code(agent)}
        _codes[agent] = specs, code
    return code


def renew_workers(agents: Iterable[type[Any]]) -> None:
    """End joblib's idle workers if, since last time, a module was reloaded or an agent's code has changed."""
    edited = _reloaded()
    for agent in agents:
        name, code = f"{agent.__module__}.{agent.__qualname__}", code_of(agent)
        edited |= _sent.get(name, code) != code
        _sent[name] = code
    if edited:
        from joblib.externals.loky import get_reusable_executor

        get_reusable_executor().shutdown(wait=True)


def check_fresh(agent: type[Any], code: Mapping[str, str]) -> None:
    """See that the code here is ``code``, that of the sender.

    Raises:
        RuntimeError: when a module was edited after the sender imported it.
    """
    for name, digest in code.items():
        if (_loaded_code(agent) if name == _LOADED else _text(name)) != digest:
            edited = (
                f"{agent.__module__}.{agent.__qualname__}" if name in (_LOADED, agent.__module__) else name
            )
            raise RuntimeError(
                f"the code of {edited} was edited after it was imported: reload the module, or start anew"
            )


def _travels(cls: type[Any]) -> bool:
    """Whether the code of the class is sent to workers: it cannot be imported by its name."""
    module: Any = sys.modules.get(cls.__module__)
    if module is None or cls.__module__ == "__main__" or hasattr(module, "__arena_plugin__"):
        return True
    try:
        return functools.reduce(getattr, cls.__qualname__.split("."), module) is not cls
    except AttributeError:  # defined in a function
        return True


def _loaded_code(agent: type[Any]) -> str:
    """A digest of the functions of the class's module, and of all that is compiled with it."""
    if agent not in _loaded:
        compiled = ReachableCode(agent).fingerprint() if hasattr(agent, "_fields") else ""
        _loaded[agent] = module_code(sys.modules[agent.__module__]) + compiled
    return _loaded[agent]


def _text(name: str, file: Path | None = None) -> str:
    """A digest of the text of a module: constants are in no function. Empty if there is none."""
    spec, digest = _texts.get(name, (None, ""))
    if spec is None or spec is not _spec(name):
        file = file or _find(name)
        digest = hashlib.sha256(file.read_bytes()).hexdigest()[:16] if file and file.is_file() else ""
        _texts[name] = _spec(name), digest
    return digest


def _find(name: str) -> Path | None:
    if name not in sys.modules:
        try:
            origin = getattr(find_spec(name), "origin", None)
        except Exception:  # whatever a package raises that is imported on the way
            return None
    else:
        origin = getattr(sys.modules[name], "__file__", None)
    return Path(origin) if origin and origin.endswith(".py") else None


def _spec(name: str) -> Any:
    """What changes when the module is imported anew; None while it is not imported."""
    return getattr(sys.modules.get(name), "__spec__", None)


def _reloaded() -> bool:
    """Whether any module was imported anew since the last call: helpers of an agent, too."""
    modules = [(name, value) for name, value in sys.modules.items() if type(value) is types.ModuleType]
    specs = {name: vars(module).get("__spec__") for name, module in modules}
    anew = any(_specs.get(name, spec) is not spec for name, spec in specs.items())
    _specs.update(specs)
    return anew
