"""The command ``arena paper``: the paper, claim by claim."""

import json
import math
from collections import Counter
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import typer
from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from arena.cli.options import AsJson, File
from arena.reproduction.verdicts import CENTRAL, NOT_TESTABLE, Claim
from arena.results.results import Results, load
from envs.foundation.errors import InvalidValueError

_COLUMNS = ("section", "claim", "paper", "ours", "central", "percentile", "verdict")


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
    from arena.reproduction.claims import WALKS, paper_claims
    from arena.reproduction.tables import paper_tables
    from arena.walks.series import random_walk

    if walks < 2:
        raise InvalidValueError(f"--walks must be at least 2, got {walks}")
    with load(file) as results:
        paper_tables(results)  # before the walks: is it all there?
        series = [random_walk(WALKS, seed=seed + number, n_jobs=jobs) for number in range(walks)]
        claims = paper_claims(results, series)
        heading = _heading(results, walks)
        if markdown is not None:
            markdown.write_text("\n".join(_markdown(results, claims, heading)), encoding="utf-8")
    if as_json:
        print(json.dumps([claim.to_dict() for claim in claims], allow_nan=False))
        return
    console = Console(highlight=False, soft_wrap=True)
    console.print(Text(heading))
    console.print(_table(claims))
    console.print(Text(_summary(claims)))


def _heading(results: Results, walks: int) -> str:
    config = results.config
    return (
        f"Beside the paper: {config['replicates']} replicates of its tournament "
        f"(reading {config['reading']}, seed {config['seed']}), {walks} series of its random walks."
    )


def _summary(claims: list[Claim]) -> str:
    counts = Counter(claim.verdict for claim in claims)
    told = ", ".join(f"{count} {verdict}" for verdict, count in counts.items())
    numbers = sum(not math.isnan(claim.percentile) for claim in claims)
    left_out = numbers * (1.0 - CENTRAL / 100.0)
    return (
        f"{len(claims)} claims: {told}. A number is reproduced if it is among the central {CENTRAL:g}% "
        f"of our replicates; of {numbers} numbers chance alone would leave about {left_out:.0f} out."
    )


def _rows(claims: list[Claim]) -> Iterator[tuple[str, ...]]:
    for claim in claims:
        digits = _digits(claim)
        ends = _told(claim.low, digits), _told(claim.high, digits)
        yield (
            claim.section,
            claim.statement + (f" ({claim.note})" if claim.note else ""),
            _told(claim.paper, digits),
            _told(claim.ours, digits),
            " to ".join(end for end in ends if end),
            _told(claim.percentile, 0),
            claim.verdict,
        )


def _digits(claim: Claim) -> int:
    """Decimals: about four digits of the number."""
    known = [abs(value) for value in (claim.paper, claim.ours) if not math.isnan(value)]
    return max(0, min(4, 3 - math.floor(math.log10(max(*known, 1e-4))))) if known else 0


def _told(value: float, digits: int) -> str:
    return "" if math.isnan(value) else f"{value:,.{digits}f}"


def _table(claims: list[Claim]) -> Table:
    table = Table(box=box.SIMPLE, padding=(0, 0, 0, 1), pad_edge=False)
    for name in _COLUMNS:
        right = name in {"paper", "ours", "central", "percentile"}
        table.add_column(name, justify="right" if right else "left", no_wrap=right, overflow="fold")
    for *cells, verdict in _rows(claims):
        style = {"reproduced": "green", NOT_TESTABLE: "yellow"}.get(verdict, "red")
        table.add_row(*map(Text, cells), Text(verdict, style))
    return table


def _markdown(results: Results, claims: list[Claim], heading: str) -> Iterator[str]:
    from arena.results.digests import digest

    versions = results.versions
    yield "# The paper, claim by claim"
    yield ""
    yield heading
    yield ""
    yield f"Written by `arena paper FILE --markdown` on {datetime.now(UTC):%Y-%m-%d}, from results of version"
    yield f"{versions.get('mountain-car-arena', '?')} with the digest `{digest(results)}`."
    yield ""
    yield _summary(claims)
    yield ""
    yield "`ours` is the mean over our replicates, `central` the range of the middle 95% of them,"
    yield "`percentile` that of the paper's number among them."
    yield ""
    yield f"| {' | '.join(_COLUMNS)} |"
    yield "|---|---|---:|---:|---:|---:|---|"
    for row in _rows(claims):
        yield f"| {' | '.join(row)} |"
    yield ""


def add_commands(app: typer.Typer) -> None:
    """Make it a command of ``app``."""
    app.command()(paper)
