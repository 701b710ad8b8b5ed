"""The drivers by their names, and what a worker does with a task."""

from collections.abc import Callable, Sequence

from arena.execution import compiled_driver, pettingzoo_driver
from arena.tournament.conditions import Conditions, Run
from arena.tournament.outcome import Outcome

Drive = Callable[[Conditions, Sequence[Run]], list[Outcome]]
"""A driver: it trains and evaluates the cars of the runs. What fails is an outcome, not an exception."""

DRIVERS: dict[str, Drive] = {
    compiled_driver.NAME: compiled_driver.drive,
    pettingzoo_driver.NAME: pettingzoo_driver.drive,
}


def work(driver: str, conditions: Conditions, runs: Sequence[Run]) -> list[Outcome]:
    """In a worker: drive the runs."""
    return DRIVERS[driver](conditions, runs)
