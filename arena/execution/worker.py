"""What a worker does with a task: drive the runs; failures become outcomes."""

import traceback

from arena.execution import compiled_driver, pettingzoo_driver
from arena.tournament.conditions import Conditions, Run
from arena.tournament.outcome import Outcome


def work(driver: str, conditions: Conditions, runs: list[Run]) -> list[Outcome]:
    """In a worker: drive the runs; what fails is told, not raised."""
    if driver == pettingzoo_driver.NAME:
        return pettingzoo_driver.race(conditions, runs)
    (only,) = runs
    try:
        return [compiled_driver.race(conditions, only)]
    except KeyboardInterrupt:
        raise
    except BaseException:  # sys.exit, too
        return [Outcome.failure(only, driver, traceback.format_exc())]
