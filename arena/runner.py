"""Run a tournament: fan its runs out over joblib's workers and keep what comes back."""

import logging
import math
import traceback
from collections.abc import Callable, Iterable
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, suppress
from dataclasses import replace
from itertools import chain
from pathlib import Path

import numpy as np

from arena import compiled_driver, pettingzoo_driver
from arena.checkpoint import discard, savable
from arena.claims import Limits
from arena.freshness import renew_workers
from arena.outcome import Outcome, failed
from arena.pool import Task, check_enforceable, imap, survive
from arena.provenance import source_digests
from arena.results import Results
from arena.stages import is_decided, pending_runs, stages_of
from arena.store import Store
from arena.tournament import Conditions, Run, Tournament
from envs.checks import choice, instance, integer, number
from envs.compilation import CompilationError

DRIVERS = ("auto", "compiled", "pettingzoo")
_CARS_TOGETHER = 16  # a group of cars is kept when all of it has finished
_log = logging.getLogger("arena")

Progress = Callable[[int, int], None]


def run(
    tournament: Tournament,
    out: str | Path | None = None,
    n_jobs: int = -1,
    driver: str = "auto",
    *,
    progress: Progress | None = None,
    checkpoint_seconds: float = 30.0,
) -> Results:
    """Run what is not finished of ``tournament``, over the cores.

    The results are the same bits whatever the workers, the joblib backend (that of
    ``joblib.parallel_config``), the driver and the other entrants.

    Args:
        tournament: what to race.
        out: results file; one of the same tournament is continued. None: kept only for as long as
            the returned object.
        n_jobs: workers, as joblib counts them: -1 is one a core.
        driver: ``"compiled"``, ``"pettingzoo"``, or ``"auto"``: compiled where the agent can be.
        checkpoint_seconds: a run that takes longer is saved so often beside ``out``, and goes on from
            there if it is interrupted.
        progress: called with the number of finished runs and of all, at the start and after each; of
            adaptive replicates all are those until the next look.

    Raises:
        TypeError, ValueError: when an argument breaks its rule, ``out`` is another tournament's
            file or cannot be written, or an agent cannot be compiled that has to be.
    """
    instance("tournament", tournament, Tournament)
    choice("driver", driver, DRIVERS)
    if integer("n_jobs", n_jobs) == 0:
        raise ValueError("n_jobs must not be 0: give a number of workers, or -1 for one a core")
    seconds = number("checkpoint_seconds", checkpoint_seconds, 0)
    limits = Limits(tournament.time_limit, tournament.memory_limit)
    check_enforceable(limits)
    path = None if out is None else Path(out)
    config = tournament.to_dict()
    resuming = path is not None and path.exists()
    agents = {entrant.agent for entrant in tournament.entrants if not entrant.unavailable}
    sources = source_digests(agents)
    renew_workers(agents)
    store = Store.resume(path, config, sources) if path is not None and resuming else None
    done = store.finished() if store else set()
    stages = stages_of(tournament)
    try:
        pending = pending_runs(tournament, stages, store, done)
        lost = _travel(pending)
        travellers = [one for one in pending if one.entrant.name not in lost]
        folder = None if path is None else f"{path}.checkpoints"
        conditions = replace(tournament.conditions, checkpoints=folder, checkpoint_seconds=seconds)
        interpreted = _interpreted(conditions, travellers, n_jobs, driver)
        store = store or Store.create(path, config, sources)
        if resuming:
            _say_what_starts_anew(conditions, travellers)
        report = progress or (lambda _finished, _total: None)
        for stage, look in stages:
            left = [one for one in stage if (one.entrant.name, one.replicate) not in done]
            for one in left:
                if one.entrant.name in lost:
                    store.add(failed(one, "none", lost[one.entrant.name]))
            driven = {(one.entrant.name, one.replicate): one for one in left if one.entrant.name not in lost}
            total = len(tournament.entrants) * (stage[-1].replicate + 1)
            finished = total - len(driven)
            report(finished, total)
            tasks = _plan(conditions, list(driven.values()), n_jobs, interpreted)
            with closing(survive(n_jobs, work, tasks, limits)) as finishing:
                for outcome in chain.from_iterable(finishing):
                    store.add(outcome)
                    discard(conditions, driven[outcome.entrant, outcome.replicate])
                    finished += 1
                    report(finished, total)
            if look and is_decided(tournament, store, look):
                break
    except BaseException:
        if store:
            store.close()
        raise
    store.release()
    return Results(store)


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
            raise ValueError(f"entrant {name!r} cannot be compiled: {reason}")
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
        return [failed(only, driver, traceback.format_exc())]
