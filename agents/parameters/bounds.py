"""Bounds of numbers in annotations, with the vocabulary of the package annotated-types."""

import typing
from collections.abc import Iterator, Sequence
from typing import Annotated, Any

from annotated_types import BaseMetadata, Ge, GroupedMetadata, Gt, Le, Lt

from envs.foundation.errors import InvalidTypeError, InvalidValueError

_KINDS = (Ge, Gt, Le, Lt)
NUMBERS = (int, float)


def is_bound(metadata: Any) -> bool:
    """Whether it is a bound that is looked at."""
    return isinstance(metadata, _KINDS)


def split(annotation: Any) -> tuple[Any, list[Any]]:
    """The type of an annotation, and its bounds."""
    annotation = getattr(annotation, "__supertype__", annotation)  # of a NewType
    if typing.get_origin(annotation) is not Annotated:
        return annotation, []
    inner, *metadata = typing.get_args(annotation)
    base, bounds = split(inner)
    return base, bounds + [bound for bound in _flat(metadata) if isinstance(bound, BaseMetadata)]  # no notes


def check_bounds(name: str, members: Sequence[Any], bounds: list[Any]) -> None:
    """A bound that is not looked at would be worse than none.

    Raises:
        TypeError: when none of the types ``members`` is a number's, or a bound is of no known kind.
    """
    numeric = any(split(member)[0] in NUMBERS for member in members)
    for bound in bounds:
        if not is_bound(bound) or not numeric:
            known = ", ".join(kind.__name__ for kind in _KINDS)
            raise InvalidTypeError(f"{name} must be a number with bounds {known} or Interval, got {bound!r}")


def within(name: str, value: Any, bounds: list[Any]) -> Any:
    """``value`` if it is within all of the bounds.

    Raises:
        ValueError: when it is not.
    """
    for bound in bounds:
        if (
            (isinstance(bound, Ge) and not value >= bound.ge)
            or (isinstance(bound, Gt) and not value > bound.gt)
            or (isinstance(bound, Le) and not value <= bound.le)
            or (isinstance(bound, Lt) and not value < bound.lt)
        ):
            raise InvalidValueError(f"{name} must be {in_words(bounds)}, got {value!r}")
    return value


def in_words(bounds: list[Any]) -> str:
    """What the bounds allow, such as ``in [0, 1]``."""
    least = [(b.ge, False) if isinstance(b, Ge) else (b.gt, True) for b in bounds if isinstance(b, (Ge, Gt))]
    most = [(b.le, True) if isinstance(b, Le) else (b.lt, False) for b in bounds if isinstance(b, (Le, Lt))]
    (low, above), (high, included) = max(least, default=(None, False)), min(most, default=(None, False))
    if low is not None and high is not None:
        return f"in {'(' if above else '['}{_short(low)}, {_short(high)}{']' if included else ')'}"
    if low is not None:
        return f"{'greater than' if above else 'at least'} {_short(low)}"
    return f"{'at most' if included else 'less than'} {_short(high)}"


def _flat(metadata: Sequence[Any]) -> Iterator[Any]:
    for part in metadata:
        yield from part if isinstance(part, GroupedMetadata) else [part]


def _short(bound: Any) -> str:
    """``1`` for 1.0, and all of the digits of the others."""
    return f"{bound:g}" if float(f"{bound:g}") == bound else repr(bound)
