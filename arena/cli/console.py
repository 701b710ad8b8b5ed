"""Exit codes, and what is said on stderr."""

import sys

BAD_INPUT = 2
SOME_FAILED = 1
INTERRUPTED = 130


class _InterruptedError(Exception):
    """Ctrl-C while runs were written to a file, the only argument."""


def _say(sentence: str) -> None:
    print(f"arena: {sentence}", file=sys.stderr)
