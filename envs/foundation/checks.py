"""Checks of parameters: each failure is one sentence with the parameter, the rule and the value."""

import math
import numbers
import operator
from collections.abc import Iterable
from difflib import get_close_matches
from typing import Any, Self

from envs.foundation.errors import InvalidTypeError, InvalidValueError


class Validated:
    """Mixin of a named tuple with a constructor that validates: ``_replace`` validates, too."""

    __slots__ = ()

    @classmethod
    def _make(cls, iterable: Iterable[Any]) -> Self:
        return cls(*iterable)


def instance(name: str, value: Any, kind: type[Any]) -> Any:
    """``value`` if it is a ``kind``.

    Raises:
        TypeError: when it is not.
    """
    if not isinstance(value, kind):
        raise InvalidTypeError(f"{name} must be a {kind.__name__}, got {value!r}")
    return value


def number(
    name: str, value: Any, low: float = -math.inf, high: float = math.inf, *, exclusive_low: bool = False
) -> float:
    """``value`` as a finite float in [low, high], or (low, high] where ``exclusive_low`` is set.

    Raises:
        TypeError: when it is no real number.
        ValueError: when it is NaN, infinite or out of the range.
    """
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise InvalidTypeError(f"{name} must be a number, got {value!r}")
    try:
        converted = float(value)
    except OverflowError:
        converted = math.inf
    if not math.isfinite(converted) or not low <= converted <= high or (exclusive_low and converted == low):
        raise InvalidValueError(f"{name} must be {_range(low, high, exclusive_low)}, got {value!r}")
    return converted


def integer(name: str, value: Any, low: int | None = None) -> int:
    """``value`` as an int of at least ``low``.

    Raises:
        TypeError: when it is no integer.
        ValueError: when it is less than ``low``.
    """
    try:
        if isinstance(value, bool):
            raise TypeError
        converted = operator.index(value)
    except TypeError:
        raise InvalidTypeError(f"{name} must be an integer, got {value!r}") from None
    if low is not None and converted < low:
        raise InvalidValueError(f"{name} must be at least {low}, got {converted}")
    return converted


def choice(name: str, value: Any, options: Iterable[str]) -> str:
    """``value`` if it is one of ``options``.

    Raises:
        ValueError: naming the options and, for a misspelt one, the nearest.
    """
    known = sorted(options)
    if not isinstance(value, str) or value not in known:
        near = get_close_matches(str(value), known, n=1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        raise InvalidValueError(f"{name} must be one of {', '.join(known) or 'nothing'}, got {value!r}{hint}")
    return value


def _range(low: float, high: float, exclusive_low: bool) -> str:
    if math.isfinite(low) and math.isfinite(high):
        return f"in {'(' if exclusive_low else '['}{low:g}, {high:g}]"
    if math.isfinite(low):
        return f"a finite number {'greater than' if exclusive_low else 'of at least'} {low:g}"
    if math.isfinite(high):
        return f"a finite number of at most {high:g}"
    return "a finite number"
