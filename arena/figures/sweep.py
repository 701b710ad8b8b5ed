"""The paper's tables as maps: scores over the numbers of cells of position and velocity."""

import json
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from arena.analysis.scores import SCORES, Scores
from arena.figures.scores import cell_edges
from arena.figures.style import AMOUNT
from arena.results.results import Results
from envs.foundation.errors import InvalidValueError

if TYPE_CHECKING:
    from matplotlib.figure import Figure


SWEPT = ("accuracy", "length", "iterations")

Sweep = Mapping[str, Mapping[tuple[int, int], str]]
"""By a title, the entrant on each grid of n_p x n_v cells."""


def find_sweep(results: Results) -> Sweep:
    """The entrants that differ in nothing but their grids; the title is their agent.

    Raises:
        ValueError: when there are none on two grids.
    """
    groups: dict[str, dict[tuple[int, int], str]] = {}
    for entrant in results.entrants.values():
        others = {name: value for name, value in entrant.parameters.items() if name != "bins"}
        if entrant.bins is not None:
            key = json.dumps([entrant.agent, others], sort_keys=True)
            groups.setdefault(key, {})[entrant.bins] = entrant.name
    swept: dict[str, dict[tuple[int, int], str]] = {}
    for key, grids in groups.items():
        if len(grids) > 1:
            agent = json.loads(key)[0]
            swept[f"{agent}, as {next(iter(grids.values()))}" if agent in swept else agent] = grids
    if not swept:
        raise InvalidValueError("a sweep must have entrants that differ in nothing but their grids, got none")
    return swept


def draw_sweep(results: Results, scores: Scores, figure: "Figure | None" = None) -> "Figure":
    """Mean accuracy, length and iterations over n_p x n_v, a row of maps an agent, scales shared.

    Raises:
        ValueError: when there is no sweep of grids.
    """
    from matplotlib import figure as figures

    swept = find_sweep(results)
    figure = figure or figures.Figure(figsize=(12.0, 0.8 + 3.2 * len(swept)), layout="constrained")
    panels = figure.subplots(len(swept), len(SWEPT), squeeze=False)
    for column, by in zip(panels.T, SWEPT):
        grids = {agent: _grid(entrants, scores, by) for agent, entrants in swept.items()}
        low = min(float(np.nanmin(grid)) for _, _, grid in grids.values())
        high = max(float(np.nanmax(grid)) for _, _, grid in grids.values())
        for axes, (agent, (n_p, n_v, grid)) in zip(column, grids.items()):
            mesh = axes.pcolormesh(
                cell_edges(len(n_v)), cell_edges(len(n_p)), grid, cmap=AMOUNT, vmin=low, vmax=high
            )
            axes.set_xticks(range(len(n_v)), [str(n) for n in n_v])
            axes.set_yticks(range(len(n_p)), [str(n) for n in n_p])
            axes.invert_yaxis()
            axes.set(title=f"{agent}: {by}", xlabel="n_v, cells of velocity", ylabel="n_p, cells of position")
            for (i, j), value in np.ndenumerate(grid):
                light = high > low and (value - low) / (high - low) > 0.5
                if not math.isnan(value):
                    text = f"{value:,.{SCORES[by].decimals}f}"
                    axes.text(j, i, text, ha="center", va="center", color="black" if light else "white")
        figure.colorbar(mesh, ax=list(column), location="bottom", label=SCORES[by].description)
    return figure


def _grid(
    entrants: Mapping[tuple[int, int], str], scores: Scores, by: str
) -> tuple[list[int], list[int], NDArray[np.float64]]:
    """The numbers of cells along both, and the mean score over the replicates; NaN where there is none."""
    n_p, n_v = (sorted({bins[d] for bins in entrants}) for d in (0, 1))
    means = dict(zip(scores.entrants, scores.values[by].mean(axis=1)))
    grid = np.array([[means.get(entrants.get((p, v), ""), math.nan) for v in n_v] for p in n_p])
    return n_p, n_v, grid
