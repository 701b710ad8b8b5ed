"""The folder of kernels: where it is, what lies in it, and what is thrown away.

A kernel is a file; its time of modification is when it was last used. Versions before 0.2 had folders.
"""

import os
import random
import re
import shutil
import tempfile
import time
import uuid
from collections.abc import Iterator
from contextlib import nullcontext, suppress
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

DAY = 86400.0
DAYS = 30
"""How long a kernel is kept that is not used."""

# A fingerprint and what follows it: folders of 0.1, kernels, and halves of kernels whose writer was killed.
_OURS = re.compile(r"[0-9a-f]{32}(-counted)?(\..+)?")
_SWEPT = "swept"  # the file that says when all was last looked through
_PATIENCE = 0.005  # seconds of a compilation that may go into sweeping


class Kept(NamedTuple):
    """A kernel on disk: where, and when it was last used, in seconds since 1970."""

    path: Path
    used: float

    def unused(self, days: float) -> bool:
        """Whether it has not been used for so long."""
        return time.time() - self.used >= days * DAY

    def size(self) -> int:
        """In bytes."""
        inside = [Path(folder, file) for folder, _, files in os.walk(self.path) for file in files]
        size = 0
        for file in inside or [self.path]:
            with suppress(FileNotFoundError):  # another process has removed it
                size += file.lstat().st_size
        return size

    def remove(self) -> None:
        """Remove it, whatever is in its place, if anything.

        Raises:
            OSError: when it cannot be removed.
        """
        with suppress(FileNotFoundError):
            if self.path.is_dir() and not self.path.is_symlink():
                shutil.rmtree(self.path)
            else:
                self.path.unlink()


def cache_directory() -> Path | None:
    """Where machine code is kept: ``$ARENA_CACHE_DIR`` or the user's cache folder; None if not writable."""
    return _writable(kernel_folder())


def kernel_folder() -> Path:
    """Where machine code is looked for; there need be nothing."""
    import platformdirs

    chosen = os.environ.get("ARENA_CACHE_DIR")
    return Path(chosen) if chosen else platformdirs.user_cache_path("mountain-car-arena")


def kept_kernels(folder: Path) -> Iterator[Kept]:
    """What lies in ``folder``, in any order; nothing if there is none.

    Raises:
        OSError: when it cannot be read.
    """
    with os.scandir(folder) if folder.exists() else nullcontext(()) as entries:
        names = [entry.name for entry in entries if _OURS.fullmatch(entry.name)]
    # In another order each time: ``sweep``, which may not come to the end, comes to each.
    random.Random().shuffle(names)  # noqa: S311
    for name in names:
        path = folder / name
        with suppress(FileNotFoundError):  # another process has removed it
            yield Kept(path, path.lstat().st_mtime)


def write(path: Path, content: bytes) -> None:
    """Write a kernel as a whole or not at all; of several processes that do so, the last one's stays.

    Raises:
        OSError: when it cannot be written.
    """
    with suppress(FileExistsError):
        path.parent.mkdir(parents=True)
    half = path.with_name(f"{path.name}.{uuid.uuid4().hex[:16]}")
    try:
        half.write_bytes(content)
        if path.is_dir():
            Kept(path, 0.0).remove()
        half.replace(path)
    except PermissionError:
        if os.name != "nt" or not path.is_file():  # on Windows a process that reads it is in the way
            raise
    finally:
        with suppress(OSError):
            half.unlink(missing_ok=True)


def sweep(folder: Path) -> None:
    """Remove what has not been used for long: once a day, and in a few milliseconds.

    What there is no time for is left to the next call, what cannot be removed stays.
    """
    began, stamp = time.perf_counter(), folder / _SWEPT
    with suppress(OSError):
        if stamp.exists() and not Kept(stamp, stamp.lstat().st_mtime).unused(days=1):
            return
        for kernel in kept_kernels(folder):
            if kernel.unused(DAYS):
                with suppress(OSError):
                    kernel.remove()
            if time.perf_counter() - began > _PATIENCE:
                return
        stamp.touch()


@lru_cache
def _writable(folder: Path) -> Path | None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError:
        return None
    return folder
