"""Calls over joblib's workers, which do not outlive this process."""

import os
import threading
import time
import warnings
from collections.abc import Callable, Generator
from contextlib import suppress
from functools import cache
from typing import Any

from envs.foundation.notices import held_back, hold_back, tell_once


def parallel_map_unordered(
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
        for result, notices in results:
            for notice in notices:
                tell_once(notice)
            yield result
    finally:
        with warnings.catch_warnings(), suppress(AttributeError):  # a list needs no closing
            warnings.simplefilter("ignore", UserWarning)  # that cancelled tasks took time for nothing
            results.close()


def _serve(parent: int, function: Callable[..., Any], task: tuple[Any, ...]) -> tuple[Any, list[str]]:
    """In a worker: what ``function`` returns and what the parent is to tell; not to outlive the parent."""
    if os.getpid() != parent:
        _leave_with(parent)
        hold_back()
    return function(*task), held_back()


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
