"""The command ``arena plot``: a results file as pictures."""

from collections.abc import Callable
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from arena.cli.console import answer
from arena.cli.options import By, File
from envs.foundation.errors import InvalidValueError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from arena.analysis.standings import Leaderboard
    from arena.results.results import Results

SUFFIXES = (".png", ".svg", ".pdf")
_SOME = 5  # entrants of a picture of lines, unless they are named


class Kind(StrEnum):
    """Choices of KIND."""

    LEARNING = "learning"
    POLICY = "policy"
    VISITS = "visits"
    VALUE = "value"
    PHASE = "phase"
    REGRET = "regret"
    SWEEP = "sweep"
    INTERVALS = "intervals"
    RANKS = "ranks"
    PAIRS = "pairs"


def plot(
    file: File,
    kind: Annotated[Kind, typer.Argument(help="What is drawn.", metavar="|".join(Kind))],
    entrant: Annotated[
        list[str] | None,
        typer.Option(help="Who is drawn, may be repeated; by default the best by steps.", metavar="NAME"),
    ] = None,
    replicate: Annotated[int, typer.Option(help="Whose policy or test drives.", metavar="R")] = 0,
    by: Annotated[By, typer.Option(help="The score of intervals, ranks and pairs.")] = By.STEPS,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", "-o", help="File that ends in .png, .svg or .pdf; by default KIND.png.", metavar="FILE"
        ),
    ] = None,
    dpi: Annotated[int, typer.Option(help="Dots an inch of a .png.", metavar="N")] = 150,
) -> None:
    """Draw a figure of the paper, or one beyond it, from a results file."""
    from arena.results.results import load
    from envs.foundation.checks import choice, integer

    out = out or Path(f"{kind.value}.png")
    choice("suffix of --out", out.suffix.lower(), SUFFIXES)
    integer("--dpi", dpi, 20)
    with load(file) as results:
        figure = _DRAW[kind](results, entrant, replicate, by.value)
    figure.savefig(out, dpi=dpi, metadata={"Date": None} if out.suffix.lower() == ".svg" else None)
    answer(str(out))


def _learning(results: "Results", named: list[str] | None, _replicate: int, _by: str) -> "Figure":
    from arena.figures.learning import draw_learning

    return _figure_of(draw_learning(results, named or results.best(_SOME)))


def _regret(results: "Results", named: list[str] | None, replicate: int, _by: str) -> "Figure":
    from arena.analysis.regret import fewest_steps
    from arena.figures.scores import draw_regret

    names = named or results.best(_SOME)
    for name in names:  # is there such a run? before the search, which takes seconds
        results.finished_arrays(name, replicate)
    starts = results.conditions.start_states(replicate)[:, 0]
    fewest = fewest_steps(results, [replicate])[replicate]
    return _figure_of(draw_regret(results, names, replicate, starts, fewest))


def _of_entrant(name: str) -> Callable[..., "Figure"]:
    """What draws the policy of one entrant by this function of ``arena.figures.policy``."""

    def draw(results: "Results", named: list[str] | None, replicate: int, _by: str) -> "Figure":
        from arena.figures import policy as figures_policy

        names = named or results.best(1)
        if len(names) != 1:
            raise InvalidValueError(
                f"--entrant must be given once for a picture of one policy, got {len(names)}"
            )
        return _figure_of(getattr(figures_policy, name)(results.trained(names[0], replicate)))

    return draw


def _sweep(results: "Results", named: list[str] | None, _replicate: int, _by: str) -> "Figure":
    from arena.analysis.scores import scores_of
    from arena.figures.sweep import draw_sweep

    _all(named)
    return draw_sweep(results, scores_of(results))


def _of_board(name: str) -> Callable[..., "Figure"]:
    """What draws the leaderboard by this function of ``arena.figures.scores``."""

    def draw(results: "Results", named: list[str] | None, _replicate: int, by: str) -> "Figure":
        from arena.analysis.standings import leaderboard
        from arena.figures import scores as figures_scores

        _all(named)
        return _figure_of(getattr(figures_scores, name)(_counted(leaderboard(results, by))))

    return draw


def _pairs(results: "Results", named: list[str] | None, _replicate: int, by: str) -> "Figure":
    from arena.analysis.scores import scores_of
    from arena.analysis.standings import leaderboard
    from arena.figures.scores import draw_pairs

    _all(named)
    scores = scores_of(results, by)
    return _figure_of(draw_pairs(scores, _counted(leaderboard(results, by, scores=scores))))


_DRAW: dict[Kind, Callable[..., "Figure"]] = {
    Kind.LEARNING: _learning,
    Kind.POLICY: _of_entrant("draw_policy"),
    Kind.VISITS: _of_entrant("draw_visits"),
    Kind.VALUE: _of_entrant("draw_value"),
    Kind.PHASE: _of_entrant("draw_phase"),
    Kind.REGRET: _regret,
    Kind.SWEEP: _sweep,
    Kind.INTERVALS: _of_board("draw_intervals"),
    Kind.RANKS: _of_board("draw_ranks"),
    Kind.PAIRS: _pairs,
}


def _figure_of(drawn: "Axes | Figure") -> "Figure":
    """The figure of axes; a figure itself."""
    figure: Figure = drawn if hasattr(drawn, "savefig") else drawn.figure  # type: ignore[assignment]  # no SubFigure
    return figure


def _all(named: list[str] | None) -> None:
    if named:
        raise InvalidValueError(f"--entrant must be left out of a picture of all entrants, got {named[0]!r}")


def _counted(board: "Leaderboard") -> "Leaderboard":
    if not board.replicates:
        raise InvalidValueError("there is no replicate that all entrants have run")
    return board


def add_commands(app: typer.Typer) -> None:
    """Make it a command of ``app``."""
    app.command()(plot)
