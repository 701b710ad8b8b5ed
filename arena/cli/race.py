"""The command ``arena race``: trained cars drive on one hill from the same start."""

from pathlib import Path
from typing import Annotated

import typer

from arena.cli.console import answer
from arena.cli.options import File


def race(
    file: File,
    names: Annotated[
        list[str] | None,
        typer.Argument(help="Entrants; by default the best three by steps.", metavar="[--entrants] A B C"),
    ] = None,
    _entrants: Annotated[bool, typer.Option("--entrants", help="Their names follow.")] = False,
    start: Annotated[float, typer.Option(help="Position where all begin, at rest.", metavar="X")] = -0.5,
    replicate: Annotated[int, typer.Option(help="Whose policies drive.", metavar="R")] = 0,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", "-o", help="File that ends in .gif, .html or .mp4; without it a window.", metavar="FILE"
        ),
    ] = None,
) -> None:
    """Race trained cars from one start, the optimal drive beside them as a ghost."""
    from arena.figures.film import SUFFIXES, race, save_race, show
    from arena.results.results import load
    from envs.foundation.checks import choice

    if out is not None:
        choice("suffix of --out", out.suffix.lower(), SUFFIXES)  # before the race is driven
    with load(file) as results:
        driven = race(results, names or results.best(3), start, replicate)
    if out is None:
        show(driven)
    else:
        save_race(driven, out)
    answer("\n".join(driven.captions.values()))


def add_commands(app: typer.Typer) -> None:
    """Make it a command of ``app``."""
    app.command()(race)
