"""The command ``arena``. Progress and errors go to stderr, results to stdout."""

import os
import shlex
import sys
from collections.abc import Sequence
from typing import Any

import typer

from arena.cli.agents import add_commands
from arena.cli.cache import add_commands as add_cache_command
from arena.cli.console import BAD_INPUT, BUG, INTERRUPTED, InterruptedRunError, say, say_bug
from arena.cli.curves import add_commands as add_curves_command
from arena.cli.files import add_commands as add_file_commands
from arena.cli.paper import add_commands as add_paper_command
from arena.cli.plot import add_commands as add_plot_command
from arena.cli.race import add_commands as add_race_command
from arena.cli.report import add_commands as add_report_command
from arena.cli.results import add_commands as add_result_commands
from arena.cli.run import add_commands as add_run_commands
from arena.cli.streams import results_apart, take_over, usable
from arena.cli.walk import add_commands as add_walk_command
from envs.foundation.errors import ArenaError, InvalidValueError

app = typer.Typer(
    help="Race agents up the Mountain Car's hill: they learn, and the arena scores them.",
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

add_commands(app)
add_run_commands(app)
add_result_commands(app)
add_plot_command(app)
add_report_command(app)
add_file_commands(app)
add_race_command(app)
add_curves_command(app)
add_paper_command(app)
add_walk_command(app)
add_cache_command(app)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Returns:
        The exit code: 0; 1 where an entrant failed or a check did; 2 for bad input, which is told in one
        sentence; 70 for a mistake of our own, with its traceback; 130 after Ctrl-C.
    """
    with usable():
        return _run(list(sys.argv[1:] if arguments is None else arguments))


def _run(given: list[str]) -> int:
    """Run the command line; the exit code."""
    group = typer.main.get_group(app)
    for command in group.commands.values():
        command.callback = results_apart()(command.callback)  # type: ignore[type-var]  # there is one
    try:
        _check_encodable(given)
        code = group.main(args=given, prog_name="arena", standalone_mode=False)
    except typer.Exit as stop:
        return stop.exit_code
    except InterruptedRunError as stop:
        again = shlex.join(["arena", *given])
        say(f"interrupted; what was finished is in {stop}; to continue: {again}")
        return INTERRUPTED
    except (typer.Abort, KeyboardInterrupt):
        return INTERRUPTED
    except Exception as error:
        return _tell(error, given)
    return code if isinstance(code, int) else 0


def _check_encodable(arguments: list[str]) -> None:
    """See that any of them could be the name of a file; those of a shell always could.

    Raises:
        InvalidValueError: when one could not.
    """
    for argument in arguments:
        try:
            possible = b"\0" not in os.fsencode(argument)
        except UnicodeEncodeError:
            possible = False
        if not possible:
            raise InvalidValueError(f"arguments must be texts that a shell can pass on, got {argument!r}")


def _tell(error: Exception, arguments: list[str]) -> int:
    """Say what is wrong; the exit code."""
    if hasattr(error, "format_message"):  # a mistake in the command line itself
        say(" ".join(error.format_message().split()) + _received(error, arguments))
    elif isinstance(error, (ArenaError, OSError)):
        say(" ".join(str(error).split()))
    else:
        say_bug()
        return BUG
    return BAD_INPUT


def _received(error: Any, arguments: list[str]) -> str:
    """The value of the option that is wrong, where the message does not tell it."""
    options = getattr(getattr(error, "param", None), "opts", ())
    for place, argument in enumerate(arguments):
        name, equals, value = argument.partition("=")
        if name in options:
            value = value if equals else "".join(arguments[place + 1 : place + 2])
            return "" if repr(value) in error.format_message() else f", got {value!r}"
    return ""


def entry() -> None:
    """The console command."""
    take_over()
    code = main()
    sys.stdout = sys.stderr  # what agents print at exit is no result
    sys.exit(code)
