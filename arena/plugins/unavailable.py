"""An agent that is asked for but cannot be had: its entrants fail, the others race."""

from functools import cache
from typing import Any, ClassVar

from agents.baselines import DoesNotLearn


class Unavailable(DoesNotLearn):
    """Stands in for it, with whatever parameters; see ``unavailable``.

    Attributes:
        asked: the name that was asked for.
        reason: why it cannot be had, one sentence.
    """

    asked: ClassVar[str]
    reason: ClassVar[str]

    def __init__(self, **parameters: Any) -> None:
        raise ImportError(self.reason)


@cache
def unavailable(asked: str, reason: str) -> type[Unavailable]:
    """A stand-in for the agent called ``asked``, the same class for the same reason."""
    return type("Unavailable", (Unavailable,), {"asked": asked, "reason": reason})
