"""Before anything is driven: the agents are looked at once, compiled, and put into tasks for the workers."""

import logging
import math
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from typing import Any

from arena.common.parallel import parallel_map_unordered
from arena.execution import compiled_driver, pettingzoo_driver
from arena.execution.checkpoint import savable
from arena.execution.pool import Task
from arena.tournament.conditions import Conditions, Run
from envs.compilation.kernels import CompilationError
from envs.foundation.errors import InvalidValueError, naming

_CARS_TOGETHER = 16  # a group of cars is kept when all of it has finished
_log = logging.getLogger("arena")


def first_runs(runs: Iterable[Run]) -> dict[str, Run]:
    """One run of each entrant, by its name."""
    firsts: dict[str, Run] = {}
    for run in runs:
        firsts.setdefault(run.entrant.name, run)
    return firsts


def find_unrunnable(runs: Iterable[Run]) -> dict[str, str]:
    """Why not, by entrant, for those whose agent cannot be had or sent to a worker."""
    import cloudpickle

    reasons: dict[str, str] = {}
    for name, run in first_runs(runs).items():
        if run.entrant.unavailable:
            reasons[name] = run.entrant.unavailable
            continue
        try:
            cloudpickle.dumps(run.entrant)
        except Exception as error:  # whatever its classes raise
            reasons[name] = f"it cannot be sent to a worker: {type(error).__name__}: {error}"
    return reasons


def make_agents(conditions: Conditions, runs: Iterable[Run]) -> dict[str, Any]:
    """An agent of each entrant, to look at; none of one whose agent is bad: its runs will fail and tell.

    Raises:
        InvalidTypeError, InvalidValueError: when a parameter breaks a rule that only ``create`` knows.
    """
    agents: dict[str, Any] = {}
    for name, run in first_runs(runs).items():
        try:
            with naming(f"entrant {name!r}", (TypeError, ValueError)):
                agents[name] = compiled_driver.untrained(conditions, run)
        except (TypeError, ValueError):
            raise
        except Exception:  # no bad parameter but a bad agent
            _log.debug("entrant %r cannot be created", name, exc_info=True)
    return agents


def warn_if_not_resumable(agents: Mapping[str, Any]) -> None:
    """Say whose unfinished runs start anew."""
    for name, agent in agents.items():
        if not savable(agent):
            _log.warning("%s cannot be saved in the middle: its unfinished runs start anew", name)


def choose_interpreted(
    conditions: Conditions, runs: Sequence[Run], agents: Mapping[str, Any], n_jobs: int, driver: str
) -> set[str]:
    """The entrants that are driven in a PettingZoo environment; the others are compiled.

    Args:
        conditions: of the tournament.
        runs: what is to be driven.
        agents: of ``make_agents``.
        n_jobs: workers.
        driver: that was asked for.

    Raises:
        InvalidValueError: when an agent cannot be compiled that has to be.
    """
    firsts = first_runs(runs)
    if driver == pettingzoo_driver.NAME:
        return set(firsts)
    reasons = _compile(conditions, firsts, agents, n_jobs)
    by_class = {firsts[name].entrant.agent: (name, reason) for name, reason in reasons.items()}
    for agent, (name, reason) in by_class.items():
        if driver == compiled_driver.NAME:
            raise InvalidValueError(f"entrant {name!r} cannot be compiled: {reason}")
        _log.warning("%s runs interpreted: %s", agent.__name__, reason)
    return set(reasons)


def plan_tasks(conditions: Conditions, runs: Sequence[Run], n_jobs: int, interpreted: set[str]) -> list[Task]:
    """Who drives which runs: single compiled ones, and groups of cars in a PettingZoo environment."""
    import joblib

    tasks: list[Task] = [
        (compiled_driver.NAME, conditions, [run]) for run in runs if run.entrant.name not in interpreted
    ]
    together = [run for run in runs if run.entrant.name in interpreted]
    groups = min(joblib.effective_n_jobs(n_jobs), len(together))
    groups = max(groups, math.ceil(len(together) / _CARS_TOGETHER))
    tasks += [(pettingzoo_driver.NAME, conditions, together[g::groups]) for g in range(groups)]
    return tasks


def _compile(
    conditions: Conditions, firsts: Mapping[str, Run], agents: Mapping[str, Any], n_jobs: int
) -> dict[str, str]:
    """Compile once for each kind of agent, side by side, before the runs are fanned out.

    Returns:
        Why not, by entrant, for those that cannot be compiled.
    """
    tasks: dict[str, tuple[str, Conditions, Run]] = {}
    kind_of: dict[str, str] = {}
    reasons: dict[str, str] = {}
    for name, run in firsts.items():
        if not hasattr(run.entrant.agent, "_fields"):
            reasons[name] = "it is no NamedTuple"
            continue
        if name not in agents:
            reasons[name] = "it cannot be created"
            continue
        try:
            kind = compiled_driver.fingerprint(conditions, run, agents[name])
        except Exception as error:  # whatever its parts raise when they are looked at
            reasons[name] = f"{type(error).__name__}: {error}"
            continue
        tasks.setdefault(kind, (kind, conditions, run))
        kind_of[name] = kind
    answers: dict[str, str] = {}
    with suppress(BrokenProcessPool):
        answers.update(parallel_map_unordered(n_jobs, _prepare, list(tasks.values())))
    for kind, task in tasks.items():
        if kind not in answers:  # a worker died; each of the rest alone, to find out which is guilty
            answers[kind] = "a worker died while it was compiled"
            with suppress(BrokenProcessPool):
                answers.update(parallel_map_unordered(2, _prepare, [task]))
    return reasons | {name: answers[kind] for name, kind in kind_of.items() if answers[kind]}


def _prepare(kind: str, conditions: Conditions, run: Run) -> tuple[str, str]:
    """In a worker: compile for ``run``; its kind, and why not if it failed."""
    try:
        compiled_driver.prepare(conditions, run, compiled_driver.untrained(conditions, run))
    except CompilationError as error:
        return kind, str(error)
    except Exception as error:  # the agent cannot be created here; its run will say so
        return kind, f"{type(error).__name__}: {error}"
    return kind, ""
