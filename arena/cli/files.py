"""The commands that change results files, or make other files of them."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from arena.cli.console import say
from arena.cli.options import File


class What(StrEnum):
    """Choices of ``--what``."""

    RUNS = "runs"
    EPISODES = "episodes"
    ARRAYS = "arrays"


Output = Annotated[Path, typer.Option("--out", "-o", help="File that is written.", metavar="FILE")]


def prune(file: File) -> None:
    """Remove what a results file keeps of former versions of entrants."""
    from arena.results.editing import prune as prune_file

    count = prune_file(file)
    say(f"removed {count} run{'s' * (count != 1)} of former versions from {file}")


def drop(
    file: File,
    entrant: Annotated[list[str], typer.Option(help="Who goes; may be given again.", metavar="NAME")],
) -> None:
    """Remove entrants and their runs from a results file."""
    from arena.results.editing import drop as drop_entrants

    drop_entrants(file, entrant)


def merge(
    files: Annotated[list[Path], typer.Argument(help="Results files of one tournament.", metavar="FILE...")],
    out: Output,
) -> None:
    """Write the runs of several results files into a new one; a run that differs between them is an error."""
    from arena.results.editing import merge as merge_files

    merge_files(files, out)


def export(
    file: File,
    out: Output,
    what: Annotated[What, typer.Option(help="Rows of runs or of episodes, or all arrays.")] = What.RUNS,
) -> None:
    """Write results as .csv, .json or .parquet, arrays as .npz."""
    from arena.results.export import export as export_results
    from arena.results.results import load

    if out.absolute() == file.absolute():
        raise typer.BadParameter(
            f"it must not be the results file itself, got {str(out)!r}", param_hint="--out"
        )
    with load(file) as results:
        export_results(results, what.value, out)


def add_commands(app: typer.Typer) -> None:
    """Make them commands of ``app``."""
    for command in (prune, drop, merge, export):
        app.command()(command)
