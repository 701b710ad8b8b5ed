"""The commands ``arena run``, ``arena digest`` and ``arena verify``."""

import re
import sys
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from arena.cli.console import SOME_FAILED, InterruptedRunError, answer, say
from arena.cli.options import Plugins, load_plugins
from arena.cli.progress import progress_bar
from arena.cli.report import page_of
from arena.cli.results import print_results
from envs.foundation.errors import InvalidValueError

if TYPE_CHECKING:
    from arena.results.growth import Growth
    from arena.results.results import Results
    from arena.tournament.tournament import Tournament

_BUILT_IN_TAKE = {"replicates", "seed", "reading"}


def _replicates(text: str) -> int | str | range:
    from arena.statistics.sequential import ADAPTIVE

    part = re.fullmatch(r"(\d{1,9}):(\d{1,9})", text)
    if part and int(part[1]) < int(part[2]):
        return range(int(part[1]), int(part[2]))
    if text != ADAPTIVE and not re.fullmatch(r"-?\d{1,9}", text):
        raise typer.BadParameter(f"it must be a number, a part such as 50:100, or {ADAPTIVE}, got {text!r}")
    return text if text == ADAPTIVE else int(text)


class Driver(StrEnum):
    """Choices of ``--driver``."""

    AUTO = "auto"
    COMPILED = "compiled"
    PETTINGZOO = "pettingzoo"


def run(
    tournament: Annotated[
        str,
        typer.Argument(help="paper, quick, field, or a TOML file.", metavar="paper|quick|field|FILE.toml"),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            help="Results file; by default runs/NAME.sqlite. One that is there keeps what is still needed.",
            metavar="FILE",
        ),
    ] = None,
    jobs: Annotated[int, typer.Option(help="Workers; -1 is one a core.", metavar="N")] = -1,
    replicates: Annotated[
        Any,
        typer.Option(
            parser=_replicates,
            help="Repetitions of each entrant, or only those from A on before B; adaptive: until the first "
            "place is decided.",
            metavar="R|A:B|adaptive",
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
    dry_run: Annotated[bool, typer.Option(help="Only say what would be kept and what run.")] = False,
) -> None:
    """Run a tournament, keep its results and print its tables."""
    if jobs == 0:
        raise InvalidValueError("--jobs must not be 0: give a number of workers, or -1 for one a core")
    load_plugins(plugin)
    only = replicates if isinstance(replicates, range) else None
    replicates = only.stop if only else replicates
    given = {"replicates": replicates, "seed": seed, "reading": reading}
    given |= {"max_replicates": max_replicates, "confidence": confidence}
    chosen = _tournament(tournament, {key: value for key, value in given.items() if value is not None})
    out = out or _default_file(chosen.name)
    if dry_run or out.exists():
        plan = _plan(chosen, out, only)
        if dry_run:
            answer(plan.sentence)
            return
        say(plan.sentence)
    try:
        results = _run(chosen, out, jobs, driver.value, only)
    except KeyboardInterrupt:
        raise InterruptedRunError(out) from None
    with results:
        print_results(results, as_json=as_json)
        if report:
            _write_page(results, page_of(out))
        failures = sum(not record.finished for record in results.records)
        if failures and (strict or failures == len(results.records)):
            raise typer.Exit(SOME_FAILED)


def digest(file: Annotated[Path, typer.Argument(help="Results file.", metavar="FILE")]) -> None:
    """Print a hash of everything in a results file but timings."""
    from arena.results.digests import digest as digest_of
    from arena.results.results import load

    with load(file) as results:
        answer(digest_of(results))


def verify(
    file: Annotated[Path, typer.Argument(help="Results file.", metavar="FILE")],
    runs: Annotated[int, typer.Option(help="How many runs to repeat.", metavar="K")] = 4,
    plugin: Plugins = None,
) -> None:
    """Run a sample again, with the other driver and other workers; exit with 1 if a bit differs."""
    from arena.execution.verification import verify as differences
    from arena.results.results import load

    load_plugins(plugin)
    with load(file) as results:
        difference = next(differences(results, runs), None)
    if difference:
        answer(difference)
        raise typer.Exit(SOME_FAILED)
    answer("no difference")


def _default_file(name: str) -> Path:
    """``runs/NAME.sqlite``; what is no letter, digit, dot or dash of a name is no path either."""
    safe = re.sub(r"[^\w.-]+", "-", name).strip(".")
    return Path("runs") / f"{safe}.sqlite"


def _tournament(name: str, changes: dict[str, Any]) -> "Tournament":
    from arena.tournament.builtin import BUILT_IN
    from arena.tournament.configuration import load_tournament

    if name in BUILT_IN:
        built = BUILT_IN[name](**{key: changes[key] for key in _BUILT_IN_TAKE & changes.keys()})
        return replace(built, **{key: changes[key] for key in changes.keys() - _BUILT_IN_TAKE})
    if not name.endswith(".toml"):
        known = ", ".join(BUILT_IN)
        raise InvalidValueError(
            f"tournament must be one of {known}, or a file that ends in .toml, got {name!r}"
        )
    return load_tournament(name, **changes)


def _plan(tournament: "Tournament", out: Path, only: range | None) -> "Growth":
    from arena.execution.runner import preview

    return preview(tournament, out, only)


def _run(tournament: "Tournament", out: Path, jobs: int, driver: str, only: range | None) -> "Results":
    from arena.execution.runner import run as run_tournament

    with progress_bar(tournament.name) as progress:
        return run_tournament(tournament, out, jobs, driver, progress=progress, replicates=only)


def _write_page(results: "Results", page: Path) -> None:
    from arena.report.page import write_report

    write_report(results, page)
    if sys.stderr.isatty():
        say(f"the page is {page}")


def add_commands(app: typer.Typer) -> None:
    """Make them commands of ``app``."""
    for command in (run, digest, verify):
        app.command()(command)
