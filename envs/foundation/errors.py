"""Errors that are not bugs: each is one sentence about what was asked for, with the value received.

The tree, each class beside what raises it::

    ArenaError
      InvalidValueError      a value breaks its rule; a ValueError
        PluginError          a file with agents cannot be used (arena.plugins)
        BrokenAgentError     an installed package's agent cannot be used (agents.registry)
        ResultsError         a results file cannot be used (arena.results)
        LockedError          another process is writing the file (arena.common.locks)
        UnknownPolicyError   what a run learned cannot be told from its file (arena.results)
      InvalidTypeError       a value is of a wrong type; a TypeError
        CompilationError     numba cannot compile an agent or a hill (envs.compilation)

Whatever else comes out of this program is a mistake in it.
"""

from collections.abc import Iterator
from contextlib import contextmanager


class ArenaError(Exception):
    """What a caller can put right; the message is one sentence that says how."""

    __module__ = "envs"  # where it is public, and how tracebacks call it


class InvalidValueError(ArenaError, ValueError):
    """A value breaks its rule."""

    __module__ = "envs"


class InvalidTypeError(ArenaError, TypeError):
    """A value is of a wrong type."""

    __module__ = "envs"


@contextmanager
def naming(subject: str, kinds: tuple[type[Exception], ...] = (ArenaError,)) -> Iterator[None]:
    """Begin the messages of errors with ``subject``, such as a file or an entrant.

    Args:
        subject: what they are about.
        kinds: of the errors; by default ``ArenaError``, others where the code is somebody else's.

    Raises:
        InvalidTypeError: in place of an error that is a ``TypeError``.
        InvalidValueError: in place of any other.
    """
    try:
        yield
    except kinds as error:
        named = InvalidTypeError if isinstance(error, TypeError) else InvalidValueError
        raise named(f"{subject}: {error}") from error
