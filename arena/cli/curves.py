"""The command ``arena curves``: how fast the entrants learn."""

import json
from typing import Annotated

import typer

from arena.cli.console import answer, terminal
from arena.cli.options import AsJson, Confidence, File
from envs.foundation.errors import InvalidValueError


def curves(
    file: File,
    level: Annotated[
        float,
        typer.Option(help="Steps an episode at which an entrant has learned.", metavar="STEPS"),
    ] = 200.0,
    window: Annotated[int, typer.Option(help="Episodes that are averaged.", metavar="N")] = 50,
    confidence: Confidence = 0.95,
    as_json: AsJson = False,
    as_csv: Annotated[bool, typer.Option("--csv", help="Print a line a run, with commas.")] = False,
) -> None:
    """Print how fast entrants learn: the area under the curves, and when they stay below a level."""
    from arena.analysis.curves import learning_curves
    from arena.analysis.standings import check_confidence
    from arena.common.plain import without_nan
    from arena.report.curves import render, summaries
    from arena.results.results import load

    if as_json and as_csv:
        raise InvalidValueError("--json and --csv must not be given together")
    check_confidence(confidence)
    with load(file) as results:
        frame = learning_curves(results, level, window)
    if as_csv:
        answer(frame.to_csv(index=False, lineterminator="\n"), end="")
        return
    rows = summaries(frame, confidence)
    if as_json:
        report = {"level": level, "window": window, "entrants": without_nan(rows)}
        answer(json.dumps(report, allow_nan=False))
    else:
        terminal().print(render(rows, level, window, confidence))


def add_commands(app: typer.Typer) -> None:
    """Make it a command of ``app``."""
    app.command()(curves)
