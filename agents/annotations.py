"""Annotations as rules: what a value must be, with the bounds of the package annotated-types."""

import typing
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import NoneType, UnionType
from typing import Annotated, Any, Literal

from annotated_types import Ge, GroupedMetadata, Gt, Le

from envs.checks import choice, integer, number


def settle(name: str, value: Any, annotation: Any) -> Any:
    """``value`` as the annotation wants it: numbers of the right kind, tuples, named tuples.

    Args:
        name: what messages call it.
        value: as given in Python or in a file.
        annotation: a type, with bounds if it is ``Annotated``.

    Raises:
        TypeError, ValueError: when it breaks the annotation's rule.
    """
    base, bounds = _split(annotation)
    origin, arguments = typing.get_origin(base), typing.get_args(base)
    if origin in _UNIONS:
        return _settle_union(name, value, arguments)
    if origin is Literal:
        return choice(name, value, arguments)
    if _is_sequence(origin):
        return _settle_sequence(name, value, arguments)
    if base in _PLAIN:
        return _within(name, _PLAIN[base](name, value), bounds)
    if isinstance(base, type) and base is not Any:
        return _settle_instance(name, value, base)
    return as_tuples(value)


def rule(annotation: Any) -> str:
    """Type and bounds in words, such as ``float in [0, 1]``."""
    base, bounds = _split(annotation)
    origin, arguments = typing.get_origin(base), typing.get_args(base)
    if origin in _UNIONS:
        return " or ".join(map(rule, arguments))
    if origin is Literal:
        return " or ".join(map(repr, arguments))
    if _is_sequence(origin):
        return f"list of {rule(arguments[0])}" if arguments else "list"
    if base in (Any, None, NoneType):
        return "anything" if base is Any else "nothing"
    name = getattr(base, "__name__", str(base))
    return f"{name} {_range(bounds)}" if bounds else name


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
_PLAIN: dict[Any, Callable[[str, Any], Any]] = {
    int: integer,
    float: number,
    bool: _boolean,
    None: _nothing,
    NoneType: _nothing,
}


def _is_sequence(origin: Any) -> bool:
    return isinstance(origin, type) and issubclass(origin, Sequence)


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


def _settle_sequence(name: str, value: Any, arguments: tuple[Any, ...]) -> tuple[Any, ...]:
    if isinstance(value, (str, bytes, Mapping)) or not isinstance(value, Sequence):
        raise TypeError(f"{name} must be a list, got {value!r}")
    fixed = [argument for argument in arguments if argument is not Ellipsis]
    if len(fixed) > 1 and len(fixed) != len(value):
        raise ValueError(f"{name} must have {len(fixed)} values, got {value!r}")
    kinds = fixed if len(fixed) > 1 else (fixed or [Any]) * len(value)
    return tuple(settle(name, part, kind) for part, kind in zip(value, kinds, strict=True))


def _settle_instance(name: str, value: Any, kind: Any) -> Any:
    if isinstance(value, Mapping) and hasattr(kind, "_fields"):
        for key in value:
            choice(f"field of {name}", key, kind._fields)
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
        ):
            raise ValueError(f"{name} must be {_range(bounds)}, got {value!r}")
    return value


def _split(annotation: Any) -> tuple[Any, list[Any]]:
    """The type of an annotation, and its bounds."""
    if typing.get_origin(annotation) is not Annotated:
        return annotation, []
    base, *metadata = typing.get_args(annotation)
    return base, list(_flat(metadata))


def _flat(metadata: Sequence[Any]) -> Iterator[Any]:
    for one in metadata:
        yield from one if isinstance(one, GroupedMetadata) else [one]


def _range(bounds: list[Any]) -> str:
    least: list[Any] = [b.ge if isinstance(b, Ge) else b.gt for b in bounds if isinstance(b, (Ge, Gt))]
    most: list[Any] = [b.le for b in bounds if isinstance(b, Le)]
    above = any(isinstance(b, Gt) for b in bounds)
    if least and most:
        return f"in {'(' if above else '['}{least[0]:g}, {most[0]:g}]"
    if least:
        return f"{'greater than' if above else 'at least'} {least[0]:g}"
    return f"at most {most[0]:g}"
