"""How a notebook shows results, tournaments and trained agents: as HTML, in which names are text."""

import io
from html import escape

from arena.common.html import representation, table
from arena.results.results import Results
from arena.results.trained import Trained, UnknownPolicyError
from arena.tournament.tournament import Tournament


@representation.register
def results_html(results: Results) -> str:
    """The leaderboard by steps."""
    from arena.analysis.scores import decimals
    from arena.analysis.standings import leaderboard

    board = leaderboard(results)
    names = list(board.standings[0].scores)
    rows = (
        [
            standing.places,
            standing.entrant,
            *(f"{standing.scores[name].value:,.{decimals(name)}f}" for name in names),
        ]
        for standing in board.standings
    )
    replicates = f"{board.replicates} replicate{'s' * (board.replicates != 1)} of all"
    return table(f"Tournament {results.config['name']}: {replicates}", ["place", "entrant", *names], rows)


@representation.register
def tournament_html(tournament: Tournament) -> str:
    """The entrants, and what was given of their parameters."""
    rows = (
        [
            entrant.name,
            entrant.agent.__name__,
            ", ".join(f"{key}={entrant.parameters[key]}" for key in sorted(entrant.given)),
        ]
        for entrant in tournament.entrants
    )
    heading = f"Tournament {tournament.name}: {tournament.replicates} replicates, seed {tournament.seed}"
    return table(heading, ["entrant", "agent", "parameters given"], rows)


@representation.register
def trained_html(agent: Trained) -> str:
    """The map of its policy; a sentence where it has none."""
    from arena.figures.policy import draw_policy

    try:
        axes = draw_policy(agent)
    except UnknownPolicyError as error:
        return f"<p>{escape(str(error))}</p>"
    buffer = io.StringIO()
    axes.figure.savefig(buffer, format="svg")  # type: ignore[union-attr]  # no SubFigure
    drawing = buffer.getvalue()
    return drawing[drawing.index("<svg") :]
