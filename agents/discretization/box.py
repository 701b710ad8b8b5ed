"""What a grid and tile coding share: a box of observations, and fields that follow from others."""

from collections.abc import Iterable
from typing import Any, ClassVar, Self

from envs.foundation.checks import instance, integer, number
from envs.foundation.errors import InvalidValueError


class Derived:
    """Mixin of a named tuple that is constructed from its first fields; the others follow from these.

    Two are equal if the first fields are; copies compute the others anew.
    """

    __slots__ = ()
    _n_first: ClassVar[int]

    @classmethod
    def _make(cls, iterable: Iterable[Any]) -> Self:
        return cls(*tuple(iterable)[: cls._n_first])

    def __getnewargs__(self) -> tuple[Any, ...]:
        return self[: self._n_first]  # type: ignore[index, no-any-return]  # a tuple

    def __eq__(self, other: object) -> bool:
        return isinstance(other, type(self)) and self.__getnewargs__() == other.__getnewargs__()

    def __ne__(self, other: object) -> bool:
        return not self == other

    def __hash__(self) -> int:
        return hash(self.__getnewargs__())


def ranges(low: Iterable[float], high: Iterable[float]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Bounds as tuples, one value a dimension.

    Raises:
        TypeError, ValueError: when they are no numbers, or not as many, or ``high`` is not above ``low``.
    """
    lows = tuple(number("low", x) for x in instance("low", low, Iterable))
    highs = tuple(number("high", x) for x in instance("high", high, Iterable))
    if len(lows) != len(highs) or not lows:
        raise InvalidValueError(f"low and high must have one value a dimension, got {lows} and {highs}")
    for a, b in zip(lows, highs, strict=True):
        number("high", b, a, exclusive_low=True)
    return lows, highs


def counts(name: str, given: int | Iterable[int], dimensions: int) -> tuple[int, ...]:
    """Numbers of at least 1, one a dimension; a single one is for all.

    Raises:
        TypeError, ValueError: when they are none, or not as many as there are dimensions.
    """
    each = given if isinstance(given, Iterable) else [given] * dimensions
    numbers = tuple(integer(name, n, 1) for n in each)
    if len(numbers) != dimensions:
        raise InvalidValueError(f"{name} must have {dimensions} numbers, one a dimension, got {numbers}")
    return numbers
