"""What ``arena paper`` prints, and writes as a page of Markdown."""

import math
from collections import Counter
from collections.abc import Iterator
from datetime import UTC, datetime

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from arena.report.fitted import FittedTable
from arena.reproduction.verdicts import CENTRAL, NOT_TESTABLE, Claim
from arena.results.digests import digest
from arena.results.results import Results

_COLUMNS = ("section", "claim", "paper", "ours", "central", "percentile", "verdict")


def heading(results: Results, walks: int) -> str:
    """Return which results stand beside the paper."""
    config = results.config
    return (
        f"Beside the paper: {config['replicates']} replicates of its tournament "
        f"(reading {config['reading']}, seed {config['seed']}), {walks} series of its random walks."
    )


def render(claims: list[Claim], title: str) -> RenderableType:
    """Return the claims as a table, and how many hold."""
    return Group(Text(title), _table(claims), Text(_summary(claims)))


def _summary(claims: list[Claim]) -> str:
    counts = Counter(claim.verdict for claim in claims)
    verdicts = ", ".join(f"{count} {verdict}" for verdict, count in counts.items())
    numbers = sum(not math.isnan(claim.percentile) for claim in claims)
    left_out = numbers * (1.0 - CENTRAL / 100.0)
    return (
        f"{len(claims)} claims: {verdicts}. A number is reproduced if it is among the central {CENTRAL:g}% "
        f"of our replicates; of {numbers} numbers chance alone would leave about {left_out:.0f} out."
    )


def _rows(claims: list[Claim]) -> Iterator[tuple[str, ...]]:
    for claim in claims:
        digits = _digits(claim)
        ends = _text(claim.low, digits), _text(claim.high, digits)
        yield (
            claim.section,
            claim.statement + (f" ({claim.note})" if claim.note else ""),
            _text(claim.paper, digits),
            _text(claim.ours, digits),
            " to ".join(end for end in ends if end),
            _text(claim.percentile, 0),
            claim.verdict,
        )


def _digits(claim: Claim) -> int:
    """Decimals: about four digits of the number."""
    known = [abs(value) for value in (claim.paper, claim.ours) if not math.isnan(value)]
    return max(0, min(4, 3 - math.floor(math.log10(max(*known, 1e-4))))) if known else 0


def _text(value: float, digits: int) -> str:
    return "" if math.isnan(value) else f"{value:,.{digits}f}"


def _table(claims: list[Claim]) -> Table:
    table = FittedTable("claim", "verdict", "ours", "paper", padding=(0, 0, 0, 1), pad_edge=False)
    for name in _COLUMNS:
        right = name in {"paper", "ours", "central", "percentile"}
        table.add_column(name, justify="right" if right else "left", no_wrap=right, overflow="fold")
    for *cells, verdict in _rows(claims):
        style = {"reproduced": "green", NOT_TESTABLE: "yellow"}.get(verdict, "red")
        table.add_row(*map(Text, cells), Text(verdict, style))
    return table


def markdown_lines(results: Results, claims: list[Claim], title: str) -> Iterator[str]:
    """Yield the lines of the page."""
    versions = results.versions
    yield "# The paper, claim by claim"
    yield ""
    yield title
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
