"""What ``arena run`` and ``arena show`` print."""

import math
from collections.abc import Iterable, Iterator

from rich.cells import cell_len
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from arena.analysis.scores import SCORES, decimals
from arena.analysis.standings import Leaderboard, leaderboard
from arena.report.fitted import FittedTable
from arena.reproduction.published_values import MINIMUM_ACCURACY
from arena.reproduction.tables import Comparison, compare
from arena.results.results import Results
from arena.statistics.sequential import ADAPTIVE
from arena.tournament.readings import READINGS, RETIRED

_HEADERS = {
    "regret": "regret",
    "regret_median": "median",
    "regret_90": "90% below",
    "steps": "steps",
    "accuracy": "accuracy %",
    "length": "length",
    "iterations": "iterations",
}
_NAME = 20  # columns that a long name has at least, in a narrow terminal


def render(results: Results, by: str | None = None, confidence: float = 0.95) -> RenderableType:
    """The leaderboard and the failures; of the paper's tournament its tables, unless a score is asked for.

    Args:
        results: what to tell.
        by: the score that places are by; None is ``steps``.
        confidence: of the leaderboard's intervals and places.
    """
    comparison = compare(results) if by is None else None
    if comparison:
        parts = [Text(_heading(results, 0.95)), _paper(comparison)]
    else:
        board = leaderboard(results, by or "steps", confidence)
        parts = [Text(_heading(results, confidence)), _leaderboard(board), *map(Text, _notes(results, board))]
    return Group(*parts, *_failures(results))


def _heading(results: Results, confidence: float) -> str:
    config = results.config
    reading = (READINGS | RETIRED).get(config["reading"])
    replicates = config["replicates"]
    if replicates == ADAPTIVE:
        replicates = f"at most {config['max_replicates']}"
    return (
        f"Tournament {config['name']}: {len(config['entrants'])} entrants, "
        f"{replicates} replicates, seed {config['seed']}.\n"
        f"Reading of the paper: {config['reading']}"
        + (f" ({reading.description})" if reading else "")
        + f".\n± is the {100.0 * confidence:g}% interval of the mean (Student's t over the replicates)."
    )


def _leaderboard(board: Leaderboard) -> Table:
    """One line an entrant; the score that decides comes first, with its interval."""
    table = FittedTable("entrant", _HEADERS[board.by], "place", padding=(0, 0, 0, 1), pad_edge=False)
    table.add_column("place", no_wrap=True)
    add_names(table, [standing.entrant for standing in board.standings])
    for name in board.shown:
        table.add_column(_HEADERS[name], justify="right", no_wrap=True)
    for standing in board.standings:
        decisive = standing.scores[board.by]
        table.add_row(
            standing.places,
            Text(standing.entrant),
            interval_text(decisive.value, decisive.high - decisive.value, decimals(board.by)),
            *(
                interval_text(standing.scores[name].value, math.nan, decimals(name))
                for name in board.shown[1:]
            ),
        )
    return table


def _notes(results: Results, board: Leaderboard) -> Iterator[str]:
    yield f"By the mean {SCORES[board.by].description}."
    yield from board.remarks
    if any(standing.place > 1 for standing in board.standings):
        yield (
            f"Places such as 2-4: any of these, with {100.0 * board.confidence:g}% confidence for all "
            "(paired permutation tests, Holm)."
        )
    elif len(board.standings) > 1 and not board.remarks:
        yield "No two can be told apart (paired permutation tests, Holm)."
    failed = [f"{s.entrant} ({s.failed})" for s in board.standings if s.failed]
    if failed:
        yield f"A run that failed counts as the worst that is possible: {', '.join(failed)}."
    if len({record.replicate for record in results.records}) > board.replicates:
        yield f"Not finished: only the {board.replicates} replicates that all entrants have run count."
    interpreted = dict.fromkeys(
        record.entrant for record in results.records if record.finished and record.driver != "compiled"
    )
    if interpreted:
        yield f"Driven interpreted, in the PettingZoo environment: {', '.join(interpreted)}."


def _paper(comparison: Comparison) -> RenderableType:
    first = _table(
        "Table 1. Accuracy in percent and mean length",
        "n_p x n_v",
        "accuracy",
        "paper",
        "length",
        "paper",
    )
    second = _table("Table 2. Iterations of learning", "n_p x n_v", "iterations", "paper", "difference")
    algorithm = ""
    for cell in comparison.cells:
        if cell.algorithm != algorithm:
            algorithm = cell.algorithm
            for table in (first, second):
                table.add_section()
                table.add_row(Text(algorithm, style="bold"))
        bins = f"{cell.position_bins} x {cell.velocity_bins}"
        first.add_row(
            bins,
            interval_text(*cell.accuracy, 2),
            f"{cell.paper_accuracy:.2f}",
            interval_text(*cell.mean_length, 2),
            f"{cell.paper_mean_length:.2f}",
        )
        second.add_row(
            bins,
            interval_text(*cell.iterations, 0),
            f"{cell.paper_iterations:,.0f}",
            f"{100.0 * (cell.iterations[0] / cell.paper_iterations - 1.0):+.1f}%",
        )
    cells = len(comparison.cells)
    summary = (
        f"Accuracy above {MINIMUM_ACCURACY:g}% in {comparison.accurate_cells} of {cells} cells; mean over "
        f"the cells {comparison.mean_accuracy:.2f}% (paper {comparison.paper_mean_accuracy:.2f}%).\n"
        f"Iterations beside the paper's: correlation {comparison.iterations_correlation:.3f} over the "
        f"{cells} cells, mean difference {comparison.iterations_difference:+.1f}%, "
        f"root mean square {comparison.iterations_error:.1f}%{_chance(comparison)}."
    )
    return Group(first, second, Text(summary))


def _chance(comparison: Comparison) -> str:
    """What the root mean square would be by chance, where there are replicates to tell."""
    chance = comparison.iterations_chance
    return "" if math.isnan(chance) else f", by chance {chance:.1f}%"


def _failures(results: Results) -> Iterator[Text]:
    for record in results.records:
        if not record.finished:
            reason = "".join(c if c.isprintable() else "?" for c in record.reason)
            yield Text(f"{record.entrant} replicate {record.replicate} failed: {reason}")


def add_names(table: Table, names: Iterable[str]) -> None:
    """Add the column of the entrants, where long names may be folded."""
    table.add_column("entrant", overflow="fold", min_width=min(max(map(cell_len, names), default=0), _NAME))


def _table(title: str, *columns: str) -> Table:
    table = FittedTable(columns[0], title=title or None, title_justify="left", title_style="bold")
    for number, column in enumerate(columns):
        table.add_column(column, justify="right" if number else "left", no_wrap=number > 0)
    return table


def interval_text(mean: float, half: float, places: int) -> str:
    """``mean ± half``; a NaN is left out, without a mean it is a dash."""
    if math.isnan(mean):
        return "-"
    return f"{mean:,.{places}f}" + ("" if math.isnan(half) else f" ± {half:,.{places}f}")
