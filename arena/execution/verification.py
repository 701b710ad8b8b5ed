"""Proof of determinism: run a sample again, otherwise, and compare the bits."""

import random
from collections.abc import Iterator
from dataclasses import asdict

from arena.common.npz import unpack
from arena.execution import compiled_driver, pettingzoo_driver
from arena.execution.pool import survive
from arena.execution.watchdog import Limits
from arena.execution.worker import work
from arena.results.digests import run_digest
from arena.results.results import Results, plain_scores
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

    stored = {(run["entrant"], run["replicate"]): run for run in results.runs if run["status"] == "finished"}
    if not stored:
        raise InvalidValueError(f"{results.path} has no finished run that could be verified")
    finished = [one for one in results.config["entrants"] if any(one["name"] == name for name, _ in stored)]
    tournament = from_dict({**results.config, "entrants": finished})
    for entrant in tournament.entrants:
        if entrant.unavailable:
            raise InvalidValueError(entrant.unavailable)
    sample = random.Random(0).sample(sorted(stored), min(integer("runs", runs, 1), len(stored)))  # noqa: S311
    chosen = [run for run in tournament.runs if (run.entrant.name, run.replicate) in sample]
    for backend, n_jobs, other in (("loky", 1, True), ("threading", 2, False)):
        tasks = []
        for run in chosen:
            driver = stored[run.entrant.name, run.replicate]["driver"]
            chosen_driver = _other(driver, tournament.conditions, run) if other else driver
            tasks.append((chosen_driver, tournament.conditions, [run]))
        with joblib.parallel_config(backend=backend):
            for outcomes in survive(n_jobs, work, tasks, Limits()):
                for outcome in outcomes:
                    before = stored[outcome.entrant, outcome.replicate]
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


def _difference(results: Results, stored: dict[str, object], outcome: Outcome) -> str:
    """What differs first; empty if nothing does."""
    if outcome.error:
        return f"its end: {outcome.error.strip().splitlines()[-1]}"
    scores = plain_scores(asdict(outcome))
    before = results.arrays(outcome.entrant, outcome.replicate)
    after = unpack(outcome.arrays)
    if run_digest({**stored, **scores}, after) == run_digest(stored, before):
        return ""
    for name in ("status", "accuracy", "mean_length", "iterations"):
        if scores[name] != stored[name]:
            return f"{name}: {stored[name]} before, {scores[name]} now"
    names = sorted(before.keys() | after.keys())
    return next(
        name
        for name in names
        if name not in before or name not in after or before[name].tobytes() != after[name].tobytes()
    )
