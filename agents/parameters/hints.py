"""What the annotations of a function or a class mean, also where they are written as texts."""

import inspect
import sys
import types
import typing
from contextlib import suppress
from typing import Any


def type_hints(owner: Any) -> dict[str, Any]:
    """The annotations of a function, or of a class and its bases, by name.

    ``typing.get_type_hints`` resolves all or none. A name that exists for type checkers only must not
    take the bounds of the others away.
    """
    hints: dict[str, Any] = {}
    for part in reversed(getattr(owner, "__mro__", (owner,))):
        names = getattr(part, "__globals__", None) or vars(sys.modules.get(part.__module__, object))
        for name, annotation in inspect.get_annotations(part).items():
            alone = types.SimpleNamespace(__annotations__={name: annotation})
            with suppress(Exception):
                hints |= typing.get_type_hints(alone, dict(names), include_extras=True)
    return hints
