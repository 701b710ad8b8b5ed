"""Decorators by which parameters are validated when they are given, whoever gives them."""

import functools
import inspect
from collections.abc import Callable, Collection
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
    theirs = declared_by(parent)[0]
    if unknown := defaults.keys() - theirs.keys():
        raise InvalidTypeError(f"defaults must be those of the parent's parameters, got {sorted(unknown)}")
    shared = {
        name: replace(parameter, default=defaults.get(name, parameter.default))
        for name, parameter in theirs.items()
        if name not in omit
    }

    def extend(create: Callable[..., Agent]) -> Callable[..., Agent]:
        own = declared_by(create)[0]
        draws = [maker for maker in (parent, create) if "rng" in inspect.signature(maker).parameters]

        @functools.wraps(create)
        def extended(cls: type[Agent], task: Any, **given: Any) -> Agent:
            rng = {"rng": given.pop("rng")} if "rng" in given else {}
            ours = {name: given.pop(name) for name in own if name in given}
            agent = parent(task, **(defaults | given), **(rng if parent in draws else {}))
            return create(cls, agent, **ours, **(rng if create in draws else {}))

        declared = own | {name: parameter for name, parameter in shared.items() if name not in own}
        extended.__signature__ = _signature(declared.values(), draws=bool(draws))  # type: ignore[attr-defined]
        return _validated_arguments(extended)

    return extend


def _signature(declared: Collection[Parameter], *, draws: bool) -> inspect.Signature:
    """That of a ``create`` with these parameters, and ``rng`` if it draws."""
    keyword = inspect.Parameter.KEYWORD_ONLY
    first = [inspect.Parameter(name, inspect.Parameter.POSITIONAL_OR_KEYWORD) for name in ("cls", "task")]
    rest = [inspect.Parameter(p.name, keyword, default=p.default, annotation=p.annotation) for p in declared]
    rng = [inspect.Parameter("rng", keyword, default=None)] if draws else []
    return inspect.Signature([*first, *rest, *rng])


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
