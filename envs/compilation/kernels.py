"""Compile a plain Python loop together with the plain methods of the named tuples it drives.

A hill, an agent or a part of one is a ``typing.NamedTuple`` with ordinary methods. Numba knows named
tuples but not their methods; here each method, and each plain function that it calls, is offered to
numba under its own name. So one source is both interpreted and compiled, and its author need not
know numba.
"""

import re
import threading
from collections.abc import Callable
from typing import Any, NamedTuple

from envs.compilation.kernel_folder import kernel_folder
from envs.compilation.numba_methods import _register
from envs.compilation.reachable import ReachableCode
from envs.foundation.errors import InvalidTypeError

_lock = threading.RLock()
_ready: dict[str, "_Kernel"] = {}
# The interpreter's arithmetic without its ZeroDivisionError, which a kernel of many threads cannot raise.
_LOOP = {"nogil": True, "error_model": "numpy"}


class KernelInfo(NamedTuple):
    """What a compiled loop is like.

    Attributes:
        fingerprint: of everything compiled in; hexadecimal.
        counts_references: whether it counts references to arrays, because code that it reaches allocates
            memory; a step may take twice as long then.
    """

    fingerprint: str
    counts_references: bool


class _Kernel(NamedTuple):
    """A compiled loop: numba's dispatcher, the types that it is compiled for, and what it is like."""

    dispatcher: Any
    types: tuple[Any, ...]
    info: KernelInfo

    @property
    def entry_point(self) -> Callable[..., Any]:
        """The machine code, which looks at no types."""
        entry: Callable[..., Any] = self.dispatcher.overloads[self.types].entry_point
        return entry


class CompilationError(InvalidTypeError):
    """The loop cannot be compiled for these parts; the message is the reason, one line."""


def compile_loop(loop: Callable[..., Any], *example: Any) -> Callable[..., Any]:
    """``loop`` compiled for arguments of the types of ``example``.

    Nothing is run. The machine code is cached on disk under a fingerprint of everything compiled in. With
    ``NUMBA_DISABLE_JIT`` set it is ``loop`` itself: slower, and to the same results.

    Args:
        loop: a module-level function within numba's subset of Python.
        example: one argument for each parameter; named tuples may have plain methods.

    Raises:
        CompilationError: when numba cannot compile it.
    """
    import numba

    if numba.config.DISABLE_JIT:
        return loop
    kernel = _compiled(loop, example)
    if tuple(map(numba.typeof, example)) == kernel.types:
        return kernel.dispatcher  # type: ignore[no-any-return]  # numba is untyped
    # Numba knows a class by its object, of which there are several when workers unpickle it again and again.
    # All that is compiled in is the same, or the fingerprint would be another.
    return kernel.entry_point


def kernel_info(loop: Callable[..., Any], *example: Any) -> KernelInfo:
    """What ``loop``, compiled for arguments of the types of ``example``, is like.

    Raises:
        CompilationError: when numba cannot compile it, or ``NUMBA_DISABLE_JIT`` is set.
    """
    return _compiled(loop, example).info


def entry_point(loop: Callable[..., Any], *example: Any) -> Callable[..., Any]:
    """``loop`` compiled, to be called often with arguments of exactly the types of ``example``.

    A call of what ``compile_loop`` returns looks at the types of all arguments first, which for a hill takes
    0.2 ms. A call of this does not: other types are undefined behaviour.

    Raises:
        CompilationError: when numba cannot compile it, or ``NUMBA_DISABLE_JIT`` is set.
    """
    return _compiled(loop, example).entry_point


def _compiled(loop: Callable[..., Any], example: tuple[Any, ...]) -> _Kernel:
    import numba

    if numba.config.DISABLE_JIT:
        raise CompilationError("NUMBA_DISABLE_JIT is set")
    reached = ReachableCode(loop, *example)
    fingerprint = reached.fingerprint()
    with _lock:
        if fingerprint not in _ready:
            _register(reached)
            _ready[fingerprint] = _compile(loop, example, fingerprint, importable=_importable(example))
        return _ready[fingerprint]


def _compile(
    loop: Callable[..., Any], example: tuple[Any, ...], fingerprint: str, *, importable: bool
) -> _Kernel:
    import numba

    from envs.compilation.kernel_file import KernelFile

    types = tuple(map(numba.typeof, example))
    kept = KernelFile(kernel_folder(), fingerprint) if importable else None
    # Counting references to the agent's arrays doubles the time of a step, so it is off
    # (``_nrt``) unless that fails, because the agent's own code allocates memory.
    for counting in (False, True):
        kernel = numba.njit(loop, **_LOOP, _nrt=counting)
        if kept:
            kept.counts_references = counting
            kernel._cache = kept  # noqa: SLF001 (numba has no other way in)
        try:
            kernel.compile(types)
        except Exception as error:  # numba raises nearly anything
            problem = error
        else:
            counts = kept.counts_references if kept else counting
            return _Kernel(kernel, types, KernelInfo(fingerprint, counts))
    raise CompilationError(_reason(problem)) from problem


def _importable(parts: tuple[Any, ...]) -> bool:
    """Whether a later process would find the same classes: not those of a script or a notebook."""
    return all(
        type(part).__module__ != "__main__" and (not isinstance(part, tuple) or _importable(part))
        for part in parts
    )


# What numba wraps around the line that says what is wrong.
_WRAPPING = re.compile(
    r"[-\s]*(Failed in|Resolution failure|No implementation|>>>|There are|Of which|Overload in|With argument"
    r"|Rejected as|\w+Error: Failed|During|raised from|File|None$|$)"
)


def _reason(error: Exception) -> str:
    """The line of numba's message that says what is wrong."""
    lines = str(error).splitlines() or [type(error).__name__]
    return next((line for line in lines if not _WRAPPING.match(line)), lines[0]).strip()
