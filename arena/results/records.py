"""What a results file says of its entrants and their runs, read once."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from arena.common.plain import none_for_nan
from arena.tournament.outcome import Status


@dataclass(frozen=True)
class EntrantRecord:
    """An entrant as its results file describes it; its agent need not be installed.

    Attributes:
        name: what its runs go by.
        agent: the name of its agent.
        parameters: of the agent, as plain values.
    """

    name: str
    agent: str
    parameters: Mapping[str, Any]

    @property
    def bins(self) -> tuple[int, int] | None:
        """The cells along position and velocity, where its parameters say so."""
        bins = self.parameters.get("bins")
        bins = [bins, bins] if isinstance(bins, int) else bins
        if isinstance(bins, list) and len(bins) == 2 and all(isinstance(count, int) for count in bins):
            return bins[0], bins[1]
        return None


@dataclass(frozen=True)
class RunRecord:
    """One run.

    Attributes:
        entrant: the name of who drove.
        agent: the name of its agent.
        parameters: of the agent, as plain values.
        replicate: which repetition.
        accuracy: percentage of the test episodes that reached the goal; NaN if the run failed.
        mean_length: mean steps of those; NaN if there are none.
        iterations: steps of learning.
        seconds: that the run took.
        driver: ``compiled`` or ``pettingzoo``.
        status: whether it finished.
        error: the traceback of a run that failed, else empty.
        max_steps: limit of a test episode.
    """

    entrant: str
    agent: str
    parameters: Mapping[str, Any]
    replicate: int
    accuracy: float
    mean_length: float
    iterations: int
    seconds: float
    driver: str
    status: Status
    error: str
    max_steps: int

    @property
    def key(self) -> tuple[str, int]:
        """Entrant and replicate."""
        return self.entrant, self.replicate

    @property
    def finished(self) -> bool:
        """Whether it did not fail."""
        return self.status == Status.FINISHED

    @property
    def steps(self) -> float:
        """Mean steps of all test episodes, those that failed counted at the limit; NaN if the run failed."""
        share = self.accuracy / 100.0
        if share == 0.0:
            return float(self.max_steps)
        return share * self.mean_length + (1.0 - share) * self.max_steps

    @property
    def reason(self) -> str:
        """The last line of the error."""
        return (self.error.strip().splitlines() or ["no reason"])[-1]

    def to_dict(self) -> dict[str, Any]:
        """Plain values, NaN as None; an error only if there is one."""
        numbers = {name: none_for_nan(getattr(self, name)) for name in ("accuracy", "mean_length")}
        return {
            "entrant": self.entrant,
            "agent": self.agent,
            "parameters": dict(self.parameters),
            "replicate": self.replicate,
            **numbers,
            "iterations": self.iterations,
            "seconds": none_for_nan(self.seconds),
            "driver": self.driver,
            "status": str(self.status),
            "steps": none_for_nan(self.steps),
            **({"error": self.error} if self.error else {}),
        }


def run_record(row: Mapping[str, Any], entrant: EntrantRecord, max_steps: int) -> RunRecord:
    """The record of a row of the table ``runs``, which has been checked."""
    numbers = {
        name: math.nan if row[name] is None else float(row[name])
        for name in ("accuracy", "mean_length", "seconds")
    }
    return RunRecord(
        entrant.name,
        entrant.agent,
        entrant.parameters,
        row["replicate"],
        iterations=row["iterations"],
        driver=row["driver"],
        status=Status(row["status"]),
        error=row["error"],
        max_steps=max_steps,
        **numbers,
    )
