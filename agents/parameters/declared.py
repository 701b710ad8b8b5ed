"""Parameters of agents: declared once, as the keyword-only arguments of ``create``.

Their types and bounds are annotations, such as ``discount: Annotated[float, Interval(ge=0, le=1)] = 0.99``
with the vocabulary of the package annotated-types; the usual ones have names here.
"""

import dataclasses
import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from annotated_types import Ge, Gt, Interval

from agents.parameters.annotations import as_tuples, rule, settle
from agents.parameters.hints import type_hints
from envs.foundation.checks import choice
from envs.foundation.errors import InvalidTypeError

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

        The default is always accepted, as it is when none is given: results files have all parameters.

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
    return declared_by(getattr(agent, "create", agent))


def settle_all(agent: Any, label: str, given: Mapping[str, Any]) -> dict[str, Any]:
    """``given`` and the defaults of the rest, in the order in which the agent declares them.

    Args:
        agent: the class.
        label: what messages call it.
        given: values by name.

    Raises:
        TypeError, ValueError: when a parameter is unknown, is missing or breaks its rule.
    """
    return settle_arguments(getattr(agent, "create", agent), label, given)


def declared_by(maker: Callable[..., Any]) -> tuple[dict[str, Parameter], bool]:
    """The parameters of what makes an agent, a ``create`` or a class, and whether it takes others as well."""
    arguments = inspect.signature(maker).parameters.values()
    hints = _hints(maker)
    declared = {
        argument.name: Parameter(argument.name, hints.get(argument.name, Any), argument.default)
        for argument in arguments
        if argument.name != "rng"
        and argument.kind not in (argument.VAR_KEYWORD, argument.VAR_POSITIONAL)
        and (argument.kind is argument.KEYWORD_ONLY or isinstance(maker, type))
    }
    return declared, any(argument.kind is argument.VAR_KEYWORD for argument in arguments)


def settle_arguments(maker: Callable[..., Any], label: str, given: Mapping[str, Any]) -> dict[str, Any]:
    """As ``settle_all``, for what makes the agent."""
    declared, free = declared_by(maker)
    for name in given:
        if not free:
            choice(f"parameter of {label}", name, declared)
    for parameter in declared.values():
        if parameter.required and parameter.name not in given:
            raise InvalidTypeError(f"parameter {parameter.name} of {label} must be given")
    complete = {
        name: parameter.settle(given[name]) if name in given else parameter.default
        for name, parameter in declared.items()
        if name in given or not parameter.made  # the class makes it, in the worker
    }
    return complete | {name: as_tuples(value) for name, value in given.items() if name not in declared}


def _same(value: Any, default: Any) -> bool:
    """Whether ``value``, perhaps read from a file, is ``default``."""
    if isinstance(value, Mapping) and hasattr(default, "_asdict"):
        fields = default._asdict()
        return value.keys() == fields.keys() and all(_same(value[name], fields[name]) for name in fields)
    plain = type(value) is type(default) and isinstance(value, (int, float, str))
    return value is default or (plain and bool(value == default))


def _hints(maker: Any) -> dict[str, Any]:
    if isinstance(maker, type):
        return type_hints(inspect.unwrap(vars(maker).get("__init__", maker)))
    # A decorator may have made the signature, with annotations that its function does not have.
    signed = inspect.signature(maker).parameters.items()
    known = {name: p.annotation for name, p in signed if not isinstance(p.annotation, str)}
    hints = known | type_hints(inspect.unwrap(getattr(maker, "__func__", maker)))
    return {name: hint for name, hint in hints.items() if hint is not inspect.Parameter.empty}
