"""The streams of the command: results on stdout, all else on stderr, whatever these two are.

What is not ours prints where it likes: agents when they are imported, made, asked and at exit, here and in
workers, and compiled code without Python's knowledge. So results have a stream of their own, and what others
take for stdout, which is ``sys.stdout`` and the descriptor 1 that workers inherit, is stderr.
"""

import codecs
import errno
import io
import os
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, redirect_stdout
from contextvars import ContextVar
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer

_results: ContextVar[TextIO] = ContextVar("_results")
_REPLACED = "arena.replaced"


class _Patient(io.FileIO):
    """A file that drops what its reader, such as ``head``, no longer wants,
    and on stderr whatever cannot be written.
    """

    def write(self, data: "ReadableBuffer") -> int:
        try:
            return super().write(data)
        except OSError as error:  # EINVAL is how Windows calls a broken pipe
            seen_enough = isinstance(error, ConnectionError) or error.errno == errno.EINVAL
            if not seen_enough and self.fileno() != 2:
                raise
            return memoryview(data).nbytes


def take_over() -> None:
    """Prepare the streams of this process, which is the command's own, once and for all of its life."""
    while (number := os.open(os.devnull, os.O_RDWR)) <= 2:  # it was closed, and a results file would be next
        os.set_inheritable(number, True)
    os.close(number)
    if _is_replaceable(sys.stderr):
        sys.stderr = _patient(sys.stderr, 2)
    if _is_replaceable(sys.stdout):
        sys.stdout = _patient(sys.stdout, os.dup(1))
        os.dup2(2, 1)
    # Workers, too, can print any character on our stderr.
    os.environ["PYTHONIOENCODING"] = f"{getattr(sys.stderr, 'encoding', 'utf-8')}:backslashreplace"


def _is_replaceable(stream: TextIO | None) -> bool:
    """Whether there is one, and no console of Windows, whose number tells Rich what it is."""
    return stream is not None and not (os.name == "nt" and stream.isatty())


def _patient(stream: TextIO, number: int) -> TextIO:
    """What takes the place of ``stream``, on the descriptor ``number``."""
    writer = io.BufferedWriter(_Patient(number, "w"))
    lines = number == 2 or stream.isatty()
    return io.TextIOWrapper(writer, stream.encoding, stream.errors, line_buffering=lines)


def _replaced(error: UnicodeError) -> tuple[str | bytes, int]:
    """The bytes of a file's name as they were, a question mark for any other character."""
    try:
        return codecs.lookup_error("surrogateescape")(error)
    except UnicodeError:
        return codecs.lookup_error("replace")(error)


codecs.register_error(_REPLACED, _replaced)


@contextmanager
def usable() -> Iterator[None]:
    """Meanwhile no stream is None or closed; and from now on stdout takes any character."""
    with ExitStack() as stack:
        for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
            stream = getattr(sys, name)
            if stream is None or getattr(stream, "closed", False):
                nothing = stack.enter_context(open(os.devnull, mode, encoding="utf-8"))  # noqa: PTH123 (no path)
                stack.callback(setattr, sys, name, stream)
                setattr(sys, name, nothing)
        if isinstance(sys.stdout, io.TextIOWrapper):
            sys.stdout.reconfigure(errors=_REPLACED)
        yield


@contextmanager
def results_apart() -> Iterator[None]:
    """Meanwhile what is printed goes to stderr, but what is written to ``stdout()`` to stdout.

    Raises:
        OSError: when stdout cannot take the results, as on a full disk.
    """
    token = _results.set(sys.stdout)
    try:
        with redirect_stdout(sys.stderr):
            yield
    finally:
        stdout().flush()
        _results.reset(token)


def stdout() -> TextIO:
    """Return the stream for what a command was asked for."""
    return _results.get(sys.stdout)
