"""The command ``arena``. Progress and errors go to stderr, results to stdout."""

import re
import shlex
import sys
from collections.abc import Sequence
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from arena.adaptive import ADAPTIVE
from arena.builtin import BUILT_IN
from arena.cli_agents import Plugins, add_commands, load_plugins
from arena.cli_curves import add_commands as add_curves_command
from arena.cli_paper import add_commands as add_paper_command
from arena.cli_plot import add_commands as add_plot_command
from arena.cli_race import add_commands as add_race_command
from arena.cli_report import add_commands as add_report_command
from arena.cli_report import page_of
from arena.cli_results import add_commands as add_result_commands
from arena.cli_results import print_results
from arena.cli_walk import add_commands as add_walk_command
from arena.configuration import load_tournament
from arena.progress import progress_bar
from arena.results import Results, load
from arena.runner import run as run_tournament
from arena.tournament import Tournament

app = typer.Typer(
    help="Race agents up the Mountain Car's hill: they learn, and the arena scores them.",
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

add_commands(app)
add_result_commands(app)
add_plot_command(app)
add_report_command(app)
add_race_command(app)
add_curves_command(app)
add_paper_command(app)
add_walk_command(app)

BAD_INPUT = 2
SOME_FAILED = 1
INTERRUPTED = 130
_BUILT_IN_TAKE = {"replicates", "seed", "reading"}


class _InterruptedError(Exception):
    """Ctrl-C while runs were written to a file, the only argument."""


def _replicates(text: str) -> int | str:
    if text != ADAPTIVE and not re.fullmatch(r"-?\d{1,9}", text):
        raise typer.BadParameter(f"it must be a number or {ADAPTIVE}, got {text!r}")
    return text if text == ADAPTIVE else int(text)


class Driver(StrEnum):
    """Choices of ``--driver``."""

    AUTO = "auto"
    COMPILED = "compiled"
    PETTINGZOO = "pettingzoo"


@app.command()
def run(
    tournament: Annotated[
        str,
        typer.Argument(help="paper, quick, field, or a TOML file.", metavar="paper|quick|field|FILE.toml"),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            help="Results file; by default runs/NAME.sqlite. One of the same tournament is continued.",
            metavar="FILE",
        ),
    ] = None,
    jobs: Annotated[int, typer.Option(help="Workers; -1 is one a core.", metavar="N")] = -1,
    replicates: Annotated[
        Any,
        typer.Option(
            parser=_replicates,
            help="Repetitions of each entrant; adaptive: until the first place is decided.",
            metavar="R|adaptive",
        ),
    ] = None,
    max_replicates: Annotated[
        int | None, typer.Option(help="Where adaptive replicates end in any case.", metavar="R")
    ] = None,
    confidence: Annotated[
        float | None, typer.Option(help="With which adaptive replicates decide.", metavar="C")
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Master seed.", metavar="S")] = None,
    reading: Annotated[
        str | None,
        typer.Option(help="How to read the paper's protocol; see docs/readings.md.", metavar="NAME"),
    ] = None,
    plugin: Plugins = None,
    driver: Annotated[Driver, typer.Option(help="What steps the cars.")] = Driver.AUTO,
    strict: Annotated[bool, typer.Option(help="Exit with 1 if an entrant failed.")] = False,
    report: Annotated[bool, typer.Option(help="Write a page of the results beside them.")] = True,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Run a tournament, keep its results and print its tables."""
    if jobs == 0:
        raise ValueError("--jobs must not be 0: give a number of workers, or -1 for one a core")
    load_plugins(plugin)
    given = {"replicates": replicates, "seed": seed, "reading": reading}
    given |= {"max_replicates": max_replicates, "confidence": confidence}
    chosen = _tournament(tournament, {key: value for key, value in given.items() if value is not None})
    out = out or _default_file(chosen.name)
    try:
        results = _run(chosen, out, jobs, driver.value)
    except KeyboardInterrupt:
        raise _InterruptedError(out) from None
    with results:
        print_results(results, as_json=as_json)
        if report:
            _write_page(results, page_of(out))
        failures = sum(one["status"] != "finished" for one in results.runs)
        if failures and (strict or failures == len(results.runs)):
            raise typer.Exit(SOME_FAILED)


@app.command()
def digest(file: Annotated[Path, typer.Argument(help="Results file.", metavar="FILE")]) -> None:
    """Print a hash of everything in a results file but timings."""
    from arena.digest import digest as digest_of

    with load(file) as results:
        print(digest_of(results))


@app.command()
def verify(
    file: Annotated[Path, typer.Argument(help="Results file.", metavar="FILE")],
    runs: Annotated[int, typer.Option(help="How many runs to repeat.", metavar="K")] = 4,
    plugin: Plugins = None,
) -> None:
    """Run a sample again, with the other driver and other workers; exit with 1 if a bit differs."""
    from arena.verification import verify as differences

    load_plugins(plugin)
    with load(file) as results:
        found = next(differences(results, runs), None)
    if found:
        print(found)
        raise typer.Exit(SOME_FAILED)
    print("no difference")


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


def _default_file(name: str) -> Path:
    """``runs/NAME.sqlite``; what is no letter, digit, dot or dash of a name is no path either."""
    safe = re.sub(r"[^\w.-]+", "-", name).strip(".")
    return Path("runs") / f"{safe}.sqlite"


def _tournament(name: str, changes: dict[str, Any]) -> Tournament:
    if name in BUILT_IN:
        built = BUILT_IN[name](**{key: changes[key] for key in _BUILT_IN_TAKE & changes.keys()})
        return replace(built, **{key: changes[key] for key in changes.keys() - _BUILT_IN_TAKE})
    if not name.endswith(".toml"):
        known = ", ".join(BUILT_IN)
        raise ValueError(f"tournament must be one of {known}, or a file that ends in .toml, got {name!r}")
    return load_tournament(name, **changes)


def _run(tournament: Tournament, out: Path, jobs: int, driver: str) -> Results:
    with progress_bar(tournament.name) as progress:
        return run_tournament(tournament, out, jobs, driver, progress=progress)


def _write_page(results: Results, page: Path) -> None:
    from arena.report import write_report

    write_report(results, page)
    if sys.stderr.isatty():
        _say(f"the page is {page}")


def _say(sentence: str) -> None:
    print(f"arena: {sentence}", file=sys.stderr)


def entry() -> None:
    """The console command."""
    sys.exit(main())
