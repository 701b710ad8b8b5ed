"""Run a tournament: fan its runs out over joblib's workers and keep what comes back."""

from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from itertools import chain
from pathlib import Path

from arena.execution.checkpoint import discard
from arena.execution.planning import _interpreted, _plan, _say_what_starts_anew, _travel
from arena.execution.pool import check_enforceable, survive
from arena.execution.stages import is_decided, pending_runs, stages_of
from arena.execution.watchdog import Limits
from arena.execution.worker import work
from arena.plugins.freshness import renew_workers
from arena.results.provenance import source_digests
from arena.results.results import Results
from arena.results.store import Store
from arena.tournament.outcome import Outcome
from arena.tournament.tournament import Tournament
from envs.foundation.checks import choice, instance, integer, number
from envs.foundation.errors import InvalidValueError

DRIVERS = ("auto", "compiled", "pettingzoo")

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
        raise InvalidValueError("n_jobs must not be 0: give a number of workers, or -1 for one a core")
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
            left = [one for one in stage if one.key not in done]
            for one in left:
                if one.entrant.name in lost:
                    store.add(Outcome.failure(one, "none", lost[one.entrant.name]))
            driven = {one.key: one for one in left if one.entrant.name not in lost}
            total = len(tournament.entrants) * (stage[-1].replicate + 1)
            finished = total - len(driven)
            report(finished, total)
            tasks = _plan(conditions, list(driven.values()), n_jobs, interpreted)
            with closing(survive(n_jobs, work, tasks, limits)) as finishing:
                for outcome in chain.from_iterable(finishing):
                    store.add(outcome)
                    discard(conditions, driven[outcome.key])
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
