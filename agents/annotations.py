"""Annotations as rules: what a value must be, with the bounds of the package annotated-types."""

import inspect
import typing
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import NoneType, UnionType
from typing import Annotated, Any, Literal

from annotated_types import BaseMetadata, Ge, GroupedMetadata, Gt, Le, Lt

from envs.checks import choice, integer, number


def settle(name: str, value: Any, annotation: Any) -> Any:
    """``value`` as the annotation wants it: numbers of the right kind, tuples, named tuples.

    Args:
        name: what messages call it.
        value: as given in Python or in a file.
        annotation: a type, with bounds if it is ``Annotated``: ``Ge``, ``Gt``, ``Le``, ``Lt`` or
            ``Interval``.

    Raises:
        TypeError, ValueError: when it breaks the annotation's rule.
    """
    base, bounds = _split(annotation)
    origin, arguments = _parts(base, bounds)
    _check_bounds(name, base, bounds)
    if origin in _UNIONS:
        return _settle_union(name, value, arguments)
    if origin is Literal:
        return _settle_literal(name, value, arguments)
    if _is_sequence(origin):
        return _settle_sequence(name, value, arguments, fixed=origin is tuple)
    if base in _PLAIN:
        return _within(name, _PLAIN[base](name, value), bounds)
    if isinstance(base, type) and base is not Any:
        return _settle_instance(name, value, base)
    return as_tuples(value)


def rule(annotation: Any) -> str:
    """Type and bounds in words, such as ``float in [0, 1]``."""
    base, bounds = _split(annotation)
    origin, arguments = _parts(base, bounds)
    if origin in _UNIONS:
        return " or ".join(map(rule, arguments))
    if origin is Literal:
        return " or ".join(map(repr, arguments))
    if _is_sequence(origin):
        return f"list of {rule(arguments[0])}" if arguments else "list"
    if base in (Any, None, NoneType):
        return "anything" if base is Any else "nothing"
    name = getattr(base, "__name__", str(base))
    known = [bound for bound in bounds if isinstance(bound, _BOUNDS) and base in _NUMBERS]
    return f"{name} {_range(known)}" if known else name


def as_tuples(value: Any) -> Any:
    """``value`` with its lists as tuples."""
    return tuple(map(as_tuples, value)) if isinstance(value, list) else value


def _boolean(name: str, value: Any) -> bool:
    if not isinstance(value, bool):
        raise TypeError(f"{name} must be true or false, got {value!r}")
    return value


def _nothing(name: str, value: Any) -> None:
    if value is not None:
        raise TypeError(f"{name} must be nothing, got {value!r}")


_UNIONS = (typing.Union, UnionType)
_BOUNDS = (Ge, Gt, Le, Lt)
_NUMBERS = (int, float)
_PLAIN: dict[Any, Callable[[str, Any], Any]] = {
    int: integer,
    float: number,
    bool: _boolean,
    None: _nothing,
    NoneType: _nothing,
}


def _is_sequence(origin: Any) -> bool:
    return isinstance(origin, type) and issubclass(origin, Sequence)


def _settle_literal(name: str, value: Any, options: tuple[Any, ...]) -> Any:
    if all(isinstance(option, str) for option in options):
        return choice(name, value, options)
    for option in options:
        if type(option) is type(value) and option == value:
            return option
    raise ValueError(f"{name} must be one of {', '.join(map(repr, options))}, got {value!r}")


def _settle_union(name: str, value: Any, members: tuple[Any, ...]) -> Any:
    if isinstance(value, Mapping):  # a table of a file: the part that has all of its fields
        kinds = [kind for kind in members if hasattr(kind, "_fields")]
        fitting = [kind for kind in kinds if set(value) <= set(kind._fields)]
        if kinds:
            return _settle_instance(name, value, (fitting or kinds)[0])
    problems: list[Exception] = []
    for member in members:
        try:
            return settle(name, value, member)
        except (TypeError, ValueError) as problem:
            problems.append(problem)
    near = [problem for problem in problems if isinstance(problem, ValueError)]
    if near:  # of the right type
        raise near[0]
    raise TypeError(f"{name} must be {' or '.join(map(rule, members))}, got {value!r}")


def _settle_sequence(
    name: str, value: Any, arguments: tuple[Any, ...], *, fixed: bool = False
) -> tuple[Any, ...]:
    if isinstance(value, (str, bytes, Mapping)) or not isinstance(value, Sequence):
        raise TypeError(f"{name} must be a list, got {value!r}")
    kinds = list(arguments)
    if not kinds or not fixed or kinds[-1] is Ellipsis:
        kinds = (kinds or [Any])[:1] * len(value)
    if len(kinds) != len(value):
        raise ValueError(f"{name} must have {len(kinds)} value{'s' * (len(kinds) != 1)}, got {value!r}")
    return tuple(settle(name, part, kind) for part, kind in zip(value, kinds, strict=True))


def _settle_instance(name: str, value: Any, kind: Any) -> Any:
    if isinstance(value, Mapping) and hasattr(kind, "_fields"):
        for key in value:
            choice(f"field of {name}", key, kind._fields)
        for field in inspect.signature(kind).parameters.values():
            if field.default is field.empty and field.name not in value:
                raise TypeError(f"{name} must have the field {field.name}, got {value!r}")
        return kind(**value)
    if not isinstance(value, kind):
        raise TypeError(f"{name} must be a {kind.__name__}, got {value!r}")
    return value


def _within(name: str, value: Any, bounds: list[Any]) -> Any:
    for bound in bounds:
        if (
            (isinstance(bound, Ge) and not value >= bound.ge)
            or (isinstance(bound, Gt) and not value > bound.gt)
            or (isinstance(bound, Le) and not value <= bound.le)
            or (isinstance(bound, Lt) and not value < bound.lt)
        ):
            raise ValueError(f"{name} must be {_range(bounds)}, got {value!r}")
    return value


def _split(annotation: Any) -> tuple[Any, list[Any]]:
    """The type of an annotation, and its bounds."""
    if typing.get_origin(annotation) is not Annotated:
        return annotation, []
    base, *metadata = typing.get_args(annotation)
    return base, [one for one in _flat(metadata) if isinstance(one, BaseMetadata)]  # the rest is notes


def _check_bounds(name: str, base: Any, bounds: list[Any]) -> None:
    """A bound that is not looked at would be worse than none."""
    members = typing.get_args(base) if typing.get_origin(base) in _UNIONS else (base,)
    numeric = any(_split(one)[0] in _NUMBERS for one in members)
    for bound in bounds:
        if not isinstance(bound, _BOUNDS) or not numeric:
            known = ", ".join(one.__name__ for one in _BOUNDS)
            raise TypeError(f"{name} must be a number with bounds {known} or Interval, got {bound!r}")


def _parts(base: Any, bounds: list[Any]) -> tuple[Any, tuple[Any, ...]]:
    """The origin of a type and its arguments; the numbers of a union have the bounds of the whole."""
    origin, arguments = typing.get_origin(base), typing.get_args(base)
    if base in (tuple, list, Sequence):
        return base, ()
    if origin in _UNIONS and bounds:
        arguments = tuple(Annotated[one, *bounds] if _split(one)[0] in _NUMBERS else one for one in arguments)
    return origin, arguments


def _flat(metadata: Sequence[Any]) -> Iterator[Any]:
    for one in metadata:
        yield from one if isinstance(one, GroupedMetadata) else [one]


def _range(bounds: list[Any]) -> str:
    least = [(b.ge, False) if isinstance(b, Ge) else (b.gt, True) for b in bounds if isinstance(b, (Ge, Gt))]
    most = [(b.le, True) if isinstance(b, Le) else (b.lt, False) for b in bounds if isinstance(b, (Le, Lt))]
    (low, above), (high, included) = max(least, default=(None, False)), min(most, default=(None, False))
    if low is not None and high is not None:
        return f"in {'(' if above else '['}{_short(low)}, {_short(high)}{']' if included else ')'}"
    if low is not None:
        return f"{'greater than' if above else 'at least'} {_short(low)}"
    return f"{'at most' if included else 'less than'} {_short(high)}"


def _short(bound: Any) -> str:
    """``1`` for 1.0, and all of the digits of the others."""
    return f"{bound:g}" if float(f"{bound:g}") == bound else repr(bound)
