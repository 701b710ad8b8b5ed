"""Parameters of agents: declared once, as the keyword-only arguments of ``create``.

Their types and bounds are annotations, such as ``discount: Annotated[float, Interval(ge=0, le=1)] = 0.99``
with the vocabulary of the package annotated-types; the usual ones have names here.
"""

import dataclasses
import functools
import inspect
import typing
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, TypeVar

from annotated_types import Ge, Gt, Interval

from agents.parameters.annotations import as_tuples, rule, settle
from agents.parameters.hints import type_hints
from envs.foundation.checks import choice
from envs.foundation.errors import InvalidTypeError

Create = TypeVar("Create", bound=Callable[..., Any])

Probability = Annotated[float, Interval(ge=0, le=1)]
NonNegative = Annotated[float, Ge(0)]
Positive = Annotated[float, Gt(0)]
StepSize = Annotated[float, Interval(gt=0, le=1)]
Count = Annotated[int, Ge(1)]


@dataclass(frozen=True)
class Parameter:
    """One parameter of an agent.

    Attributes:
        name: what it is called.
        annotation: its type, with bounds; ``Any`` if it has none.
        default: its value when none is given; ``inspect.Parameter.empty`` if one must be given.
    """

    name: str
    annotation: Any
    default: Any

    @property
    def required(self) -> bool:
        """Whether it has no default."""
        return self.default is inspect.Parameter.empty

    @property
    def made(self) -> bool:
        """Whether the default is made anew each time, as ``default_factory`` of a dataclass does."""
        return isinstance(self.default, type(dataclasses._HAS_DEFAULT_FACTORY))  # type: ignore[attr-defined] # noqa: SLF001 (there is no public name)

    def settle(self, value: Any) -> Any:
        """``value`` as the agent receives it: a table of a file as a named tuple, a list as a tuple.

        The default is always accepted, as it is when none is given: results files tell all parameters.

        Raises:
            TypeError, ValueError: when it breaks the rule of the annotation.
        """
        return self.default if _same(value, self.default) else settle(self.name, value, self.annotation)

    def rule(self) -> str:
        """Type and bounds in words, such as ``float in [0, 1]``."""
        return rule(self.annotation)


def parameters_of(agent: Any) -> tuple[dict[str, Parameter], bool]:
    """The parameters that a class of agents declares, and whether it takes others as well.

    Args:
        agent: the class; one without ``create`` is constructed with its parameters.
    """
    maker = getattr(agent, "create", agent)
    declared = inspect.signature(maker).parameters.values()
    hints = _hints(maker)
    found = {
        one.name: Parameter(one.name, hints.get(one.name, Any), one.default)
        for one in declared
        if one.name != "rng"
        and one.kind not in (one.VAR_KEYWORD, one.VAR_POSITIONAL)
        and (one.kind is one.KEYWORD_ONLY or maker is agent)
    }
    return found, any(one.kind is one.VAR_KEYWORD for one in declared)


def settle_all(agent: Any, label: str, given: Mapping[str, Any]) -> dict[str, Any]:
    """``given`` and the defaults of the rest, in the order in which the agent declares them.

    Args:
        agent: the class.
        label: what messages call it.
        given: values by name.

    Raises:
        TypeError, ValueError: when a parameter is unknown, is missing or breaks its rule.
    """
    declared, free = parameters_of(agent)
    for name in given:
        if not free:
            choice(f"parameter of {label}", name, declared)
    for one in declared.values():
        if one.required and one.name not in given:
            raise InvalidTypeError(f"parameter {one.name} of {label} must be given")
    complete = {
        name: one.settle(given[name]) if name in given else one.default
        for name, one in declared.items()
        if name in given or not one.made  # the class makes it, in the worker
    }
    return complete | {name: as_tuples(value) for name, value in given.items() if name not in declared}


def validated(create: Create) -> Create:
    """Decorator of ``create``: its parameters are settled before it is called.

    The arena settles them anyway; so does whoever calls ``create`` in a notebook.
    """

    @functools.wraps(create)
    def settled(cls: type[Any], task: Any, **given: Any) -> Any:
        extra = {"rng": given.pop("rng")} if "rng" in given else {}
        return create(cls, task, **settle_all(cls, cls.__name__, given), **extra)

    return typing.cast("Create", settled)


def _same(value: Any, default: Any) -> bool:
    """Whether ``value``, perhaps read from a file, is ``default``."""
    if isinstance(value, Mapping) and hasattr(default, "_asdict"):
        fields = default._asdict()
        return value.keys() == fields.keys() and all(_same(value[name], fields[name]) for name in fields)
    plain = type(value) is type(default) and isinstance(value, (int, float, str))
    return value is default or (plain and bool(value == default))


def _hints(maker: Any) -> dict[str, Any]:
    constructor = vars(maker).get("__init__", maker) if isinstance(maker, type) else maker
    return type_hints(inspect.unwrap(getattr(constructor, "__func__", constructor)))
