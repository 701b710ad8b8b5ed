"""The bar that long commands show on a terminal."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from arena.cli.console import terminal


@contextmanager
def progress_bar(title: str) -> Iterator[Callable[[int, int], None]]:
    """A bar on stderr, if that is a terminal; to be told how many are finished, and of how many."""
    if not sys.stderr.isatty():
        yield lambda _finished, _total: None
        return
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=terminal(stderr=True)) as bar:
        task = bar.add_task(title, total=None)
        yield lambda finished, total: bar.update(task, completed=finished, total=total)
