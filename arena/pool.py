"""Tasks over joblib's workers, of which any may die at any moment.

joblib gives up a whole call when one worker dies. Here what is unfinished goes on with new workers; the
tasks that were being worked on then are tried again, each alone, so that the guilty is found and its
neighbours are not blamed.
"""

import os
import re
import tempfile
import threading
import time
import warnings
from collections.abc import Callable, Generator
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, suppress
from functools import cache
from pathlib import Path
from typing import Any

from arena import claims
from arena.claims import Limits
from arena.outcome import Outcome, failed
from arena.tournament import Conditions, Run

Work = Callable[[str, Conditions, list[Run]], list[Outcome]]
Task = tuple[str, Conditions, list[Run]]
Finishing = Generator[list[Outcome], None, None]
_UNEXPLAINED = 3  # deaths without a suspect before all are tried alone


def imap(
    n_jobs: int, function: Callable[..., Any], tasks: list[Any], *, apart: bool = False
) -> Generator[Any, None, None]:
    """The results as they come in, where joblib's backend can do that, else at the end.

    Args:
        n_jobs: workers, as joblib counts them.
        function: called with each of ``tasks``.
        tasks: tuples of arguments.
        apart: whether even a single worker must be a process of its own.
    """
    import joblib

    if not tasks:
        return
    # Tasks are long; in batches of several, one worker would end long after the others.
    options: dict[str, Any] = {"n_jobs": n_jobs, "batch_size": 1}
    if apart and joblib.effective_n_jobs(n_jobs) == 1:
        options |= {"n_jobs": 2, "pre_dispatch": 1}  # joblib's one worker is this process
    try:
        parallel = joblib.Parallel(return_as="generator_unordered", max_nbytes=None, **options)
    except ValueError:
        parallel = joblib.Parallel(max_nbytes=None, **options)
    results = parallel(joblib.delayed(_serve)(os.getpid(), function, task) for task in tasks)
    try:
        for result in results:  # noqa: UP028 (``yield from`` would close it before the warning is off)
            yield result
    finally:
        with warnings.catch_warnings(), suppress(AttributeError):  # a list needs no closing
            warnings.simplefilter("ignore", UserWarning)  # that cancelled tasks took time for nothing
            results.close()


def _serve(parent: int, function: Callable[..., Any], task: tuple[Any, ...]) -> Any:
    """In a worker: call ``function``, and do not outlive the parent."""
    if os.getpid() != parent:
        _leave_with(parent)
    return function(*task)


@cache
def _leave_with(parent: int) -> None:
    """End this process soon after the parent, which may be killed without a word."""
    import psutil

    born_of = os.getppid()  # changes when the parent dies, but not on Windows

    def watch() -> None:
        while os.getppid() == born_of and psutil.pid_exists(parent):
            time.sleep(0.5)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def check_enforceable(limits: Limits) -> None:
    """See that limits can be enforced.

    Raises:
        ValueError: when there are limits and joblib's backend has no worker processes.
    """
    from joblib.parallel import get_active_backend

    backend, _ = get_active_backend()
    if limits and getattr(backend, "supports_sharedmem", False):
        raise ValueError(
            "time_limit and memory_limit must be enforced in worker processes, got the joblib backend "
            f"{type(backend).__name__}, which has none"
        )


def survive(n_jobs: int, work: Work, tasks: list[Task], limits: Limits) -> Finishing:
    """The outcomes of all tasks, of those whose worker died as failed."""
    with tempfile.TemporaryDirectory(prefix="arena-") as name:
        folder = Path(name)
        with claims.backstop(folder, limits):
            yield from _survive(n_jobs, work, tasks, limits, folder)


def _survive(
    n_jobs: int, work: Work, tasks: list[Task], limits: Limits, folder: Path, *, alone: bool = False
) -> Finishing:
    unexplained = 0
    left = {run.identity: (driver, conditions, run) for driver, conditions, runs in tasks for run in runs}
    while tasks:
        arguments = [(work, task, folder, limits, os.getpid()) for task in tasks]
        try:
            with closing(imap(n_jobs, _claim_and_work, arguments, apart=bool(limits))) as finishing:
                for outcomes in finishing:
                    for outcome in outcomes:
                        del left[f"{outcome.entrant}#{outcome.replicate}"]
                    yield outcomes
        except BrokenProcessPool as death:
            suspects = _suspects(folder)
            unexplained += not suspects
            if unexplained == _UNEXPLAINED:  # they die before they can claim anything
                suspects = dict.fromkeys(left, "")
            if alone:  # the second death, and nobody else is there
                suspects = {name: reason or _exit_codes(death) for name, reason in suspects.items()}
        else:
            return
        yield from _try_alone(suspects, left, work, limits, folder)
        tasks = [
            (driver, conditions, remaining)
            for driver, conditions, runs in tasks
            if (remaining := [run for run in runs if run.identity in left])
        ]


def _try_alone(
    suspects: dict[str, str],
    left: dict[str, tuple[str, Conditions, Run]],
    work: Work,
    limits: Limits,
    folder: Path,
) -> Finishing:
    """The outcomes of the suspects, which leave ``left``: failed where the reason is known."""
    for identity, reason in suspects.items():
        driver, conditions, run = left.pop(identity)
        if reason:
            yield [failed(run, driver, f"the worker died: {reason}")]
        else:
            yield from _survive(2, work, [(driver, conditions, [run])], limits, folder, alone=True)


def _claim_and_work(work: Work, task: Task, folder: Path, limits: Limits, parent: int) -> list[Outcome]:
    """In a worker."""
    with claims.claimed(folder, [run.identity for run in task[2]], limits, parent):
        return work(*task)


def _suspects(folder: Path) -> dict[str, str]:
    """The runs that were being driven when a worker died, with the reason where it is known."""
    found: dict[str, str] = {}
    for claim in claims.open_claims(folder):
        for identity in claim.runs:
            # Of several cars driven together any may be the one that broke the limit.
            found[identity] = claim.reason if len(claim.runs) == 1 else ""
    for path in folder.iterdir():
        path.unlink(missing_ok=True)
    return found


def _exit_codes(death: BrokenProcessPool) -> str:
    """What the message of joblib says of the exit code, such as ``SIGSEGV(-11)``."""
    found = re.search(r"exit codes of the workers are \{(.*?)\}", str(death))
    return f"exit code {found[1]}" if found else str(death).splitlines()[0]
