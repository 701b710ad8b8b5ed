"""Edited code: no worker runs another version of an agent than this process has.

A class of an importable module travels by its name. A warm worker may have imported it before it was
edited and reloaded here, a new one after it was edited on disk.
"""

import hashlib
import sys
import types
from collections.abc import Iterable
from pathlib import Path
from typing import Any
from weakref import WeakKeyDictionary

from envs.reachable import Reached, module_code

_digests: WeakKeyDictionary[type[Any], str] = WeakKeyDictionary()
_sent: dict[str, str] = {}
_specs: dict[str, Any] = {}


def code_digest(agent: type[Any]) -> str:
    """A digest of the code of the agent and of the files of it and its bases; empty if the code travels."""
    if agent not in _digests:
        module = sys.modules.get(agent.__module__)
        if module is None or agent.__module__ == "__main__" or hasattr(module, "__arena_plugin__"):
            _digests[agent] = ""
        else:
            compiled = Reached(agent).fingerprint() if hasattr(agent, "_fields") else ""
            _digests[agent] = module_code(module) + compiled + _files(agent)
    return _digests[agent]


def renew_workers(agents: Iterable[type[Any]]) -> None:
    """End joblib's idle workers if, since last time, a module was reloaded or an agent's code has changed."""
    edited = _reloaded()
    for agent in agents:
        name, code = f"{agent.__module__}.{agent.__qualname__}", code_digest(agent)
        edited |= _sent.get(name, code) != code
        _sent[name] = code
    if edited:
        from joblib.externals.loky import get_reusable_executor

        get_reusable_executor().shutdown(wait=True)


def check_fresh(agent: type[Any], code: str) -> None:
    """See that the code here is the code there.

    Raises:
        RuntimeError: when the module was edited after the sender imported it.
    """
    if code_digest(agent) != code:
        raise RuntimeError(
            f"the code of {agent.__module__}.{agent.__qualname__} was edited after it was imported: "
            "reload the module, or start anew"
        )


def _files(agent: type[Any]) -> str:
    """A digest of the files of the class and its bases: constants of a module are in no code."""
    digest = hashlib.sha256()
    for name in dict.fromkeys(base.__module__ for base in agent.__mro__):
        path = Path(getattr(sys.modules.get(name), "__file__", None) or "")
        if path.suffix == ".py" and path.is_file():
            digest.update(path.read_bytes())
    return digest.hexdigest()


def _reloaded() -> bool:
    """Whether any module was imported anew since the last call: helpers of an agent, too."""
    modules = [(name, found) for name, found in sys.modules.items() if type(found) is types.ModuleType]
    specs = {name: vars(module).get("__spec__") for name, module in modules}
    anew = any(_specs.get(name, spec) is not spec for name, spec in specs.items())
    _specs.update(specs)
    return anew
