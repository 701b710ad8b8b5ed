"""The paper's Tables 1 and 2, and ours beside them."""

import csv
import math
from dataclasses import asdict, dataclass
from functools import lru_cache
from importlib import resources
from typing import Any

from arena.results import Results
from arena.statistics import correlation, mean_interval

Key = tuple[str, int, int]
MINIMUM_ACCURACY = 73.0  # "all the 32 algorithm runs produced an accuracy higher than 73%"


@dataclass(frozen=True)
class Cell:
    """One cell of the tables: ours as mean and half width of its 95% interval, and the paper's."""

    algorithm: str
    position_bins: int
    velocity_bins: int
    accuracy: tuple[float, float]
    mean_length: tuple[float, float]
    iterations: tuple[float, float]
    paper_accuracy: float
    paper_mean_length: float
    paper_iterations: float


@dataclass(frozen=True)
class Comparison:
    """Our tables beside the paper's.

    Attributes:
        cells: in the paper's order.
        accurate_cells: how many of them have a mean accuracy above 73%.
        mean_accuracy: over the cells, in percent.
        paper_mean_accuracy: the same of the paper's table.
        iterations_correlation: of our means with the paper's Table 2.
        iterations_difference: mean relative difference of ours from it, in percent.
        iterations_error: root mean square of the relative differences, in percent.
    """

    cells: tuple[Cell, ...]
    accurate_cells: int
    mean_accuracy: float
    paper_mean_accuracy: float
    iterations_correlation: float
    iterations_difference: float
    iterations_error: float

    def to_dict(self) -> dict[str, Any]:
        """Plain values, NaN as None."""
        found: dict[str, Any] = without_nan(asdict(self))
        return found


def compare(results: Results) -> Comparison | None:
    """The comparison, if ``results`` are of the tournament ``paper``; else None."""
    if results.config["name"] != "paper":
        return None
    runs: dict[Key, list[dict[str, Any]]] = {}
    for run in results.runs:
        bins = run["parameters"].get("bins")
        if isinstance(bins, list) and len(bins) == 2:
            runs.setdefault((run["agent"], *bins), []).append(run)
    cells = tuple(_cell(key, runs.get(key, []), *row) for key, row in published().items())
    ours = [cell.iterations[0] for cell in cells]
    theirs = [cell.paper_iterations for cell in cells]
    ratios = [a / b - 1.0 for a, b in zip(ours, theirs, strict=True) if not math.isnan(a)]
    return Comparison(
        cells,
        sum(cell.accuracy[0] > MINIMUM_ACCURACY for cell in cells),
        mean_interval(cell.accuracy[0] for cell in cells)[0],
        mean_interval(cell.paper_accuracy for cell in cells)[0],
        correlation(ours, theirs),
        100.0 * mean_interval(ratios)[0],
        100.0 * math.sqrt(mean_interval(ratio**2 for ratio in ratios)[0]),
    )


@lru_cache
def published() -> dict[Key, tuple[float, float, float]]:
    """Accuracy in percent, mean length and iterations, by algorithm, n_p and n_v."""
    first, second = (_table(f"table{number}.csv") for number in (1, 2))
    return {
        key: (
            float(row["accuracy_percent"]),
            float(row["mean_length"]),
            float(second[key]["iterations"]),
        )
        for key, row in first.items()
    }


def _table(name: str) -> dict[Key, dict[str, str]]:
    text = resources.files("arena").joinpath("data", name).read_text(encoding="utf-8")
    return {
        (row["algorithm"], int(row["position_bins"]), int(row["velocity_bins"])): row
        for row in csv.DictReader(text.splitlines())
    }


def _cell(
    key: Key, runs: list[dict[str, Any]], accuracy: float, mean_length: float, iterations: float
) -> Cell:
    finished = [run for run in runs if run["status"] == "finished"]

    def mean(name: str) -> tuple[float, float]:
        return mean_interval(math.nan if run[name] is None else float(run[name]) for run in finished)

    ours = (mean("accuracy"), mean("mean_length"), mean("iterations"))
    return Cell(*key, *ours, accuracy, mean_length, iterations)


def without_nan(value: Any) -> Any:
    """``value`` with None in place of NaN, tuples as lists."""
    if isinstance(value, dict):
        return {name: without_nan(part) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [without_nan(part) for part in value]
    return None if isinstance(value, float) and math.isnan(value) else value
