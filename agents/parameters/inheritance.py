"""Parameters that an agent takes over from another, with other defaults where that is what differs."""

import inspect
from collections.abc import Callable, Collection
from typing import Any, TypeVar

from envs.foundation.errors import InvalidTypeError

Create = TypeVar("Create", bound=Callable[..., Any])


def inherits(
    parent: Callable[..., Any], *, omit: Collection[str] = (), **defaults: Any
) -> Callable[[Create], Create]:
    """Decorator of a ``create`` that takes the parameters of another one as ``**inherited``.

    They are declared as if they stood there, after its own. Put it under ``validated``.

    Args:
        parent: the other agent's ``create``.
        omit: parameters that are not taken over.
        defaults: of inherited parameters, where they are not the parent's.

    Raises:
        TypeError: when ``parent`` has no parameter with a name in ``defaults``.
    """
    signature = inspect.signature(parent)
    annotations = inspect.unwrap(getattr(parent, "__func__", parent)).__annotations__

    def extend(create: Create) -> Create:
        own = inspect.signature(create)
        kept = [one for one in own.parameters.values() if one.kind is not one.VAR_KEYWORD]
        taken = [
            one.replace(default=defaults.get(name, one.default))
            for name, one in signature.parameters.items()
            if one.kind is one.KEYWORD_ONLY and name not in (*own.parameters, *omit)
        ]
        unknown = defaults.keys() - {one.name for one in taken}
        if unknown:
            raise InvalidTypeError(f"defaults must be those of inherited parameters, got {sorted(unknown)}")
        create.__signature__ = own.replace(parameters=[*kept, *taken])  # type: ignore[attr-defined]  # for inspect
        create.__annotations__ = {one.name: annotations[one.name] for one in taken} | create.__annotations__
        return create

    return extend
