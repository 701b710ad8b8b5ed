"""The commands about results files: ``arena show``, ``arena compare``."""

import json
import re
import sys
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.text import Text

from arena.analysis.scores import SCORES
from arena.cli.options import AsJson, By, Confidence, File
from arena.results.results import Results, load
from envs.foundation.errors import InvalidValueError

REGRESSED = 1


def show(
    file: File,
    by: Annotated[By | None, typer.Option(help="The score that places are by.")] = None,
    confidence: Confidence = 0.95,
    as_json: AsJson = False,
    as_csv: Annotated[bool, typer.Option("--csv", help="Print a line an entrant, with commas.")] = False,
) -> None:
    """Print the leaderboard of a results file; of the paper's tournament its tables, unless --by is given."""
    if as_json and as_csv:
        raise InvalidValueError("--json and --csv must not be given together")
    with load(file) as results, _patience(by):
        print_results(results, by.value if by else None, confidence, as_json=as_json, as_csv=as_csv)


def print_results(
    results: Results,
    by: str | None = None,
    confidence: float = 0.95,
    *,
    as_json: bool = False,
    as_csv: bool = False,
) -> None:
    """What ``arena run`` and ``arena show`` print on stdout."""
    from arena.analysis.standings import leaderboard
    from arena.report.sparklines import can_show, pictures
    from arena.report.tables import render
    from arena.reproduction.tables import compare as paper_s

    if as_json:
        board = leaderboard(results, by or "steps", confidence).to_dict()
        paper = paper_s(results)
        extra = {"paper": paper.to_dict()} if paper else {}
        print(json.dumps({**results.to_dict(), "leaderboard": board, **extra}, allow_nan=False))
    elif as_csv:
        leaderboard(results, by or "steps", confidence).frame().to_csv(sys.stdout, index=False)
    else:
        console = Console(highlight=False, soft_wrap=True)
        console.print(render(results, by, confidence))
        if can_show(console):
            console.print(pictures(results))


def compare(
    file: File,
    a: Annotated[str | None, typer.Argument(help="An entrant.", metavar="A")] = None,
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
    if (baseline is None) == (a is None or b is None) or (baseline is not None and a is not None):
        raise InvalidValueError("compare must be given two entrants, or --baseline and none")
    with load(file) as results, _patience(by):
        if baseline is None:
            _print_duel(results, str(a), str(b), by.value, confidence, as_json=as_json)
            return
        amount, relative = _amount(max_regression)
        with load(baseline) as old:
            regressed = _print_changes(results, old, amount, relative, by.value, confidence, as_json)
    if regressed:
        raise typer.Exit(REGRESSED)


def _patience(by: By | None) -> AbstractContextManager[Any]:
    """Says on a terminal what takes so long."""
    console = Console(stderr=True)
    if by is not By.REGRET or not console.is_terminal:
        return nullcontext()
    return console.status("searching the fewest steps from each start of the test")


def _amount(text: str) -> tuple[float, bool]:
    """A number, or a share of the baseline."""
    if not re.fullmatch(r"\d+(\.\d*)?%?", text):
        raise InvalidValueError(
            f"--max-regression must be a number such as 5, or a share such as 2%, got {text!r}"
        )
    return (float(text[:-1]) / 100.0, True) if text.endswith("%") else (float(text), False)


def _print_duel(results: Results, a: str, b: str, by: str, confidence: float, *, as_json: bool) -> None:
    from arena.analysis.pairwise import compare_entrants

    duel = compare_entrants(results, a, b, by, confidence)
    if as_json:
        print(json.dumps(duel.to_dict(), allow_nan=False))
        return
    places = SCORES[by].decimals
    rows = [
        (f"{a}, mean", duel.means[0], places),
        (f"{b}, mean", duel.means[1], places),
        (f"{a}, interquartile mean", duel.interquartile[0], places),
        (f"{b}, interquartile mean", duel.interquartile[1], places),
        ("difference of the means", duel.difference, places),
        (f"probability that {a} is better", duel.probability, 2),
    ]
    _print(f"{a} and {b} by {SCORES[by].description}: {duel.replicates} replicates.")
    width = max(len(label) for label, *_ in rows)
    for label, estimate, digits in rows:
        value, low, high = (f"{number:,.{digits}f}" for number in estimate)
        _print(f"  {label:{width}}  {value:>9}  [{low}, {high}]")
    _print(f"Paired permutation test: p = {duel.p_value:.2g}. {duel.verdict}")


def _print_changes(
    new: Results, old: Results, amount: float, relative: bool, by: str, confidence: float, as_json: bool
) -> bool:
    from arena.analysis.pairwise import regressions

    changes = regressions(new, old, amount, by, confidence, relative=relative)
    regressed = any(change.regressed for change in changes)
    names = [{*results.entrants} for results in (new, old)]
    gone, come = sorted(names[1] - names[0]), sorted(names[0] - names[1])
    if as_json:
        told: dict[str, Any] = {"by": by, "regressed": regressed, "only_new": come, "only_baseline": gone}
        print(json.dumps({**told, "entrants": [one.to_dict() for one in changes]}, allow_nan=False))
        return regressed
    places = SCORES[by].decimals
    width = max(len(change.entrant) for change in changes)
    for one in changes:
        verdict = "worse beyond chance" if one.regressed else "ok"
        interval = f"[{one.worse.low:+,.{places}f}, {one.worse.high:+,.{places}f}]"
        _print(
            f"{one.entrant:{width}}  {one.before:,.{places}f} -> {one.after:,.{places}f}, worse by "
            f"{one.worse.value:+,.{places}f} {interval}, p = {one.p_value:.2g}: {verdict}"
        )
    for where, missing in (("the baseline", gone), ("the new file", come)):
        if missing:
            _print(f"Only in {where}: {', '.join(missing)}.")
    return regressed


def _print(line: str) -> None:
    Console(highlight=False, soft_wrap=True).print(Text(line))


def add_commands(app: typer.Typer) -> None:
    """Make them commands of ``app``."""
    app.command()(show)
    app.command()(compare)
