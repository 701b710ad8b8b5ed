"""Annotations as rules: what a value must be, with the bounds of the package annotated-types."""

import inspect
import typing
from collections.abc import Callable, Collection, Mapping, Sequence
from types import NoneType, UnionType
from typing import Annotated, Any, Literal

from agents.parameters.bounds import NUMBERS, check_bounds, in_words, is_bound, split, within
from agents.parameters.hints import type_hints
from envs.foundation.checks import choice, integer, number
from envs.foundation.errors import ArenaError, InvalidTypeError, InvalidValueError


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
    base, bounds = split(annotation)
    origin, arguments = _parts(base, bounds)
    check_bounds(name, arguments if origin in _UNIONS else (base,), bounds)
    if origin in _UNIONS:
        return _settle_union(name, value, arguments)
    if origin is Literal:
        return _settle_literal(name, value, arguments)
    if _is_named_tuple(origin or base):
        return _settle_named_tuple(name, value, origin or base)
    if _is_sequence(origin):
        return _settle_sequence(name, value, arguments, fixed=origin is tuple)
    if base in _PLAIN:
        return within(name, _PLAIN[base](name, value), bounds)
    return _settle_instance(name, value, base)


def rule(annotation: Any) -> str:
    """Type and bounds in words, such as ``float in [0, 1]``."""
    base, bounds = split(annotation)
    origin, arguments = _parts(base, bounds)
    if origin in _UNIONS:
        return " or ".join(map(rule, arguments))
    if origin is Literal:
        return " or ".join(map(repr, arguments))
    if _is_sequence(origin) and not _is_named_tuple(origin):
        kinds = dict.fromkeys(rule(kind) for kind in arguments if kind is not Ellipsis)
        return f"list of {', '.join(kinds)}" if kinds else "list"
    if base in (Any, None, NoneType):
        return "anything" if base is Any else "nothing"
    name = getattr(base, "__name__", str(base))
    known = [bound for bound in bounds if is_bound(bound) and base in NUMBERS]
    return f"{name} {in_words(known)}" if known else name


def given_fields(value: Any) -> dict[str, Any]:
    """The fields of a named tuple that are not at their defaults."""
    defaults = value._field_defaults
    fields = value._asdict().items()
    return {key: part for key, part in fields if key not in defaults or defaults[key] is not part}


def settle_fields(prefix: str, fields: Mapping[str, Any], kind: Any) -> dict[str, Any]:
    """Fields of the class ``kind`` as it annotates them; messages call them ``prefix`` and their name."""
    rules = type_hints(kind)
    return {key: settle(prefix + key, part, rules.get(key, Any)) for key, part in fields.items()}


def as_tuples(value: Any) -> Any:
    """``value`` with its lists as tuples."""
    return tuple(map(as_tuples, value)) if isinstance(value, list) else value


def _boolean(name: str, value: Any) -> bool:
    if not isinstance(value, bool):
        raise InvalidTypeError(f"{name} must be true or false, got {value!r}")
    return value


def _nothing(name: str, value: Any) -> None:
    if value is not None:
        raise InvalidTypeError(f"{name} must be nothing, got {value!r}")


_UNIONS = (typing.Union, UnionType)
_PLAIN: dict[Any, Callable[[str, Any], Any]] = {
    int: integer,
    float: number,
    bool: _boolean,
    None: _nothing,
    NoneType: _nothing,
}


def _is_named_tuple(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, tuple) and hasattr(kind, "_fields")


def _is_sequence(origin: Any) -> bool:
    return isinstance(origin, type) and issubclass(origin, Sequence)


def _settle_literal(name: str, value: Any, options: tuple[Any, ...]) -> Any:
    if all(isinstance(option, str) for option in options):
        return choice(name, value, options)
    for option in options:
        if type(option) is type(value) and option == value:
            return option
    raise InvalidValueError(f"{name} must be one of {', '.join(map(repr, options))}, got {value!r}")


def _settle_union(name: str, value: Any, members: tuple[Any, ...]) -> Any:
    bases = [split(member)[0] for member in members]
    kinds = [kind for kind in (typing.get_origin(base) or base for base in bases) if _is_named_tuple(kind)]
    if kinds and isinstance(value, Mapping):  # a table of a file: the kind that it has most fields of
        _check_fields(name, value, {field for kind in kinds for field in kind._fields})
        kinds.sort(key=lambda kind: -len(value.keys() & {*kind._fields}))
        return _settle_named_tuple(name, value, kinds[0])
    for kind in kinds:
        if isinstance(value, kind):
            return _settle_named_tuple(name, value, kind)
    problems: list[ArenaError] = []
    for member in members:
        try:
            return settle(name, value, member)
        except ArenaError as problem:
            problems.append(problem)
    near = [problem for problem in problems if isinstance(problem, ValueError)]
    if near:  # of the right type
        raise near[0]
    raise InvalidTypeError(f"{name} must be {' or '.join(map(rule, members))}, got {value!r}")


def _settle_sequence(
    name: str, value: Any, arguments: tuple[Any, ...], *, fixed: bool = False
) -> tuple[Any, ...]:
    if isinstance(value, (str, bytes, Mapping)) or not isinstance(value, Sequence):
        raise InvalidTypeError(f"{name} must be a list, got {value!r}")
    kinds = list(arguments)
    if not kinds or not fixed or kinds[-1] is Ellipsis:
        kinds = (kinds or [Any])[:1] * len(value)
    if len(kinds) != len(value):
        raise InvalidValueError(
            f"{name} must have {len(kinds)} value{'s' * (len(kinds) != 1)}, got {value!r}"
        )
    return tuple(settle(name, part, kind) for part, kind in zip(value, kinds, strict=True))


def _settle_instance(name: str, value: Any, kind: Any) -> Any:
    try:
        fits = kind is Any or not isinstance(kind, type) or isinstance(value, kind)
    except TypeError:  # a protocol or a typed dictionary cannot be looked for
        fits = True
    if not fits:
        raise InvalidTypeError(f"{name} must be a {kind.__name__}, got {value!r}")
    return as_tuples(value)


def _settle_named_tuple(name: str, value: Any, kind: Any) -> Any:
    """``value``, a table or a ``kind``, with fields as they are annotated; defaults are left alone."""
    if isinstance(value, Mapping):
        _check_fields(name, value, kind._fields)
        for field in inspect.signature(kind).parameters.values():
            if field.default is field.empty and field.name not in value:
                raise InvalidTypeError(f"{name} must have the field {field.name}, got {value!r}")
        return _construct(name, kind, settle_fields(f"{name}.", value, kind))
    _settle_instance(name, value, kind)
    given = given_fields(value)
    settled = settle_fields(f"{name}.", given, type(value))
    if all(settled[key] is part for key, part in given.items()):
        return value
    return _construct(name, value._replace, settled)


def _check_fields(name: str, value: Mapping[str, Any], fields: Collection[str]) -> None:
    for key in value:
        choice(f"field of {name}", key, fields)


def _construct(name: str, make: Callable[..., Any], fields: Mapping[str, Any]) -> Any:
    """``make(**fields)``; messages of the rules that it has of its own get the whole name of the field."""
    try:
        return make(**fields)
    except (TypeError, ValueError) as problem:
        kind = InvalidTypeError if isinstance(problem, TypeError) else InvalidValueError
        separator = "." if str(problem).partition(" ")[0] in fields else ": "
        raise kind(f"{name}{separator}{problem}") from problem


def _parts(base: Any, bounds: list[Any]) -> tuple[Any, tuple[Any, ...]]:
    """The origin of a type and its arguments; the numbers of a union have the bounds of the whole."""
    origin, arguments = typing.get_origin(base), typing.get_args(base)
    if base in (tuple, list, Sequence):
        return base, ()
    if origin in _UNIONS and bounds:
        arguments = tuple(Annotated[m, *bounds] if split(m)[0] in NUMBERS else m for m in arguments)
    return origin, arguments
