"""Run a tournament: fan its runs out over joblib's workers and keep what comes back."""

from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path
from typing import Any

from arena.execution.checkpoint import discard
from arena.execution.planning import (
    choose_interpreted,
    find_unrunnable,
    make_agents,
    plan_tasks,
    warn_if_not_resumable,
)
from arena.execution.pool import check_enforceable, run_tasks
from arena.execution.stages import Stage, is_decided, pending_runs, stages_of
from arena.execution.watchdog import Limits
from arena.execution.worker import DRIVERS, work
from arena.plugins.freshness import renew_workers
from arena.results.continuation import as_read
from arena.results.growth import Growth, growth
from arena.results.provenance import source_digests
from arena.results.results import Results
from arena.results.schema import replicates_of
from arena.results.store import Store
from arena.results.versions import versions_of
from arena.statistics.sequential import ADAPTIVE
from arena.tournament.conditions import Conditions, Run
from arena.tournament.outcome import Outcome
from arena.tournament.tournament import Tournament
from envs.foundation.checks import choice, instance, integer, number
from envs.foundation.errors import InvalidValueError

Progress = Callable[[int, int], None]


def run(
    tournament: Tournament,
    out: str | Path | None = None,
    n_jobs: int = -1,
    driver: str = "auto",
    *,
    progress: Progress | None = None,
    checkpoint_seconds: float = 30.0,
    replicates: range | None = None,
) -> Results:
    """Run what is not finished of ``tournament``, over the cores.

    The results are the same bits whatever the workers, the joblib backend (that of
    ``joblib.parallel_config``), the driver and the other entrants.

    Args:
        tournament: what to race.
        out: results file. Of one that is there those runs are kept that are the tournament's, whatever
            has changed in it but its name, hill, training, evaluation and seed; ``preview`` tells which.
            None: kept only for as long as the returned object.
        n_jobs: workers, as joblib counts them: -1 is one a core.
        driver: ``"compiled"``, ``"pettingzoo"``, or ``"auto"``: compiled where the agent can be.
        checkpoint_seconds: a run that takes longer is saved so often beside ``out``, and goes on from
            there if it is interrupted.
        progress: called with the number of finished runs and of all, at the start and after each; of
            adaptive replicates all are those until the next look.
        replicates: those to run; the others are left to another process, or to later. All, if None.

    Raises:
        TypeError, ValueError: when an argument breaks its rule, ``out`` is another tournament's
            file or cannot be written, a parameter breaks a rule that only its agent knows, or an agent
            cannot be compiled that has to be.
    """
    instance("tournament", tournament, Tournament)
    choice("driver", driver, ("auto", *DRIVERS))
    if integer("n_jobs", n_jobs) == 0:
        raise InvalidValueError("n_jobs must not be 0: give a number of workers, or -1 for one a core")
    seconds = number("checkpoint_seconds", checkpoint_seconds, 0)
    limits = Limits(tournament.time_limit, tournament.memory_limit)
    check_enforceable(limits)
    only = _checked_replicates(tournament, replicates)
    path = None if out is None else Path(out)
    resuming = path is not None and path.exists()
    agents = _agents(tournament)
    config, sources = tournament.to_dict(), source_digests(agents)
    renew_workers(agents)
    stages = stages_of(tournament, only)
    pending = _pending(tournament, stages, path if resuming else None, config, sources, only)
    unrunnable = find_unrunnable(pending)
    runnable = [run for run in pending if run.entrant.name not in unrunnable]
    conditions = replace(
        tournament.conditions,
        checkpoints=None if path is None else f"{path}.checkpoints",
        checkpoint_seconds=seconds,
    )
    samples = make_agents(conditions, runnable)
    interpreted = choose_interpreted(conditions, runnable, samples, n_jobs, driver)
    # Only now is the file touched: whatever is wrong with the tournament has been told.
    store = Store.resume(path, config, sources) if path and resuming else Store.create(path, config, sources)
    try:
        done = store.finished()
        if resuming:
            warn_if_not_resumable(samples)
        execution = _Execution(store, conditions, n_jobs, limits, interpreted, unrunnable)
        before = 0
        for stage, look in stages:
            before += len(stage)
            execution.run_stage([run for run in stage if run.key not in done], before, progress)
            if look and is_decided(tournament, store, look):
                break
    except BaseException:
        store.close()
        raise
    store.release()
    return Results(store)


def preview(tournament: Tournament, out: str | Path | None = None, replicates: range | None = None) -> Growth:
    """What ``run`` with the same arguments would keep, and what it would run; nothing is written.

    Raises:
        TypeError, ValueError: when an argument breaks its rule, or ``out`` is another tournament's file.
    """
    only = _checked_replicates(instance("tournament", tournament, Tournament), replicates)
    config, sources = tournament.to_dict(), source_digests(_agents(tournament))
    path = None if out is None else Path(out)
    if path is None or not path.exists():
        config = as_read(config)
        return growth(config, versions_of(config, sources), range(replicates_of(config)), only)
    with closing(Store.read(path)) as store:
        return store.growth(config, sources, only)


def _pending(
    tournament: Tournament,
    stages: list[Stage],
    path: Path | None,
    config: dict[str, Any],
    sources: dict[str, str],
    only: range,
) -> list[Run]:
    """What may have to be run; nothing if what is finished in the file at ``path`` decides."""
    if path is None:
        return pending_runs(tournament, stages, None, frozenset())
    with closing(Store.read(path)) as store:
        plan = store.growth(config, sources, only)
        unchanged = not plan.reasons and not plan.aside
        return pending_runs(tournament, stages, store if unchanged else None, plan.kept)


def _checked_replicates(tournament: Tournament, replicates: range | None) -> range:
    every = range(replicates_of(tournament.to_dict()))
    if replicates is None:
        return every
    instance("replicates", replicates, range)
    if (
        tournament.replicates == ADAPTIVE
        or replicates.step != 1
        or not replicates
        or not (replicates[0] in every and replicates[-1] in every)
    ):
        raise InvalidValueError(
            f"replicates must be neighbours among the {len(every)} of a tournament that is not adaptive, "
            f"got {replicates}"
        )
    return replicates


def _agents(tournament: Tournament) -> set[type[Any]]:
    return {entrant.agent for entrant in tournament.entrants if not entrant.unavailable}


@dataclass(frozen=True)
class _Execution:
    """How the runs of a tournament are driven, and where they are kept."""

    store: Store
    conditions: Conditions
    n_jobs: int
    limits: Limits
    interpreted: set[str]
    unrunnable: dict[str, str]

    def run_stage(self, runs: list[Run], total: int, progress: Progress | None) -> None:
        """Drive ``runs``, which bring the tournament to ``total`` finished ones, and keep each."""
        for run in runs:
            if run.entrant.name in self.unrunnable:
                self.store.add(Outcome.failure(run, "none", self.unrunnable[run.entrant.name]))
        driven = {run.key: run for run in runs if run.entrant.name not in self.unrunnable}
        report = progress or (lambda _finished, _total: None)
        finished = total - len(driven)
        report(finished, total)
        tasks = plan_tasks(self.conditions, list(driven.values()), self.n_jobs, self.interpreted)
        with closing(run_tasks(self.n_jobs, work, tasks, self.limits)) as outcomes:
            for outcome in chain.from_iterable(outcomes):
                self.store.add(outcome)
                discard(self.conditions, driven[outcome.key])
                finished += 1
                report(finished, total)
