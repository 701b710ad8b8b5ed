"""Who drives what, told through files: how a dead worker's last words reach the parent.

A worker that is killed, crashes or hangs in machine code cannot report it. So before it drives, it takes a
lease, a file in a folder that all share, and gives it back afterwards. A watchdog, a thread in the worker
and, should that be stuck, one in the parent, ends a worker that breaks a limit and writes the reason into
the lease. The leases that are left when a worker is gone name the suspects.
"""

import json
import os
import threading
import time
import uuid
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

_POLL = 0.1  # seconds between two looks at the clock and the memory
_PARENT_PATIENCE = 1.5  # the parent waits so much longer than the worker, and two seconds more
_EXIT_CODE = 75


@dataclass(frozen=True)
class Limits:
    """What a run may use.

    Attributes:
        seconds: of time, for each run; None is no limit.
        mebibytes: of memory, for the worker; None is no limit.
    """

    seconds: float | None = None
    mebibytes: float | None = None

    def broken(self, held: "Lease", *, patient: bool = False) -> str:
        """Which limit is broken, in words; empty if none is. The parent is more patient."""
        import psutil

        factor, more = (_PARENT_PATIENCE, 2.0) if patient else (1.0, 0.0)
        if self.seconds is not None:
            allowed = self.seconds * len(held.runs) * factor + more
            if time.time() - held.since > allowed:
                return f"the time limit of {self.seconds:g} s is over"
        if self.mebibytes is not None:
            with suppress(psutil.Error):
                used = psutil.Process(held.pid).memory_info().rss / 2**20
                if used > self.mebibytes * factor:
                    return f"the memory limit of {self.mebibytes:g} MiB is broken ({used:.0f} MiB)"
        return ""

    def __bool__(self) -> bool:
        return self.seconds is not None or self.mebibytes is not None


@dataclass(frozen=True)
class Lease:
    """What a worker said before it began: its process, when, which runs, and why it was ended."""

    pid: int
    since: float
    runs: tuple[str, ...]
    reason: str = ""


@contextmanager
def lease(folder: Path, runs: Iterable[str], limits: Limits, parent: int) -> Iterator[None]:
    """Hold a lease of ``runs`` while they are driven; in a worker process, with a watchdog."""
    held = Lease(os.getpid(), time.time(), tuple(runs))
    path = folder / f"{uuid.uuid4().hex}.json"
    _write(path, held)
    over = threading.Event()
    if limits and held.pid != parent:
        threading.Thread(target=_watch_self, args=(path, held, limits, over), daemon=True).start()
    try:
        yield
    finally:
        over.set()
        path.unlink(missing_ok=True)


def open_leases(folder: Path) -> list[Lease]:
    """The leases that were not given back."""
    return [held for _, held in _read(folder)]


@contextmanager
def parent_watchdog(folder: Path, limits: Limits) -> Iterator[None]:
    """In the parent: end workers whose own watchdog cannot."""
    over = threading.Event()
    thread = threading.Thread(target=_watch_others, args=(folder, limits, over), daemon=True)
    if limits:
        thread.start()
    try:
        yield
    finally:
        over.set()
        if limits:
            thread.join()


def _watch_self(path: Path, held: Lease, limits: Limits, over: threading.Event) -> None:
    while not over.wait(_POLL):
        reason = limits.broken(held)
        if reason:
            _write(path, replace(held, reason=reason))
            os._exit(_EXIT_CODE)


def _watch_others(folder: Path, limits: Limits, over: threading.Event) -> None:
    import psutil

    while not over.wait(5 * _POLL):
        for path, held in _read(folder):
            reason = limits.broken(held, patient=True)
            if reason and held.pid != os.getpid():
                _write(path, replace(held, reason=reason))
                with suppress(psutil.Error):
                    psutil.Process(held.pid).kill()


def _write(path: Path, held: Lease) -> None:
    draft = path.with_suffix(f".{os.getpid()}")
    draft.write_text(json.dumps(asdict(held)))
    draft.replace(path)


def _read(folder: Path) -> Iterator[tuple[Path, Lease]]:
    for path in sorted(folder.glob("*.json")):
        with suppress(OSError):
            content: dict[str, Any] = json.loads(path.read_text())
            yield path, Lease(**{**content, "runs": tuple(content["runs"])})
