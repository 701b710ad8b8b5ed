"""The commands about results files: ``arena show``, ``arena compare``."""

import json
import re
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from arena.cli.console import answer, terminal
from arena.cli.options import AsJson, By, Confidence, File
from envs.foundation.errors import InvalidValueError

if TYPE_CHECKING:
    from arena.results.results import Results

REGRESSED = 1


def show(
    file: File,
    by: Annotated[By | None, typer.Option(help="The score that places are by.")] = None,
    confidence: Confidence = 0.95,
    as_json: AsJson = False,
    as_csv: Annotated[bool, typer.Option("--csv", help="Print a line an entrant, with commas.")] = False,
) -> None:
    """Print the leaderboard of a results file; of the paper's tournament its tables, unless --by is given."""
    from arena.results.results import load

    if as_json and as_csv:
        raise InvalidValueError("--json and --csv must not be given together")
    with load(file) as results, _patience(by):
        print_results(results, by.value if by else None, confidence, as_json=as_json, as_csv=as_csv)


def print_results(
    results: "Results",
    by: str | None = None,
    confidence: float = 0.95,
    *,
    as_json: bool = False,
    as_csv: bool = False,
) -> None:
    """Print what ``arena run`` and ``arena show`` say of results, on stdout."""
    from arena.analysis.standings import leaderboard
    from arena.report.sparklines import can_show, pictures
    from arena.report.tables import render
    from arena.reproduction.tables import compare as compare_with_paper

    if as_json:
        board = leaderboard(results, by or "steps", confidence).to_dict()
        paper = compare_with_paper(results)
        extra = {"paper": paper.to_dict()} if paper else {}
        answer(json.dumps({**results.to_dict(), "leaderboard": board, **extra}, allow_nan=False))
    elif as_csv:
        frame = leaderboard(results, by or "steps", confidence).frame()
        answer(frame.to_csv(index=False, lineterminator="\n"), end="")
    else:
        console = terminal()
        console.print(render(results, by, confidence))
        if can_show(console):
            console.print(pictures(results, console.width))


def compare(
    file: File,
    a: Annotated[
        str | None, typer.Argument(help="An entrant; NAME@old is its former version.", metavar="A")
    ] = None,
    b: Annotated[str | None, typer.Argument(help="Another one.", metavar="B")] = None,
    baseline: Annotated[
        Path | None,
        typer.Option(help="Results file of before: has any entrant got worse?", metavar="OLD"),
    ] = None,
    max_regression: Annotated[
        str,
        typer.Option(help="How much worse than the baseline is allowed, such as 5 or 2%.", metavar="AMOUNT"),
    ] = "0",
    by: Annotated[By, typer.Option(help="The score.")] = By.STEPS,
    confidence: Confidence = 0.95,
    as_json: AsJson = False,
) -> None:
    """Compare two entrants, or a file with a baseline: exit with 1 if an entrant got worse beyond chance."""
    from arena.results.results import load

    if (baseline is None) == (a is None or b is None) or (baseline is not None and a is not None):
        raise InvalidValueError("compare must be given two entrants, or --baseline and none")
    with load(file) as results:
        past = [name for name in (a, b) if name and "@" in name and name not in results.entrants]
    with load(file, past) as results, _patience(by):
        if baseline is None:
            _print_comparison(results, str(a), str(b), by.value, confidence, as_json=as_json)
            return
        amount, relative = _amount(max_regression)
        with load(baseline) as old:
            regressed = _print_changes(results, old, amount, relative, by.value, confidence, as_json)
    if regressed:
        raise typer.Exit(REGRESSED)


def _patience(by: By | None) -> AbstractContextManager[Any]:
    """Says on a terminal what takes so long."""
    if by is By.REGRET:
        console = terminal(stderr=True)
        if console.is_terminal:
            return console.status("searching the fewest steps from each start of the test")
    return nullcontext()


def _amount(text: str) -> tuple[float, bool]:
    """A number, or a share of the baseline."""
    if not re.fullmatch(r"\d+(\.\d*)?%?", text):
        raise InvalidValueError(
            f"--max-regression must be a number such as 5, or a share such as 2%, got {text!r}"
        )
    return (float(text[:-1]) / 100.0, True) if text.endswith("%") else (float(text), False)


def _print_comparison(
    results: "Results", a: str, b: str, by: str, confidence: float, *, as_json: bool
) -> None:
    from arena.analysis.pairwise import compare_entrants
    from arena.report.comparisons import comparison_text

    comparison = compare_entrants(results, a, b, by, confidence)
    if as_json:
        answer(json.dumps(comparison.to_dict(), allow_nan=False))
    else:
        terminal().print(comparison_text(comparison))


def _print_changes(
    new: "Results", old: "Results", amount: float, relative: bool, by: str, confidence: float, as_json: bool
) -> bool:
    """Print what has changed since the baseline; whether any entrant got worse."""
    from arena.analysis.pairwise import regressions
    from arena.report.comparisons import changes_text

    changes = regressions(new, old, amount, by, confidence, relative=relative)
    regressed = any(change.regressed for change in changes)
    only_new = sorted(new.entrants.keys() - old.entrants.keys())
    only_old = sorted(old.entrants.keys() - new.entrants.keys())
    if as_json:
        report = {"by": by, "regressed": regressed, "only_new": only_new, "only_baseline": only_old}
        entrants = [change.to_dict() for change in changes]
        answer(json.dumps({**report, "entrants": entrants}, allow_nan=False))
    else:
        terminal().print(changes_text(changes, by, only_new, only_old))
    return regressed


def add_commands(app: typer.Typer) -> None:
    """Make them commands of ``app``."""
    app.command()(show)
    app.command()(compare)
