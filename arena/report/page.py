"""The page: one HTML file that says all of a tournament, without any network."""

import json
import math
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

from arena.analysis.curves import WINDOW
from arena.analysis.scores import SCORES, decimals, scores_of
from arena.analysis.standings import Leaderboard, check_confidence, leaderboard
from arena.report.page_data import page_data
from arena.reproduction.claims import results_claims
from arena.reproduction.published_values import MINIMUM_ACCURACY
from arena.reproduction.tables import compare
from arena.reproduction.verdicts import Claim
from arena.results.digests import digest
from arena.results.results import Results
from arena.tournament.builtin import BUILT_IN
from envs.foundation.errors import ArenaError, InvalidValueError


def write_report(results: Results, path: Path, by: str = "steps", confidence: float = 0.95) -> None:
    """Write the page.

    Args:
        results: of a tournament; it need not be finished.
        path: of the file.
        by: the score of the places.
        confidence: of intervals and places.

    Raises:
        ValueError: when there is no such score, or the confidence is not between 0 and 1.
        OSError: when the file cannot be written.
    """
    path.write_text(report(results, by, confidence), encoding="utf-8")


def report(results: Results, by: str = "steps", confidence: float = 0.95, most_drawn: int = 100) -> str:
    """The page as a text; see ``write_report``.

    Of at most ``most_drawn`` entrants, the first ones by place, there are curves, maps and drives; the
    leaderboard has all.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("arena.report", "assets"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=False,
    )
    environment.filters["number"] = _number
    environment.filters["pretty"] = lambda value: json.dumps(value, indent=1)
    check_confidence(confidence)
    scores = scores_of(results, by)
    board = leaderboard(results, by, confidence, scores)
    data = page_data(results, scores, board, most_drawn)
    paper, config = compare(results), results.config
    return environment.get_template("page.html").render(
        config=config,
        sections=_sections(paper=paper is not None),
        board=board,
        description=SCORES[by].description,
        percent=f"{100.0 * confidence:g}",
        columns=_columns(board),
        rows=list(_rows(results, board)),
        window=WINDOW,
        replicate=0,
        most_drawn=most_drawn,
        ghost=data["ghost"] is not None,
        paper=paper,
        least=f"{MINIMUM_ACCURACY:g}",
        claims=_claims(results),
        failures=[record for record in results.records if not record.finished],
        unavailable=data.pop("unavailable"),
        digest=digest(results),
        command=_command(config),
        versions=results.versions,
        data=data,
    )


def _sections(*, paper: bool) -> list[tuple[str, str]]:
    beside_the_paper = [("paper", "Beside the paper")] if paper else []
    return [
        ("leaderboard", "Leaderboard"),
        ("learning", "Learning"),
        ("maps", "Policies and visits"),
        ("pairs", "Pairs"),
        ("race", "Race"),
        *beside_the_paper,
        ("failures", "Failures"),
        ("reproduce", "How to reproduce"),
    ]


def _columns(board: Leaderboard) -> list[tuple[str, bool]]:
    """Labels, and whether the column is one of numbers."""
    scores = [(name.replace("_", " "), True) for name in board.shown]
    return [("place", False), ("entrant", False), ("agent", False), *scores, ("failed runs", True)]


def _rows(results: Results, board: Leaderboard) -> Iterator[dict[str, Any]]:
    for order, standing in enumerate(board.standings):
        numbers = []
        for name in board.shown:
            value, low, high = standing.scores[name]
            form = f"{{:,.{decimals(name)}f}}"
            ends = "" if math.isnan(low) else f" [{form.format(low)}, {form.format(high)}]"
            text = "-" if math.isnan(value) else form.format(value) + (ends if name == board.by else "")
            numbers.append((value, text))
        yield {
            "order": order,
            "place": standing.places,
            "entrant": standing.entrant,
            "agent": results.entrants[standing.entrant].agent,
            "numbers": [*numbers, (standing.failed, str(standing.failed))],
        }


def _claims(results: Results) -> list[Claim]:
    """Verdicts on what the results can decide; none if they are not those of the whole paper."""
    try:
        return results_claims(results)
    except InvalidValueError:
        return []


def _command(config: dict[str, Any]) -> str:
    """What runs the tournament again."""
    name, given = config["name"], {key: config[key] for key in ("replicates", "seed", "reading")}
    with suppress(ArenaError):  # another tournament that is called so
        if name in BUILT_IN and BUILT_IN[name](**given).to_dict() == config:
            return " ".join([f"arena run {name}", *(f"--{key} {value}" for key, value in given.items())])
    return (
        "import json, arena\n"
        "from arena.tournament import from_dict\n\n"
        "# configuration.json holds the configuration below\n"
        'arena.run(from_dict(json.load(open("configuration.json"))), "again.sqlite")'
    )


def _number(value: float) -> str:
    if math.isnan(value):
        return ""
    return f"{value:,.0f}" if abs(value) >= 1e4 else f"{value:,.4g}"
