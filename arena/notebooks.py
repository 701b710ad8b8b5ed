"""How a notebook shows results, tournaments and trained agents: as HTML, in which names are text."""

import io
from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from arena.results import Results
    from arena.tournament import Tournament
    from arena.trained import Trained


def results_html(results: "Results") -> str:
    """The leaderboard by steps."""
    from arena.leaderboard import leaderboard
    from arena.scores import decimals

    board = leaderboard(results)
    names = list(board.standings[0].scores)
    rows = (
        [one.places, one.entrant, *(f"{one.scores[name].value:,.{decimals(name)}f}" for name in names)]
        for one in board.standings
    )
    replicates = f"{board.replicates} replicate{'s' * (board.replicates != 1)} of all"
    return _table(f"Tournament {results.config['name']}: {replicates}", ["place", "entrant", *names], rows)


def tournament_html(tournament: "Tournament") -> str:
    """The entrants, and what was given of their parameters."""
    rows = (
        [one.name, one.agent.__name__, ", ".join(f"{key}={one.parameters[key]}" for key in sorted(one.given))]
        for one in tournament.entrants
    )
    heading = f"Tournament {tournament.name}: {tournament.replicates} replicates, seed {tournament.seed}"
    return _table(heading, ["entrant", "agent", "parameters given"], rows)


def trained_html(agent: "Trained") -> str:
    """The map of its policy; a sentence where it has none."""
    from arena.figures_policy import draw_policy
    from arena.trained import UnknownPolicyError

    try:
        axes = draw_policy(agent)
    except UnknownPolicyError as error:
        return f"<p>{escape(str(error))}</p>"
    buffer = io.StringIO()
    axes.figure.savefig(buffer, format="svg")  # type: ignore[union-attr]  # no SubFigure
    drawing = buffer.getvalue()
    return drawing[drawing.index("<svg") :]


def _table(caption: str, heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    head = "".join(f'<th scope="col">{escape(name)}</th>' for name in heads)
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    parts = f"<caption>{escape(caption)}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody>"
    return f"<table>{parts}</table>"
