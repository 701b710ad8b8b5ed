"""How epsilon and the step size change while an agent learns."""

from typing import Annotated, NamedTuple, Self

from annotated_types import Interval

from agents.parameters.declared import NonNegative, Positive, Probability
from agents.parameters.validation import validated
from envs.foundation.checks import number


@validated
class LinearDecay(NamedTuple):
    """From ``start`` to ``end`` in a straight line over the training (paper, section 4.3).

    Args:
        start: value in the first episode, in [0, 1].
        end: value that is approached in the last, in [0, 1].
        until: share of the training after which it is ``end``, in (0, 1].

    Raises:
        TypeError, ValueError: when one of them breaks its rule.
    """

    start: Probability = 0.6
    end: Probability = 0.01
    until: Annotated[float, Interval(gt=0, le=1)] = 1.0

    @classmethod
    def of(cls, value: Self | float) -> Self:
        """``value`` itself, a number as a constant."""
        return cls(value, value) if isinstance(value, (int, float)) else value

    def at(self, progress: float) -> float:
        """The value when the share ``progress`` of the episodes is done."""
        if progress >= self.until:
            return self.end
        return self.start + (self.end - self.start) * (progress / self.until)


@validated
class HarmonicRate(NamedTuple):
    """Step size ``A / (B + C n)`` after n visits (paper, Eq. 15); ``C = 0`` is the constant A / B.

    Args:
        A: greater than 0.
        B: at least A, so that no step is larger than 1.
        C: at least 0.

    Raises:
        TypeError, ValueError: when one of them breaks its rule.
    """

    A: Positive = 1.0
    B: Positive = 10.0
    C: NonNegative = 0.01

    def __post_init__(self) -> None:
        """See that no step is larger than 1."""
        number("B", self.B, self.A)

    def at(self, visits: int) -> float:
        """The step size for the visit after ``visits`` earlier ones."""
        return self.A / (self.B + self.C * visits)
