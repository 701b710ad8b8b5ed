"""The paper's Tables 1 and 2, and ours beside them."""

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from arena.common.npz import Floats
from arena.common.plain import without_nan
from arena.reproduction.published_values import MINIMUM_ACCURACY, Key, published
from arena.results.records import RunRecord
from arena.results.results import Results
from arena.statistics.intervals import correlation, mean_interval
from envs.foundation.errors import InvalidValueError


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
        values: dict[str, Any] = without_nan(asdict(self))
        return values


def compare(results: Results) -> Comparison | None:
    """The comparison, if ``results`` are of the tournament ``paper``; else None."""
    if results.config["name"] != "paper":
        return None
    keys = _keys(results)
    runs: dict[Key, list[RunRecord]] = {}
    for record in results.records:
        if record.finished and record.entrant in keys:
            runs.setdefault(keys[record.entrant], []).append(record)
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


def _cell(key: Key, runs: list[RunRecord], accuracy: float, mean_length: float, iterations: float) -> Cell:
    def mean(score: str) -> tuple[float, float]:
        return mean_interval(float(getattr(record, score)) for record in runs)

    ours = (mean("accuracy"), mean("mean_length"), mean("iterations"))
    return Cell(*key, *ours, accuracy, mean_length, iterations)


PAPER_SCORES = ("accuracy", "mean_length", "iterations")


def paper_tables(results: Results) -> dict[str, Floats]:
    """Each score of the paper, shape (cells, replicates), the cells in the paper's order.

    Raises:
        ValueError: when the results are not those of the whole tournament.
    """
    cells = {key: number for number, key in enumerate(published())}
    config, keys = results.config, _keys(results)
    count = config["replicates"]
    runs = {
        (keys.get(record.entrant), record.replicate): record
        for record in results.records
        if record.finished and config["name"] == "paper" and isinstance(count, int)
    }
    if not runs or runs.keys() != {(key, number) for key in cells for number in range(count)}:
        raise InvalidValueError(
            f"results must be those of the tournament paper, all runs finished, got {results!r}"
        )
    if count < 2:
        raise InvalidValueError("results must have 2 replicates or more, got 1")
    return {
        score: np.array(
            [[getattr(runs[key, replicate], score) for replicate in range(count)] for key in cells],
            dtype=float,
        )
        for score in PAPER_SCORES
    }


def _keys(results: Results) -> dict[str, Key]:
    """By entrant, the cell of the tables that it is."""
    return {e.name: (e.agent, *e.bins) for e in results.entrants.values() if e.bins is not None}


def iterations_spread(iterations: Floats) -> Floats:
    """How far each replicate is from the mean of the others: root mean square over the cells, in percent.

    So far would the paper's Table 2 be from our means if its protocol were ours.

    Args:
        iterations: shape (cells, replicates).
    """
    others = (iterations.sum(axis=1, keepdims=True) - iterations) / (iterations.shape[1] - 1)
    spread: Floats = 100.0 * np.sqrt(np.mean((iterations / others - 1.0) ** 2, axis=0))
    return spread
