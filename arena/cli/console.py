"""Exit codes, and what commands print with: results on stdout, all else on stderr."""

import sys
from typing import TYPE_CHECKING

from arena.cli.streams import stdout

if TYPE_CHECKING:
    from rich.console import Console

SOME_FAILED = 1
BAD_INPUT = 2
BUG = 70  # EX_SOFTWARE of sysexits.h
INTERRUPTED = 130
_USUAL, _NARROWEST = 80, 20  # columns of a terminal; in fewer no text can be laid out


class InterruptedRunError(Exception):
    """Ctrl-C while runs were written to a file, the only argument."""


def terminal(*, stderr: bool = False) -> "Console":
    """Return the console for results, or that on stderr; it colours no numbers and breaks no lines."""
    from rich.console import Console

    console = Console(file=sys.stderr if stderr else stdout(), highlight=False, soft_wrap=True)
    console.width = max(console.width or _USUAL, _NARROWEST)  # COLUMNS=0 says that it is not known
    return console


def answer(text: str, end: str = "\n") -> None:
    """Print a result, on stdout."""
    print(text, end=end, file=stdout())


def say(sentence: str) -> None:
    """Print a sentence on stderr."""
    print(f"arena: {sentence}", file=sys.stderr)


def say_bug() -> None:
    """Tell of the exception that is being handled: it is a mistake of ours, and where to report it."""
    import traceback
    from importlib import metadata

    traceback.print_exc()
    try:
        urls = metadata.metadata("mountain-car-arena").get_all("Project-URL", [])
    except metadata.PackageNotFoundError:  # run from a folder, without installation
        urls = []
    places = [url.removeprefix("Issues, ") for url in urls if url.startswith("Issues, ")]
    say(" ".join(["this is a mistake of the arena; please report it with the lines above", *places]))
