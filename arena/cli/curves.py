"""The command ``arena curves``: how fast the entrants learn."""

import json
import math
import sys
from typing import Annotated, Any

import typer
from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from arena.cli.options import AsJson, Confidence, File
from arena.results.results import load
from envs.foundation.errors import InvalidValueError


def curves(
    file: File,
    level: Annotated[
        float,
        typer.Option(help="Steps an episode at which an entrant has learned.", metavar="STEPS"),
    ] = 200.0,
    window: Annotated[int, typer.Option(help="Episodes that are averaged.", metavar="N")] = 50,
    confidence: Confidence = 0.95,
    as_json: AsJson = False,
    as_csv: Annotated[bool, typer.Option("--csv", help="Print a line a run, with commas.")] = False,
) -> None:
    """Print how fast entrants learn: the area under the curves, and when they stay below a level."""
    from arena.analysis.curves import learning_curves
    from arena.analysis.standings import check_confidence
    from arena.common.plain import without_nan
    from arena.statistics.intervals import mean_interval

    if as_json and as_csv:
        raise InvalidValueError("--json and --csv must not be given together")
    check_confidence(confidence)
    with load(file) as results:
        frame = learning_curves(results, level, window)
    if as_csv:
        frame.to_csv(sys.stdout, index=False)
        return
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
    rows.sort(key=lambda row: math.inf if math.isnan(row["area"]) else row["area"])
    if as_json:
        told = {"level": level, "window": window, "entrants": without_nan(rows)}
        print(json.dumps(told, allow_nan=False))
        return
    _print(rows, level, window, confidence)


def _print(rows: list[dict[str, Any]], level: float, window: int, confidence: float) -> None:
    from arena.report.tables import interval_text

    table = Table(box=box.SIMPLE, padding=(0, 0, 0, 1), pad_edge=False)
    table.add_column("entrant", overflow="fold")
    for name in ("area", "settled", "episode"):
        table.add_column(name, justify="right", no_wrap=True)
    for row in rows:
        table.add_row(
            Text(row["entrant"]),
            interval_text(row["area"], row["area_error"], 1),
            f"{row['settled']} of {row['replicates']}",
            interval_text(row["median_episode"], math.nan, 0),
        )
    console = Console(highlight=False, soft_wrap=True)
    console.print(table)
    console.print(
        f"area: mean steps of an episode of training, by the moving average of {window}; ± is the "
        f"{100.0 * confidence:g}% interval of the mean over the replicates.\n"
        f"settled: replicates whose moving average stays at or below {level:g} steps in the end; "
        "episode: the median of those from which on it does."
    )


def add_commands(app: typer.Typer) -> None:
    """Make it a command of ``app``."""
    app.command()(curves)
