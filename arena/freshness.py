"""Edited code: no worker runs another version of an agent than this process has.

A class of an importable module travels by its name. A warm worker may have imported it before it was
edited and reloaded here, a new one after it was edited on disk.
"""

import sys
from collections.abc import Iterable
from typing import Any
from weakref import WeakKeyDictionary

from envs.reachable import Reached, module_code

_digests: WeakKeyDictionary[type[Any], str] = WeakKeyDictionary()
_sent: dict[str, str] = {}


def code_digest(agent: type[Any]) -> str:
    """A digest of the code of the agent and its module; empty if the code itself travels."""
    if agent not in _digests:
        module = sys.modules.get(agent.__module__)
        if module is None or agent.__module__ == "__main__" or hasattr(module, "__arena_plugin__"):
            _digests[agent] = ""
        else:
            compiled = Reached(agent).fingerprint() if hasattr(agent, "_fields") else ""
            _digests[agent] = module_code(module) + compiled
    return _digests[agent]


def renew_workers(agents: Iterable[type[Any]]) -> None:
    """End joblib's idle workers if one of ``agents`` was sent to them with other code before."""
    edited = False
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
