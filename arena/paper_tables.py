"""The numbers of Tables 1 and 2, a value a cell and replicate, from results of the tournament ``paper``."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena.comparison import Key, published
from arena.results import Results

SCORES = ("accuracy", "mean_length", "iterations")
Floats = NDArray[np.float64]


def paper_tables(results: Results) -> dict[str, Floats]:
    """Each score of the paper, shape (cells, replicates), the cells in the paper's order.

    Raises:
        ValueError: when the results are not those of the whole tournament.
    """
    cells = {key: number for number, key in enumerate(published())}
    count = results.config["replicates"]
    named = results.config["name"] == "paper" and isinstance(count, int)
    finished = [run for run in results.runs if run["status"] == "finished"] if named else []
    runs = {(_key(run), run["replicate"]): run for run in finished}
    if not runs or runs.keys() != {(key, number) for key in cells for number in range(count)}:
        raise ValueError(f"results must be those of the tournament paper, all runs finished, got {results!r}")
    if count < 2:
        raise ValueError("results must have 2 replicates or more, got 1")
    found = {score: np.full((len(cells), count), math.nan) for score in SCORES}
    for (key, replicate), run in runs.items():
        for score in SCORES:
            found[score][cells[key], replicate] = math.nan if run[score] is None else run[score]
    return found


def _key(run: dict[str, Any]) -> Key:
    bins = run["parameters"].get("bins")
    n_p, n_v = bins if isinstance(bins, list) and len(bins) == 2 else (0, 0)
    return run["agent"], n_p, n_v


def iterations_spread(iterations: Floats) -> Floats:
    """How far each replicate is from the mean of the others: root mean square over the cells, in percent.

    So far would the paper's Table 2 be from our means if its protocol were ours.

    Args:
        iterations: shape (cells, replicates).
    """
    others = (iterations.sum(axis=1, keepdims=True) - iterations) / (iterations.shape[1] - 1)
    spread: Floats = 100.0 * np.sqrt(np.mean((iterations / others - 1.0) ** 2, axis=0))
    return spread
