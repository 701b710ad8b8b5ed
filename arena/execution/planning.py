"""Which driver runs what, compiled beforehand, in tasks for the workers."""

import logging
import math
from collections.abc import Iterable
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress

import numpy as np

from arena.common.parallel import imap
from arena.execution import compiled_driver, pettingzoo_driver
from arena.execution.checkpoint import savable
from arena.execution.pool import Task
from arena.tournament.conditions import Conditions, Run
from envs.compilation.kernels import CompilationError
from envs.foundation.errors import InvalidValueError

_CARS_TOGETHER = 16  # a group of cars is kept when all of it has finished
_log = logging.getLogger("arena")


def _say_what_starts_anew(conditions: Conditions, runs: list[Run]) -> None:
    for entrant in {one.entrant.name: one.entrant for one in runs}.values():
        with suppress(Exception):  # the agent cannot be created; its run will say so
            if not savable(entrant.create(conditions.hill, np.random.default_rng(0))):
                _log.warning("%s cannot be saved in the middle: its unfinished runs start anew", entrant.name)


def _travel(runs: list[Run]) -> dict[str, str]:
    """Why not, by entrant, for those whose agent cannot be had or sent to a worker."""
    import cloudpickle

    reasons: dict[str, str] = {}
    for entrant in {run.entrant.name: run.entrant for run in runs}.values():
        if entrant.unavailable:
            reasons[entrant.name] = entrant.unavailable
            continue
        try:
            cloudpickle.dumps(entrant)
        except Exception as error:  # whatever its classes raise
            reasons[entrant.name] = f"it cannot be sent to a worker: {type(error).__name__}: {error}"
    return reasons


def _interpreted(conditions: Conditions, runs: list[Run], n_jobs: int, driver: str) -> set[str]:
    """The entrants that are driven in a PettingZoo environment; the others are compiled for."""
    if driver == "pettingzoo":
        return {run.entrant.name for run in runs}
    reasons = _compile(conditions, runs, n_jobs)
    agents = {
        run.entrant.agent: (run.entrant.name, reasons[run.entrant.name])
        for run in runs
        if run.entrant.name in reasons
    }
    for agent, (name, reason) in agents.items():
        if driver == "compiled":
            raise InvalidValueError(f"entrant {name!r} cannot be compiled: {reason}")
        _log.warning("%s runs interpreted: %s", agent.__name__, reason)
    return set(reasons)


def _plan(conditions: Conditions, runs: list[Run], n_jobs: int, interpreted: set[str]) -> list[Task]:
    """Who drives which runs: single compiled ones, and groups of cars in a PettingZoo environment."""
    import joblib

    tasks: list[Task] = [
        (compiled_driver.NAME, conditions, [r]) for r in runs if r.entrant.name not in interpreted
    ]
    together = [r for r in runs if r.entrant.name in interpreted]
    groups = min(joblib.effective_n_jobs(n_jobs), len(together))
    groups = max(groups, math.ceil(len(together) / _CARS_TOGETHER))
    tasks += [(pettingzoo_driver.NAME, conditions, together[g::groups]) for g in range(groups)]
    return tasks


def _compile(conditions: Conditions, runs: Iterable[Run], n_jobs: int) -> dict[str, str]:
    """Compile once for each kind of agent, side by side, before the runs are fanned out.

    Returns:
        Why not, by entrant, for those that cannot be compiled.
    """
    kinds: dict[str, Run] = {}
    kind_of: dict[str, str] = {}
    reasons: dict[str, str] = {}
    for one in {r.entrant.name: r for r in runs}.values():
        if not hasattr(one.entrant.agent, "_fields"):
            reasons[one.entrant.name] = "it is no NamedTuple"
            continue
        try:
            kind = compiled_driver.fingerprint(conditions, one)
        except Exception as error:  # the agent cannot even be created; its run will say so
            reasons[one.entrant.name] = f"{type(error).__name__}: {error}"
            continue
        kinds.setdefault(kind, one)
        kind_of[one.entrant.name] = kind
    answers: dict[str, str] = {}
    tasks = [(kind, conditions, one) for kind, one in kinds.items()]
    with suppress(BrokenProcessPool):
        answers.update(imap(n_jobs, _prepare, tasks))
    for task in tasks:
        if task[0] not in answers:  # a worker died; each of the rest alone, to find out which is guilty
            answers[task[0]] = "a worker died while it was compiled"
            with suppress(BrokenProcessPool):
                answers.update(imap(2, _prepare, [task]))
    return reasons | {name: answers[kind] for name, kind in kind_of.items() if answers[kind]}


def _prepare(kind: str, conditions: Conditions, one: Run) -> tuple[str, str]:
    """In a worker: compile for ``one``; its kind, and why not if it failed."""
    try:
        compiled_driver.prepare(conditions, one)
    except CompilationError as error:
        return kind, str(error)
    except Exception as error:  # the agent cannot be created here; its run will say so
        return kind, f"{type(error).__name__}: {error}"
    return kind, ""
