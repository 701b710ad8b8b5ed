"""What ``arena curves`` prints."""

import math
from typing import TYPE_CHECKING, Any

from rich.console import Group, RenderableType
from rich.text import Text

from arena.report.fitted import FittedTable
from arena.report.tables import add_names, interval_text
from arena.statistics.intervals import mean_interval

if TYPE_CHECKING:
    import pandas as pd


def summaries(frame: "pd.DataFrame", confidence: float) -> list[dict[str, Any]]:
    """Return a row an entrant of ``analysis.curves.learning_curves``, the fastest first.

    Args:
        frame: the learning curves.
        confidence: of the interval whose half width is ``area_error``.
    """
    rows: list[dict[str, Any]] = []
    for entrant, runs in frame.groupby("entrant", sort=False):
        area, error = mean_interval(runs["area"], confidence)
        settled = runs["settled"].dropna()
        rows.append(
            {
                "entrant": str(entrant),
                "area": area,
                "area_error": error,
                "settled": len(settled),
                "replicates": len(runs),
                "median_episode": float(settled.median()) if len(settled) else math.nan,
            }
        )
    return sorted(rows, key=lambda row: math.inf if math.isnan(row["area"]) else row["area"])


def render(rows: list[dict[str, Any]], level: float, window: int, confidence: float) -> RenderableType:
    """Return the rows as a table, and what its columns mean."""
    table = FittedTable("entrant", padding=(0, 0, 0, 1), pad_edge=False)
    add_names(table, [row["entrant"] for row in rows])
    for name in ("area", "settled", "episode"):
        table.add_column(name, justify="right", no_wrap=True)
    for row in rows:
        table.add_row(
            Text(row["entrant"]),
            interval_text(row["area"], row["area_error"], 1),
            f"{row['settled']} of {row['replicates']}",
            interval_text(row["median_episode"], math.nan, 0),
        )
    legend = (
        f"area: mean steps of an episode of training, by the moving average of {window}; ± is the "
        f"{100.0 * confidence:g}% interval of the mean over the replicates.\n"
        f"settled: replicates whose moving average stays at or below {level:g} steps in the end; "
        "episode: the median of those from which on it does."
    )
    return Group(table, Text(legend))
