"""Proof of determinism: run a sample again, otherwise, and compare the bits."""

import random
from collections.abc import Iterator

from arena.common.npz import unpack
from arena.common.plain import none_for_nan
from arena.execution import compiled_driver, pettingzoo_driver
from arena.execution.pool import survive
from arena.execution.watchdog import Limits
from arena.execution.worker import work
from arena.results.digests import run_digest
from arena.results.records import RunRecord
from arena.results.results import Results
from arena.tournament.conditions import Conditions, Run
from arena.tournament.configuration import from_dict
from arena.tournament.outcome import Outcome
from envs.compilation.kernels import CompilationError
from envs.foundation.checks import integer
from envs.foundation.errors import InvalidValueError


def verify(results: Results, runs: int = 4) -> Iterator[str]:
    """Run a sample of the finished runs again and tell each difference, in words.

    Each of them is run in the other driver in this process (an agent that cannot be compiled in the
    same), and in its own driver in two threads.
    The results file runs no code: the agents are found by their names among the installed ones.

    Args:
        results: what to verify.
        runs: size of the sample.

    Raises:
        ValueError: when an agent is not installed, or no run is finished.
    """
    import joblib

    stored = {record.key: record for record in results.records if record.finished}
    if not stored:
        raise InvalidValueError(f"{results.path} has no finished run that could be verified")
    config, finished = results.config, {name for name, _ in stored}
    entrants = [entrant for entrant in config["entrants"] if entrant["name"] in finished]
    tournament = from_dict({**config, "entrants": entrants})
    for entrant in tournament.entrants:
        if entrant.unavailable:
            raise InvalidValueError(entrant.unavailable)
    sample = random.Random(0).sample(sorted(stored), min(integer("runs", runs, 1), len(stored)))  # noqa: S311
    chosen = [run for run in tournament.runs if run.key in sample]
    for backend, n_jobs, other in (("loky", 1, True), ("threading", 2, False)):
        tasks = []
        for run in chosen:
            driver = stored[run.key].driver
            chosen_driver = _other(driver, tournament.conditions, run) if other else driver
            tasks.append((chosen_driver, tournament.conditions, [run]))
        with joblib.parallel_config(backend=backend):
            for outcomes in survive(n_jobs, work, tasks, Limits()):
                for outcome in outcomes:
                    before = stored[outcome.key]
                    difference = _difference(results, before, outcome)
                    if difference:
                        yield (
                            f"replicate {outcome.replicate} of {outcome.entrant!r} differs in {difference} "
                            f"({outcome.driver} driver, {backend}, {n_jobs} workers)"
                        )


def _other(driver: str, conditions: Conditions, run: Run) -> str:
    """The other driver; the same one for an agent that cannot be compiled."""
    if driver == compiled_driver.NAME:
        return pettingzoo_driver.NAME
    if not hasattr(run.entrant.agent, "_fields"):
        return driver
    try:
        compiled_driver.prepare(conditions, run)
    except CompilationError:
        return driver
    return compiled_driver.NAME


def _difference(results: Results, stored: RunRecord, outcome: Outcome) -> str:
    """What differs first; empty if nothing does."""
    if outcome.error:
        return f"its end: {outcome.error.strip().splitlines()[-1]}"
    before, after = results.arrays(*outcome.key), unpack(outcome.arrays)
    if run_digest(outcome, after) == run_digest(stored, before):
        return ""
    for name in ("status", "accuracy", "mean_length", "iterations"):
        then, now = (none_for_nan(getattr(run, name)) for run in (stored, outcome))
        if then != now:
            return f"{name}: {then} before, {now} now"
    names = sorted(before.keys() | after.keys())
    return next(
        name
        for name in names
        if name not in before or name not in after or before[name].tobytes() != after[name].tobytes()
    )
