"""The command ``arena paper``: the paper, claim by claim."""

import json
from pathlib import Path
from typing import Annotated

import typer

from arena.cli.console import answer, terminal
from arena.cli.options import AsJson, File
from envs.foundation.errors import InvalidValueError


def paper(
    file: File,
    walks: Annotated[
        int, typer.Option(help="Series of 2,000 random walks, as replicates of section 3.2.", metavar="N")
    ] = 20,
    seed: Annotated[int, typer.Option(help="Of the random walks.", metavar="S")] = 0,
    jobs: Annotated[int, typer.Option(help="Workers; -1 is one a core.", metavar="N")] = -1,
    markdown: Annotated[
        Path | None, typer.Option(help="Write the verdicts as a Markdown page, too.", metavar="FILE")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Print a verdict on every claim of the paper, from a results file of its tournament."""
    from arena.report.claims import heading, markdown_lines, render
    from arena.reproduction.claims import WALKS, paper_claims
    from arena.reproduction.tables import paper_tables
    from arena.results.results import load
    from arena.walks.series import random_walk

    if walks < 2:
        raise InvalidValueError(f"--walks must be at least 2, got {walks}")
    with load(file) as results:
        paper_tables(results)  # before the walks: is it all there?
        series = [random_walk(WALKS, seed=seed + number, n_jobs=jobs) for number in range(walks)]
        claims = paper_claims(results, series)
        title = heading(results, walks)
        if markdown is not None:
            markdown.write_text("\n".join(markdown_lines(results, claims, title)), encoding="utf-8")
    if as_json:
        answer(json.dumps([claim.to_dict() for claim in claims], allow_nan=False))
    else:
        terminal().print(render(claims, title))


def add_commands(app: typer.Typer) -> None:
    """Make it a command of ``app``."""
    app.command()(paper)
