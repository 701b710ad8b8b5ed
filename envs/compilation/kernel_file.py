"""A kernel on disk, which numba is given only if it is what was written, for this machine and these versions.

Numba's own cache believes what it finds: an index or machine code that is damaged ends in an error of
pickle, or in a crash.
"""

import hashlib
import logging
import os
import pickle
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numba.core.caching import Cache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from envs.compilation.kernel_folder import sweep, write
from envs.foundation.notices import tell_once

_VERSIONS = (numba.__version__, np.__version__, sys.implementation.cache_tag)
_log = logging.getLogger("arena")


class KernelFile(Cache):  # type: ignore[misc]  # numba is untyped
    """Where numba looks for a kernel before it compiles it, and keeps it afterwards.

    Whatever is the matter with the file, it is as if there were none. Nothing is raised.

    Args:
        folder: of all kernels.
        fingerprint: of everything compiled in.

    Attributes:
        counts_references: whether the kernel does; to be said before it is compiled, and true of it
            when it was found.
    """

    def __init__(self, folder: Path, fingerprint: str) -> None:
        self._folder, self._fingerprint = folder, fingerprint
        self._cache_path = str(folder)  # for numba's statistics
        self.counts_references = False
        self.enable()

    def _load_overload(self, types: Any, target_context: Any) -> Any:
        path, key = self._place(target_context.codegen())
        try:
            found = _unsealed(path, key)
            if found is None:
                return None
            kept_types, counts_references, parts = pickle.loads(found)  # noqa: S301 (unchanged since we wrote it)
            if kept_types != types:
                return None
            kernel = CompileResult._rebuild(target_context, *parts)  # noqa: SLF001 (as numba's cache does)
        except Exception:  # what unpickling raises when a class is gone, or a file cannot be read
            _log.debug("kernel %s is not to be used", path, exc_info=True)
            return None
        with suppress(OSError):  # of another user, or of a medium that is read-only
            os.utime(path)
        self.counts_references = counts_references
        return kernel

    def _save_overload(self, types: Any, kernel: Any) -> None:
        if kernel.library.has_dynamic_globals:  # addresses of this process
            return
        path, key = self._place(kernel.codegen)
        try:
            parts = kernel._reduce()  # noqa: SLF001 (as numba's cache does)
            write(path, _sealed(dumps((types, self.counts_references, parts)), path, key))
        except OSError as error:
            tell_once(
                f"kernels are compiled anew each time, none is kept in {self._folder}: {error.strerror}"
            )
        except Exception:  # whatever a class raises that is pickled
            _log.debug("kernel %s cannot be kept", path, exc_info=True)
        else:
            sweep(self._folder)

    def _place(self, codegen: Any) -> tuple[Path, bytes]:
        """The file, and what it must have been written for: versions and processor."""
        key = repr((_VERSIONS, codegen.magic_tuple())).encode()
        return self._folder / f"{self._fingerprint}.{hashlib.sha256(key).hexdigest()[:16]}.nbc", key


def _sealed(content: bytes, path: Path, key: bytes) -> bytes:
    return hashlib.sha256(path.name.encode() + key + content).digest() + content


def _unsealed(path: Path, key: bytes) -> bytes | None:
    """The content of the file; None if there is none or it is not what was written there."""
    if not path.is_file():
        return None
    written = path.read_bytes()
    content = written[hashlib.sha256().digest_size :]
    return content if written == _sealed(content, path, key) else None
