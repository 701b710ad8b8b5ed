"""The command ``arena report``: a tournament as one page."""

from pathlib import Path
from typing import Annotated

import typer

from arena.cli.console import answer
from arena.cli.options import By, Confidence, File


def report(
    file: File,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="The page; by default FILE with .html.", metavar="FILE"),
    ] = None,
    by: Annotated[By, typer.Option(help="The score that places are by.")] = By.STEPS,
    confidence: Confidence = 0.95,
) -> None:
    """Write all of a results file as one HTML page that needs no network."""
    from arena.report.page import write_report
    from arena.results.results import load

    with load(file) as results:
        out = out or page_of(file)
        write_report(results, out, by.value, confidence)
    answer(str(out))


def page_of(file: Path) -> Path:
    """Where the page of a results file is: beside it."""
    return file.with_name(f"{file.name.removesuffix('.sqlite')}.html")


def add_commands(app: typer.Typer) -> None:
    """Make it a command of ``app``."""
    app.command()(report)
