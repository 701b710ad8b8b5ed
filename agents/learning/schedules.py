"""How epsilon and the step size change while an agent learns."""

from typing import NamedTuple, Self

from envs.foundation.checks import Validated, number


class _Line(NamedTuple):
    start: float
    end: float
    until: float


class LinearDecay(Validated, _Line):  # type: ignore[misc]  # both have _make
    """From ``start`` to ``end`` in a straight line over the training (paper, section 4.3).

    Args:
        start: value in the first episode, in [0, 1].
        end: value that is approached in the last, in [0, 1].
        until: share of the training after which it is ``end``, in (0, 1].

    Raises:
        TypeError, ValueError: when one of them breaks its rule.
    """

    __slots__ = ()

    def __new__(cls, start: float = 0.6, end: float = 0.01, until: float = 1.0) -> Self:  # noqa: D102 (described by the class)
        start, end = number("start", start, 0, 1), number("end", end, 0, 1)
        return super().__new__(cls, start, end, number("until", until, 0, 1, above=True))

    @classmethod
    def of(cls, value: Self | float) -> Self:
        """``value`` itself, a number as a constant."""
        return value if isinstance(value, cls) else cls(value, value)  # type: ignore[arg-type]  # a number then

    def at(self, progress: float) -> float:
        """The value when the share ``progress`` of the episodes is done."""
        if progress >= self.until:
            return self.end
        return self.start + (self.end - self.start) * (progress / self.until)


class _Harmonic(NamedTuple):
    A: float
    B: float
    C: float


class HarmonicRate(Validated, _Harmonic):  # type: ignore[misc]  # both have _make
    """Step size ``A / (B + C n)`` after n visits (paper, Eq. 15); ``C = 0`` is the constant A / B.

    Args:
        A: greater than 0.
        B: at least A, so that no step is larger than 1.
        C: at least 0.

    Raises:
        TypeError, ValueError: when one of them breaks its rule.
    """

    __slots__ = ()

    def __new__(cls, A: float = 1.0, B: float = 10.0, C: float = 0.01) -> Self:  # noqa: D102 (described by the class)
        a = number("A", A, 0, above=True)
        return super().__new__(cls, a, number("B", B, a), number("C", C, 0))

    def at(self, visits: int) -> float:
        """The step size for the visit after ``visits`` earlier ones."""
        return self.A / (self.B + self.C * visits)
