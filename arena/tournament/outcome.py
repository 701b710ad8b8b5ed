"""What a run leaves behind."""

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from arena.common.npz import Arrays, pack
from arena.tournament.conditions import Run, identity_of
from envs.foundation.errors import InvalidValueError


class Status(StrEnum):
    """How a run ended."""

    FINISHED = "finished"
    FAILED = "failed"


@dataclass(frozen=True)
class Outcome:
    """Scores and arrays of one run, in values that any process can receive.

    Attributes:
        entrant, replicate: which run.
        driver: ``compiled`` or ``pettingzoo``.
        status: whether it finished.
        accuracy: percentage of the test episodes that reached the goal.
        mean_length: mean steps of those that did; NaN if none did.
        iterations: steps of learning.
        seconds: that the run took.
        arrays: of the agent and of its episodes, as the bytes of an ``.npz`` file.
        error: what went wrong, with its traceback; empty if nothing did.
    """

    entrant: str
    replicate: int
    driver: str
    status: Status
    accuracy: float = math.nan
    mean_length: float = math.nan
    iterations: int = 0
    seconds: float = 0.0
    arrays: bytes = b""
    error: str = ""

    @property
    def key(self) -> tuple[str, int]:
        """Entrant and replicate."""
        return self.entrant, self.replicate

    @property
    def identity(self) -> str:
        """What its car was called."""
        return identity_of(*self.key)

    @classmethod
    def finished(
        cls,
        run: Run,
        driver: str,
        agent: Any,
        lengths: NDArray[np.int64],
        test_lengths: NDArray[np.int64],
        test_reached: NDArray[np.bool_],
        seconds: float,
    ) -> Self:
        """The outcome of a run that came to its end.

        Raises:
            ValueError: when an array of the agent has NaN: its scores would mean nothing.
        """
        accuracy, mean_length = score(test_lengths, test_reached)
        arrays = agent_arrays(agent)
        for name, array in arrays.items():
            if np.issubdtype(array.dtype, np.inexact) and np.isnan(array).any():
                raise InvalidValueError(
                    f"{name} must be free of NaN after training, got {np.isnan(array).sum()} of them"
                )
        arrays |= {"lengths": lengths, "test_lengths": test_lengths, "test_reached": test_reached}
        return cls(
            *run.key,
            driver,
            Status.FINISHED,
            accuracy,
            mean_length,
            int(lengths.sum()),
            seconds,
            pack(arrays),
        )

    @classmethod
    def failure(cls, run: Run, driver: str, error: str, seconds: float = 0.0) -> Self:
        """The outcome of a run that did not finish, and why."""
        return cls(*run.key, driver, Status.FAILED, seconds=seconds, error=error)


def score(lengths: NDArray[np.int64], reached: NDArray[np.bool_]) -> tuple[float, float]:
    """The paper's accuracy in percent and mean length of the successful episodes (section 4.3)."""
    successful = lengths[reached]
    accuracy = 100.0 * len(successful) / len(lengths)
    return accuracy, float(successful.mean()) if len(successful) else math.nan


def agent_arrays(agent: Any) -> Arrays:
    """The arrays that are fields or attributes of the agent, by name."""
    fields = agent._asdict() if hasattr(agent, "_asdict") else getattr(agent, "__dict__", {})
    return {
        name: value
        for name, value in fields.items()
        if isinstance(value, np.ndarray) and not value.dtype.hasobject
    }
