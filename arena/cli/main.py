"""The command ``arena``. Progress and errors go to stderr, results to stdout."""

import shlex
import sys
from collections.abc import Sequence
from typing import Any

import typer

from arena.cli.agents import add_commands
from arena.cli.console import BAD_INPUT, INTERRUPTED, _InterruptedError, _say
from arena.cli.curves import add_commands as add_curves_command
from arena.cli.paper import add_commands as add_paper_command
from arena.cli.plot import add_commands as add_plot_command
from arena.cli.race import add_commands as add_race_command
from arena.cli.report import add_commands as add_report_command
from arena.cli.results import add_commands as add_result_commands
from arena.cli.run import add_commands as add_run_commands
from arena.cli.walk import add_commands as add_walk_command

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
add_race_command(app)
add_curves_command(app)
add_paper_command(app)
add_walk_command(app)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; the exit code is 0, 1 (an entrant failed), 2 (bad input) or 130."""
    command = typer.main.get_command(app)
    try:
        code = command.main(
            args=None if arguments is None else list(arguments), prog_name="arena", standalone_mode=False
        )
    except typer.Exit as stop:
        return stop.exit_code
    except _InterruptedError as stop:
        again = shlex.join(["arena", *(sys.argv[1:] if arguments is None else arguments)])
        _say(f"interrupted; what was finished is in {stop}; to continue: {again}")
        return INTERRUPTED
    except (typer.Abort, KeyboardInterrupt):
        return INTERRUPTED
    except BrokenPipeError:  # the reader, such as head, has seen enough
        sys.stderr.close()
        return 0
    except Exception as error:
        if hasattr(error, "format_message"):  # a mistake in the command line itself
            _say(" ".join(error.format_message().split()) + _received(error, arguments))
        elif isinstance(error, (ValueError, TypeError, OSError)):
            _say(" ".join(str(error).split()))
        else:
            raise
        return BAD_INPUT
    return code if isinstance(code, int) else 0


def _received(error: Any, arguments: Sequence[str] | None) -> str:
    """The value of the option that is wrong, where the message does not tell it."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    options = getattr(getattr(error, "param", None), "opts", ())
    for place, one in enumerate(given):
        name, equals, value = one.partition("=")
        if name in options:
            value = value if equals else "".join(given[place + 1 : place + 2])
            return "" if repr(value) in error.format_message() else f", got {value!r}"
    return ""


def entry() -> None:
    """The console command."""
    sys.exit(main())
