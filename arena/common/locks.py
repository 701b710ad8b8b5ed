"""One writer a file."""

from pathlib import Path

from filelock import FileLock, Timeout

from envs.foundation.errors import InvalidValueError


class LockedError(InvalidValueError):
    """Another process is writing the file."""


def lock_file(path: Path) -> FileLock:
    """The right to write ``path``, which a process loses when it ends, however it ends.

    Raises:
        LockedError: when another process has it.
        OSError: when there can be no lock beside the file.
    """
    lock = FileLock(f"{path}.lock", timeout=0)
    try:
        lock.acquire()
    except Timeout:
        raise LockedError("another process is writing it; wait for it, or name another file") from None
    return lock


def unlock(lock: FileLock | None) -> None:
    """Give the right back, if it was had."""
    if lock is not None:
        Path(lock.lock_file).unlink(missing_ok=True)
        lock.release()
