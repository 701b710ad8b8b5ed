"""Decorators by which parameters are validated when they are given, whoever gives them."""

import functools
import inspect
import warnings
from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from typing import Any, Concatenate, TypeVar, cast

from agents.parameters.annotations import given_fields, settle_fields
from agents.parameters.declared import Parameter, declared_by, settle_arguments
from envs.foundation.errors import InvalidTypeError

Target = TypeVar("Target", bound=Callable[..., Any])
Parent = TypeVar("Parent")
Agent = TypeVar("Agent")


def validated(target: Target) -> Target:
    """Decorator of a ``create``, or of a named tuple: what it is called with is settled first.

    The arena settles an entrant's parameters anyway; this does so for whoever calls ``create``, or makes the
    named tuple, in a notebook. A rule about several fields is a method ``__post_init__`` of the named tuple,
    which is called last, as that of a dataclass is.
    """
    settled = _validated_fields(target) if isinstance(target, type) else _validated_arguments(target)
    return cast("Target", settled)


def extends(
    parent: Callable[..., Parent], *, omit: Collection[str] = (), **defaults: Any
) -> Callable[[Callable[Concatenate[type[Agent], Parent, ...], Agent]], Callable[..., Agent]]:
    """Decorator of a ``create`` that takes the parameters of another one as well, declared after its own.

    The other one is called with them; what it makes is handed over in place of the task::

        @classmethod
        @extends(QLearning.create, bins=40)
        def create(cls, agent, *, patience: Count = 10): ...

    All parameters are validated. Each of the two gets the run's generator if it has an argument ``rng``.

    Args:
        parent: the other agent's ``create``.
        omit: parameters that are not taken over: they stay at their defaults.
        defaults: of the parent's parameters, where they are not the parent's own.

    Raises:
        TypeError: when ``parent`` has no parameter with a name in ``defaults``.
    """
    shared = _shared(parent, omit, defaults)

    def extend(create: Callable[..., Agent]) -> Callable[..., Agent]:
        own = declared_by(create)[0]

        @functools.wraps(create)
        def extended(cls: type[Agent], task: Any, **given: Any) -> Agent:
            rng = {"rng": given.pop("rng")} if "rng" in given else {}
            ours = {name: given.pop(name) for name in own if name in given}
            agent = parent(task, **(defaults | given), **(rng if _draws(parent) else {}))
            return create(cls, agent, **ours, **(rng if _draws(create) else {}))

        draws = _draws(parent) or _draws(create)
        extended.__signature__ = _signature(own, shared, draws=draws)  # type: ignore[attr-defined]
        return _validated_arguments(extended)

    return extend


def inherits(
    parent: Callable[..., Any], *, omit: Collection[str] = (), **defaults: Any
) -> Callable[[Target], Target]:
    """As ``extends``, but the parent's parameters arrive as ``**inherited``; put it under ``validated``.

    Deprecated: it will be gone in 0.4.
    """
    message = "inherits is deprecated and will be gone in 0.4: use agents.parameters.extends"
    warnings.warn(message, DeprecationWarning, stacklevel=2)
    shared = _shared(parent, omit, defaults)

    def extend(create: Target) -> Target:
        own = declared_by(create)[0]
        create.__signature__ = _signature(own, shared, draws=_draws(create))  # type: ignore[attr-defined]
        return create

    return extend


def _shared(parent: Any, omit: Collection[str], defaults: Mapping[str, Any]) -> dict[str, Parameter]:
    """The parameters that are taken over from ``parent``."""
    declared = declared_by(parent)[0]
    if unknown := defaults.keys() - declared.keys():
        raise InvalidTypeError(f"defaults must be those of inherited parameters, got {sorted(unknown)}")
    kept = {name: parameter for name, parameter in declared.items() if name not in omit}
    return {name: replace(p, default=defaults.get(name, p.default)) for name, p in kept.items()}


def _signature(
    own: Mapping[str, Parameter], shared: Mapping[str, Parameter], *, draws: bool
) -> inspect.Signature:
    """That of a ``create`` with these parameters, and with ``rng`` if it draws."""
    keyword = inspect.Parameter.KEYWORD_ONLY
    first = [inspect.Parameter(name, inspect.Parameter.POSITIONAL_OR_KEYWORD) for name in ("cls", "task")]
    declared = [*own.values(), *(parameter for name, parameter in shared.items() if name not in own)]
    rest = [inspect.Parameter(p.name, keyword, default=p.default, annotation=p.annotation) for p in declared]
    rng = [inspect.Parameter("rng", keyword, default=None)] if draws else []
    return inspect.Signature([*first, *rest, *rng])


def _draws(create: Callable[..., Any]) -> bool:
    return "rng" in inspect.signature(create).parameters


def _validated_arguments(create: Callable[..., Agent]) -> Callable[..., Agent]:
    @functools.wraps(create)
    def settled(cls: type[Any], task: Any, **given: Any) -> Agent:
        rng = {"rng": given.pop("rng")} if "rng" in given else {}
        return create(cls, task, **settle_arguments(create, cls.__name__, given), **rng)

    return settled


def _validated_fields(cls: Any) -> Any:
    make = cls.__new__

    @functools.wraps(make)
    def settled(kind: Any, /, *values: Any, **fields: Any) -> Any:
        given = make(kind, *values, **fields)
        value = make(kind, **(given._asdict() | settle_fields("", given_fields(given), kind)))
        if hasattr(kind, "__post_init__"):
            value.__post_init__()
        return value

    cls.__new__ = settled
    cls._make = classmethod(lambda kind, values: kind(*values))  # also what ``_replace`` calls
    return cls
