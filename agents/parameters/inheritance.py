"""Parameters that an agent takes over from another: the way before ``extends``."""

import inspect
import warnings
from collections.abc import Callable, Collection
from typing import Any, TypeVar

from envs.foundation.errors import InvalidTypeError

Create = TypeVar("Create", bound=Callable[..., Any])


def inherits(
    parent: Callable[..., Any], *, omit: Collection[str] = (), **defaults: Any
) -> Callable[[Create], Create]:
    """Decorator of a ``create`` that takes the parameters of another one as ``**inherited``: use ``extends``.

    They are declared as if they stood there, after its own. Put it under ``validated``.

    Args:
        parent: the other agent's ``create``.
        omit: parameters that are not taken over.
        defaults: of inherited parameters, where they are not the parent's.

    Raises:
        TypeError: when ``parent`` has no parameter with a name in ``defaults``.
    """
    message = "inherits is deprecated and will be gone in 0.4: use agents.parameters.extends"
    warnings.warn(message, DeprecationWarning, stacklevel=2)
    signature = inspect.signature(parent)
    annotations = inspect.unwrap(getattr(parent, "__func__", parent)).__annotations__

    def extend(create: Create) -> Create:
        own = inspect.signature(create)
        kept = [p for p in own.parameters.values() if p.kind is not p.VAR_KEYWORD]
        taken = [
            p.replace(default=defaults.get(name, p.default))
            for name, p in signature.parameters.items()
            if p.kind is p.KEYWORD_ONLY and name not in (*own.parameters, *omit)
        ]
        unknown = defaults.keys() - {p.name for p in taken}
        if unknown:
            raise InvalidTypeError(f"defaults must be those of inherited parameters, got {sorted(unknown)}")
        create.__signature__ = own.replace(parameters=[*kept, *taken])  # type: ignore[attr-defined]  # for inspect
        create.__annotations__ = {
            p.name: annotations.get(p.name, p.annotation) for p in taken
        } | create.__annotations__
        return create

    return extend
