"""What ``arena run`` and ``arena show`` print."""

import math
from collections.abc import Iterator
from typing import Any

from rich import box
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from arena.comparison import MINIMUM_ACCURACY, Comparison, compare
from arena.readings import READINGS
from arena.results import Results
from arena.statistics import mean_interval


def render(results: Results) -> RenderableType:
    """The paper's tables if it is the paper's tournament, else one line an entrant; then the failures."""
    comparison = compare(results)
    parts = [_paper(comparison)] if comparison else [_entrants(results)]
    return Group(Text(_heading(results)), *parts, *_failures(results))


def _heading(results: Results) -> str:
    config = results.config
    reading = READINGS.get(config["reading"])
    return (
        f"Tournament {config['name']}: {len(config['entrants'])} entrants, "
        f"{config['replicates']} replicates, seed {config['seed']}.\n"
        f"Reading of the paper: {config['reading']}"
        + (f" ({reading.description})" if reading else "")
        + ".\n± is the 95% interval of the mean (Student's t over the replicates)."
    )


def _entrants(results: Results) -> RenderableType:
    """One line an entrant, who needs the fewest steps first."""
    finished: dict[str, list[dict[str, Any]]] = {one["name"]: [] for one in results.config["entrants"]}
    for run in results.runs:
        if run["status"] == "finished":
            finished[run["entrant"]].append(run)

    def interval(name: str, score: str) -> tuple[float, float]:
        return mean_interval(math.nan if run[score] is None else run[score] for run in finished[name])

    def steps(name: str) -> float:
        mean, _ = interval(name, "steps")
        return math.inf if math.isnan(mean) else mean

    table = _table("", "entrant", "accuracy %", "length", "iterations")
    for name in sorted(finished, key=steps):
        accuracy, length, iterations = (
            _interval(*interval(name, score), places)
            for score, places in (("accuracy", 1), ("mean_length", 1), ("iterations", 0))
        )
        table.add_row(Text(name), accuracy, length, iterations)
    limit = results.config["evaluation"]["max_steps"]
    notes = [f"In the order of the mean steps, those of a failed episode counted as {limit}."]
    interpreted = [name for name, runs in finished.items() if any(r["driver"] != "compiled" for r in runs)]
    if interpreted:
        notes.append(f"Driven interpreted, in the PettingZoo environment: {', '.join(interpreted)}.")
    return Group(table, *map(Text, notes))


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
            _interval(*cell.accuracy, 2),
            f"{cell.paper_accuracy:.2f}",
            _interval(*cell.mean_length, 2),
            f"{cell.paper_mean_length:.2f}",
        )
        second.add_row(
            bins,
            _interval(*cell.iterations, 0),
            f"{cell.paper_iterations:,.0f}",
            f"{100.0 * (cell.iterations[0] / cell.paper_iterations - 1.0):+.1f}%",
        )
    cells = len(comparison.cells)
    summary = (
        f"Accuracy above {MINIMUM_ACCURACY:g}% in {comparison.accurate_cells} of {cells} cells; mean over "
        f"the cells {comparison.mean_accuracy:.2f}% (paper {comparison.paper_mean_accuracy:.2f}%).\n"
        f"Iterations beside the paper's: correlation {comparison.iterations_correlation:.3f} over the "
        f"{cells} cells, mean difference {comparison.iterations_difference:+.1f}%, "
        f"root mean square {comparison.iterations_error:.1f}%."
    )
    return Group(first, second, Text(summary))


def _failures(results: Results) -> Iterator[Text]:
    for run in results.runs:
        if run["status"] != "finished":
            last = (run.get("error", "").strip().splitlines() or ["no reason"])[-1]
            reason = "".join(c if c.isprintable() else "?" for c in last)
            yield Text(f"{run['entrant']} replicate {run['replicate']} failed: {reason}")


def _table(title: str, *columns: str) -> Table:
    table = Table(title=title or None, box=box.SIMPLE, title_justify="left", title_style="bold")
    for number, column in enumerate(columns):
        table.add_column(column, justify="right" if number else "left", no_wrap=number > 0)
    return table


def _interval(mean: float, half: float, places: int) -> str:
    if math.isnan(mean):
        return "-"
    return f"{mean:,.{places}f}" + ("" if math.isnan(half) else f" ± {half:,.{places}f}")
