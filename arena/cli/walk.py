"""The command ``arena walk``."""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from arena.cli.console import INTERRUPTED, answer, say, terminal
from arena.cli.options import AsJson
from arena.cli.progress import progress_bar
from envs.foundation.errors import InvalidValueError

if TYPE_CHECKING:
    from arena.walks.series import RandomWalk
    from envs.hill import Hill

_PICTURES = (".png", ".svg", ".pdf")


def walk(
    episodes: Annotated[int, typer.Option(help="How many; the paper's ITMAX.", metavar="N")] = 2000,
    hill: Annotated[
        str,
        typer.Option(
            help="paper, as-run, constrained, or a TOML file with a table [hill].", metavar="NAME|FILE.toml"
        ),
    ] = "paper",
    integrator: Annotated[
        str | None,
        typer.Option(help="By default both, the hill's own first.", metavar="semi-implicit|explicit"),
    ] = None,
    seed: Annotated[int, typer.Option(help="Master seed.", metavar="S")] = 0,
    jobs: Annotated[int, typer.Option(help="Workers; -1 is one a core.", metavar="N")] = -1,
    max_steps: Annotated[int, typer.Option(help="Where an episode is given up.", metavar="N")] = 1_000_000,
    out: Annotated[Path | None, typer.Option(help="File for what --json prints.", metavar="FILE")] = None,
    figure: Annotated[
        Path | None,
        typer.Option(help="Picture of the hill and the lengths: .png, .svg or .pdf.", metavar="FILE"),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Walk at random to the goal: bounds of the state, lengths of episodes, and their distribution."""
    from arena.report.walks import render
    from arena.reproduction.walk_study import study
    from arena.tournament.hills import find_hill
    from arena.walks.distributions import BOOTSTRAPS

    if jobs == 0:
        raise InvalidValueError("--jobs must not be 0: give a number of workers, or -1 for one a core")
    _check_files(out, figure)
    chosen = find_hill(hill)
    walks, stopped = _walks(_hills(chosen, integrator), episodes, seed, jobs, max_steps)
    if walks:
        try:
            studied = study(walks, 0 if stopped else BOOTSTRAPS, jobs)
        except KeyboardInterrupt:
            studied, stopped = study(walks, 0), "interrupted while distributions were fitted"
        text = json.dumps(studied.to_dict(), allow_nan=False)
        if out:
            out.write_text(text + "\n", encoding="utf-8")
        if figure:
            from arena.figures.walks import save_figure

            save_figure(studied, figure)
        if as_json:
            answer(text)
        else:
            terminal().print(render(studied, hill))
    if stopped:
        say(stopped)
        raise typer.Exit(INTERRUPTED)


def _check_files(out: Path | None, figure: Path | None) -> None:
    """Before the walks, so that none are in vain."""
    if figure and figure.suffix not in _PICTURES:
        raise InvalidValueError(f"--figure must end in one of {', '.join(_PICTURES)}, got {str(figure)!r}")
    for option, file in (("--out", out), ("--figure", figure)):
        if file and (file.is_dir() or not file.parent.is_dir()):
            raise InvalidValueError(f"{option} must be a file in a folder that exists, got {str(file)!r}")


def _hills(hill: "Hill", integrator: str | None) -> "list[Hill]":
    from envs.hill import Integrator

    if integrator is not None:
        return [hill._replace(integrator=Integrator(integrator))]  # type: ignore[arg-type]  # takes names
    return [hill, *(hill._replace(integrator=other) for other in Integrator if other != hill.integrator)]


def _walks(
    hills: "Iterable[Hill]", episodes: int, seed: int, jobs: int, max_steps: int
) -> "tuple[list[RandomWalk], str]":
    """Walks on each hill, as far as they were finished; and why they were not."""
    from arena.walks.series import InterruptedWalk, random_walk

    walks: list[RandomWalk] = []
    for hill in hills:
        try:
            with progress_bar(hill.integrator.label) as progress:
                walks.append(random_walk(episodes, hill, seed, jobs, max_steps, progress=progress))
        except InterruptedWalk as stop:
            if len(stop.walk.lengths):
                walks.append(stop.walk)
            return walks, f"{stop} ({hill.integrator.label})"
    return walks, ""


def add_commands(app: typer.Typer) -> None:
    """Make it a command of ``app``."""
    app.command()(walk)
