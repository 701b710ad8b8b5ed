"""Tasks over joblib's workers, of which any may die at any moment.

joblib gives up a whole call when one worker dies. Here what is unfinished goes on with new workers; the
tasks that were being worked on then are tried again, each alone, so that the guilty is found and its
neighbours are not blamed.
"""

import os
import re
import tempfile
from collections.abc import Callable, Generator
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing
from pathlib import Path

from arena.common.parallel import parallel_map_unordered
from arena.execution.watchdog import Limits, lease, open_leases, parent_watchdog
from arena.tournament.conditions import Conditions, Run
from arena.tournament.outcome import Outcome
from envs.foundation.errors import InvalidValueError

Work = Callable[[str, Conditions, list[Run]], list[Outcome]]
Task = tuple[str, Conditions, list[Run]]
Outcomes = Generator[list[Outcome], None, None]
_UNEXPLAINED = 3  # deaths without a suspect before all are tried alone


def check_enforceable(limits: Limits) -> None:
    """See that limits can be enforced.

    Raises:
        ValueError: when there are limits and joblib's backend has no worker processes.
    """
    from joblib.parallel import get_active_backend

    backend, _ = get_active_backend()
    if limits and getattr(backend, "supports_sharedmem", False):
        raise InvalidValueError(
            "time_limit and memory_limit must be enforced in worker processes, got the joblib backend "
            f"{type(backend).__name__}, which has none"
        )


def run_tasks(n_jobs: int, work: Work, tasks: list[Task], limits: Limits) -> Outcomes:
    """The outcomes of all tasks, of those whose worker died as failed."""
    with tempfile.TemporaryDirectory(prefix="arena-") as name:
        folder = Path(name)
        with parent_watchdog(folder, limits):
            yield from _run_until_done(n_jobs, work, tasks, limits, folder)


def _run_until_done(
    n_jobs: int, work: Work, tasks: list[Task], limits: Limits, folder: Path, *, alone: bool = False
) -> Outcomes:
    unexplained = 0
    left = {run.identity: (driver, conditions, run) for driver, conditions, runs in tasks for run in runs}
    while tasks:
        arguments = [(work, task, folder, limits, os.getpid()) for task in tasks]
        try:
            with closing(
                parallel_map_unordered(n_jobs, _lease_and_work, arguments, apart=bool(limits))
            ) as results:
                for outcomes in results:
                    for outcome in outcomes:
                        del left[outcome.identity]
                    yield outcomes
        except BrokenProcessPool as death:
            suspects = _suspects(folder)
            unexplained += not suspects
            if unexplained == _UNEXPLAINED:  # they die before they can leave a lease
                suspects = dict.fromkeys(left, "")
            if alone:  # the second death, and nobody else is there
                suspects = {name: reason or _exit_codes(death) for name, reason in suspects.items()}
        else:
            return
        yield from _retry_alone(suspects, left, work, limits, folder)
        tasks = [
            (driver, conditions, remaining)
            for driver, conditions, runs in tasks
            if (remaining := [run for run in runs if run.identity in left])
        ]


def _retry_alone(
    suspects: dict[str, str],
    left: dict[str, tuple[str, Conditions, Run]],
    work: Work,
    limits: Limits,
    folder: Path,
) -> Outcomes:
    """The outcomes of the suspects, which leave ``left``: failed where the reason is known."""
    for identity, reason in suspects.items():
        driver, conditions, run = left.pop(identity)
        if reason:
            yield [Outcome.failure(run, driver, f"the worker died: {reason}")]
        else:
            yield from _run_until_done(2, work, [(driver, conditions, [run])], limits, folder, alone=True)


def _lease_and_work(work: Work, task: Task, folder: Path, limits: Limits, parent: int) -> list[Outcome]:
    """In a worker."""
    with lease(folder, [run.identity for run in task[2]], limits, parent):
        return work(*task)


def _suspects(folder: Path) -> dict[str, str]:
    """The runs that were being driven when a worker died, with the reason where it is known."""
    reasons: dict[str, str] = {}
    for open_lease in open_leases(folder):
        for identity in open_lease.runs:
            # Of several cars driven together any may be the one that broke the limit.
            reasons[identity] = open_lease.reason if len(open_lease.runs) == 1 else ""
    for path in folder.iterdir():
        path.unlink(missing_ok=True)
    return reasons


def _exit_codes(death: BrokenProcessPool) -> str:
    """What the message of joblib says of the exit code, such as ``SIGSEGV(-11)``."""
    codes = re.search(r"exit codes of the workers are \{(.*?)\}", str(death))
    return f"exit code {codes[1]}" if codes else str(death).splitlines()[0]
