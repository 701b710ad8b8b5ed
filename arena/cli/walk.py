"""The command ``arena walk``."""

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer
from rich import box
from rich.console import Console, Group, RenderableType
from rich.table import Table
from rich.text import Text

from arena.cli.progress import progress_bar
from arena.reproduction.published import PAPER, REASONABLE, Summary
from arena.reproduction.walk_study import WalkStudy, study
from arena.tournament.hills import find_hill
from arena.walks.distributions import BOOTSTRAPS
from arena.walks.series import InterruptedWalk, RandomWalk, random_walk
from envs import Hill, Integrator
from envs.foundation.errors import InvalidValueError

INTERRUPTED = 130
_PICTURES = (".png", ".svg", ".pdf")


def walk(
    episodes: Annotated[int, typer.Option(help="How many; the paper's ITMAX.", metavar="N")] = 2000,
    hill: Annotated[
        str,
        typer.Option(
            help="paper, constrained, or a TOML file with a table [hill].", metavar="NAME|FILE.toml"
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
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Walk at random to the goal: bounds of the state, lengths of episodes, and their distribution."""
    if jobs == 0:
        raise InvalidValueError("--jobs must not be 0: give a number of workers, or -1 for one a core")
    _check_files(out, figure)
    chosen = find_hill(hill)
    walks, stopped = _walks(_hills(chosen, integrator), episodes, seed, jobs, max_steps)
    if walks:
        try:
            found = study(walks, 0 if stopped else BOOTSTRAPS, jobs)
        except KeyboardInterrupt:
            found, stopped = study(walks, 0), "interrupted while distributions were fitted"
        told = json.dumps(found.to_dict(), allow_nan=False)
        if out:
            out.write_text(told + "\n", encoding="utf-8")
        if figure:
            from arena.figures.walks import save_figure

            save_figure(found, figure)
        if as_json:
            print(told)
        else:
            Console(highlight=False, soft_wrap=True).print(_render(found, hill))
    if stopped:
        print(f"arena: {stopped}", file=sys.stderr)
        raise typer.Exit(INTERRUPTED)


def _check_files(out: Path | None, figure: Path | None) -> None:
    """Before the walks, so that none are in vain."""
    if figure and figure.suffix not in _PICTURES:
        raise InvalidValueError(f"--figure must end in one of {', '.join(_PICTURES)}, got {str(figure)!r}")
    for option, file in (("--out", out), ("--figure", figure)):
        if file and (file.is_dir() or not file.parent.is_dir()):
            raise InvalidValueError(f"{option} must be a file in a folder that exists, got {str(file)!r}")


def _hills(hill: Hill, integrator: str | None) -> list[Hill]:
    if integrator is not None:
        return [hill._replace(integrator=Integrator(integrator))]  # type: ignore[arg-type]  # takes names
    return [hill, *(hill._replace(integrator=other) for other in Integrator if other != hill.integrator)]


def _walks(
    hills: list[Hill], episodes: int, seed: int, jobs: int, max_steps: int
) -> tuple[list[RandomWalk], str]:
    """Walks on each hill, as far as they were finished; and why they were not."""
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


def _render(found: WalkStudy, hill: str) -> RenderableType:
    first = found.walks[0]
    heading = f"Random walks on the hill {hill}: {len(first.lengths):,} episodes, seed {first.seed}."
    parts: list[RenderableType] = [Text(heading), _summaries(found)]
    if found.fits:
        parts += [Text(f"Fits to the lengths, {first.hill.integrator.label}:"), _fits(found)]
    return Group(*parts, *map(Text, found.verdicts))


def _table(first: str, *others: str) -> Table:
    table = Table(box=box.SIMPLE, padding=(0, 0, 0, 2), pad_edge=False)
    table.add_column(first, no_wrap=True)
    for name in others:
        table.add_column(name, justify="right", no_wrap=True)
    return table


def _summaries(found: WalkStudy) -> Table:
    columns = [walk.hill.integrator.label for walk in found.walks]
    told = [list(_told(one)) for one in found.summaries]
    if found.is_the_paper_s:
        columns.append("paper")
        told.append(list(_told(PAPER)))
    table = _table("", *columns)
    for row in zip(*told):
        table.add_row(row[0][0], *(value for _, value in row))
    return table


def _told(one: Summary) -> Iterator[tuple[str, str]]:
    yield "shortest episode, steps", f"{one.least:,}"
    yield "longest episode, steps", f"{one.most:,}"
    yield "mean", f"{one.mean:,.0f}"
    yield "standard error of the mean", f"{one.standard_error:,.0f}"
    yield "standard deviation", f"{one.deviation:,.0f}"
    share = "above 50%" if one is PAPER else f"{100.0 * one.share_below:.1f}%"
    yield f"share below {REASONABLE:,} steps", share
    yield "least position", f"{one.position[0]:.4f}"
    yield "greatest position", f"{one.position[1]:.4f}"
    yield "least velocity", f"{one.velocity[0]:.5f}"
    yield "greatest velocity", f"{one.velocity[1]:.5f}"


def _fits(found: WalkStudy) -> Table:
    table = _table("distribution", "log-likelihood", "AIC", "KS distance", "p-value")
    for fit in found.fits:
        table.add_row(
            fit.family.name,
            f"{fit.log_likelihood:,.1f}",
            f"{fit.aic:,.1f}",
            f"{fit.distance:.4f}",
            f"{fit.p_value:.3f}",
        )
    return table


def add_commands(app: typer.Typer) -> None:
    """Make it a command of ``app``."""
    app.command()(walk)
