"""What ``arena walk`` prints."""

from collections.abc import Iterator

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from arena.report.fitted import FittedTable
from arena.reproduction.published_values import PAPER, REASONABLE, Summary
from arena.reproduction.walk_study import WalkStudy


def render(study: WalkStudy, hill: str) -> RenderableType:
    """Return the walks on a hill of that name, beside the paper's where they can be compared."""
    first = study.walks[0]
    heading = f"Random walks on the hill {hill}: {len(first.lengths):,} episodes, seed {first.seed}."
    parts: list[RenderableType] = [Text(heading), _summaries(study)]
    if study.fits:
        parts += [Text(f"Fits to the lengths, {first.hill.integrator.label}:"), _fits(study)]
    return Group(*parts, *map(Text, study.verdicts))


def _table(first: str, *others: str) -> Table:
    table = FittedTable(first, padding=(0, 0, 0, 2), pad_edge=False)
    table.add_column(first)
    for name in others:
        table.add_column(name, justify="right", no_wrap=True)
    return table


def _summaries(study: WalkStudy) -> Table:
    headings = [walk.hill.integrator.label for walk in study.walks]
    columns = [list(_rows(summary)) for summary in study.summaries]
    if study.on_the_papers_hill:
        headings.append("paper")
        columns.append(list(_rows(PAPER)))
    table = _table("", *headings)
    for row in zip(*columns):
        table.add_row(row[0][0], *(value for _, value in row))
    return table


def _rows(summary: Summary) -> Iterator[tuple[str, str]]:
    yield "shortest episode, steps", f"{summary.least:,}"
    yield "longest episode, steps", f"{summary.most:,}"
    yield "mean", f"{summary.mean:,.0f}"
    yield "standard error of the mean", f"{summary.standard_error:,.0f}"
    yield "standard deviation", f"{summary.deviation:,.0f}"
    share = "above 50%" if summary is PAPER else f"{100.0 * summary.share_below:.1f}%"
    yield f"share below {REASONABLE:,} steps", share
    yield "least position", f"{summary.position[0]:.4f}"
    yield "greatest position", f"{summary.position[1]:.4f}"
    yield "least velocity", f"{summary.velocity[0]:.5f}"
    yield "greatest velocity", f"{summary.velocity[1]:.5f}"


def _fits(study: WalkStudy) -> Table:
    table = _table("distribution", "log-likelihood", "AIC", "KS distance", "p-value")
    for fit in study.fits:
        table.add_row(
            fit.family.name,
            f"{fit.log_likelihood:,.1f}",
            f"{fit.aic:,.1f}",
            f"{fit.distance:.4f}",
            f"{fit.p_value:.3f}",
        )
    return table
