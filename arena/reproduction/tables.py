"""The paper's Tables 1 and 2, and ours beside them."""

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from arena.common.npz import Floats
from arena.common.plain import without_nan
from arena.reproduction.goodness import fit
from arena.reproduction.published_values import MINIMUM_ACCURACY, Key, published
from arena.results.results import Results
from arena.statistics.intervals import mean_interval
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
        iterations_chance: what that would be by chance alone, see ``arena.reproduction.Fit``.
        iterations_chi_square: of Table 2, over its cells, likewise.
    """

    cells: tuple[Cell, ...]
    accurate_cells: int
    mean_accuracy: float
    paper_mean_accuracy: float
    iterations_correlation: float
    iterations_difference: float
    iterations_error: float
    iterations_chance: float
    iterations_chi_square: float

    def to_dict(self) -> dict[str, Any]:
        """Plain values, NaN as None."""
        values: dict[str, Any] = without_nan(asdict(self))
        return values


def compare(results: Results) -> Comparison | None:
    """The comparison, if ``results`` are of the tournament ``paper``; else None."""
    if results.config["name"] != "paper":
        return None
    tables = _tables(results)
    rows = zip(published().items(), *(tables[score] for score in PAPER_SCORES), strict=True)
    cells = tuple(Cell(*key, *map(mean_interval, ours), *theirs) for (key, theirs), *ours in rows)
    iterations = fit(tables["iterations"], [cell.paper_iterations for cell in cells])
    return Comparison(
        cells,
        sum(cell.accuracy[0] > MINIMUM_ACCURACY for cell in cells),
        mean_interval(cell.accuracy[0] for cell in cells)[0],
        mean_interval(cell.paper_accuracy for cell in cells)[0],
        iterations.correlation,
        iterations.difference,
        iterations.error,
        iterations.chance,
        iterations.chi_square,
    )


PAPER_SCORES = ("accuracy", "mean_length", "iterations")


def paper_tables(results: Results) -> dict[str, Floats]:
    """Each score of the paper, shape (cells, replicates), the cells in the paper's order.

    Raises:
        ValueError: when the results are not those of the whole tournament.
    """
    config, tables = results.config, _tables(results)
    count = config["replicates"]
    if config["name"] != "paper" or not isinstance(count, int) or np.isnan(tables["iterations"]).any():
        raise InvalidValueError(
            f"results must be those of the tournament paper, all runs finished, got {results!r}"
        )
    if count < 2:
        raise InvalidValueError("results must have 2 replicates or more, got 1")
    return tables


def _tables(results: Results) -> dict[str, Floats]:
    """The same with NaN for each run that is not finished."""
    cells, keys = {key: number for number, key in enumerate(published())}, _keys(results)
    tables = {score: np.full((len(cells), results.max_replicates), math.nan) for score in PAPER_SCORES}
    for record in results.records:
        if record.finished and keys.get(record.entrant) in cells:
            for score, table in tables.items():
                table[cells[keys[record.entrant]], record.replicate] = getattr(record, score)
    return tables


def _keys(results: Results) -> dict[str, Key]:
    """By entrant, the cell of the tables that it is."""
    return {e.name: (e.agent, *e.bins) for e in results.entrants.values() if e.bins is not None}
