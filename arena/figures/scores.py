"""Scores as pictures: intervals and places, who is better than whom, regret by start."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arena.analysis.scores import SCORES, Scores
from arena.analysis.standings import Leaderboard
from arena.figures.style import BETTER, BLUE, LINES, ORANGE, SHARE, make_axes
from arena.results.results import Results
from arena.statistics.permutation import is_significant
from envs.foundation.errors import InvalidValueError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
from arena.analysis.scores import improvement

_LINE = 0.24  # inches an entrant
_READABLE = 40  # entrants up to which a matrix has numbers or marks


def draw_intervals(board: Leaderboard, axes: "Axes | None" = None) -> "Axes":
    """The mean of each entrant with its interval, and the interquartile mean, by place.

    Args:
        board: of any score.
        axes: to draw on; None makes a figure.
    """
    axes = make_axes(axes, 8.0, 1.6 + _LINE * len(board.standings))
    rows = np.arange(len(board.standings))
    means = np.array([standing.scores[board.by] for standing in board.standings]).reshape(-1, 3)
    middles = np.array([standing.interquartile for standing in board.standings]).reshape(-1, 3)
    for estimates, offset, color, marker, label in (
        (means, -0.13, BLUE, "o", "mean, Student's t"),
        (middles, 0.13, ORANGE, "D", "interquartile mean, bootstrap"),
    ):
        value, low, high = estimates.T
        beyond = np.nan_to_num([value - low, high - value])
        style: dict[str, Any] = {"color": color, "marker": marker, "markersize": 4, "linestyle": "none"}
        axes.errorbar(value, rows + offset, xerr=beyond, capsize=2, label=label, **style)
    axes.set_yticks(
        rows, [f"{standing.entrant}  {standing.places}" for standing in board.standings], parse_math=False
    )
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.set_xlabel(SCORES[board.by].description)
    axes.set_title(f"{100.0 * board.confidence:g}% intervals, {board.replicates} replicates; with places")
    axes.grid(axis="x", alpha=0.3)
    axes.figure.legend(loc="outside lower center", ncols=2, frameon=False)
    return axes


def draw_ranks(board: Leaderboard, axes: "Axes | None" = None) -> "Axes":
    """How often each entrant takes each place when the replicates are drawn anew; no confidence."""
    count = len(board.standings)
    axes = make_axes(axes, 3.2 + 1.2 * _LINE * count, 1.6 + _LINE * count)
    shares = np.array([standing.shares for standing in board.standings])
    mesh = axes.pcolormesh(cell_edges(count), cell_edges(count), shares, cmap=SHARE, vmin=0.0, vmax=1.0)
    _name_rows(axes, [standing.entrant for standing in board.standings])
    axes.set_xticks(np.arange(0, count, max(1, count // 10)))
    axes.set_xticklabels([str(place + 1) for place in axes.get_xticks().astype(int)])
    axes.set(xlabel="place", title=f"Places by {board.by}, over bootstrap samples of the replicates")
    axes.figure.colorbar(mesh, ax=axes, label="share of the samples")
    return axes


def draw_pairs(scores: Scores, board: Leaderboard, axes: "Axes | None" = None) -> "Axes":
    """The matrix of ``improvement`` in the order of the places; dots where the two can be told apart."""
    count = len(board.standings)
    axes = make_axes(axes, 4.5 + 1.2 * _LINE * count, 2.6 + _LINE * count)
    names = [standing.entrant for standing in board.standings]
    order = [scores.entrants.index(name) for name in names]
    matrix = improvement(scores, board.by)[np.ix_(order, order)]
    mesh = axes.pcolormesh(cell_edges(count), cell_edges(count), matrix, cmap=BETTER, vmin=0.0, vmax=1.0)
    apart = np.argwhere(is_significant(np.array(board.p_values), 1.0 - board.confidence))
    if count <= _READABLE:
        axes.plot(
            apart[:, 1],
            apart[:, 0],
            "o",
            color="#FFFFFF",
            markersize=3,
            markeredgecolor="#000000",
            markeredgewidth=0.3,
        )
    _name_rows(axes, names)
    axes.set_xticks(np.arange(count), names, rotation=90, parse_math=False)
    axes.set_title(f"By {board.by}: is a run of the row better than one of the column?")
    axes.figure.colorbar(mesh, ax=axes, label="probability (dots: told apart beyond chance)")
    return axes


def draw_regret(
    results: Results,
    entrants: Sequence[str],
    replicate: int,
    starts: ArrayLike,
    fewest: ArrayLike,
    axes: "Axes | None" = None,
) -> "Axes":
    """Steps of each test drive beyond the fewest possible, by where it began.

    Args:
        results: of the tournament.
        entrants: names, at most as many as there are colours.
        replicate: whose test drives.
        starts: positions where they began, shape (episodes,).
        fewest: steps that no drive from there can undercut, shape (episodes,).
        axes: to draw on; None makes a figure.

    Raises:
        ValueError: when there are too many entrants, or one has no such run.
    """
    if len(entrants) > len(LINES):
        raise InvalidValueError(
            f"entrants must be at most {len(LINES)} to be told apart, got {len(entrants)}"
        )
    axes = make_axes(axes, 8.0)
    x, least = np.asarray(starts, float), np.asarray(fewest, float)
    order = np.argsort(x)
    lost = False
    for name, color in zip(entrants, LINES):
        arrays = results.finished_arrays(name, replicate)
        regret = (arrays["test_lengths"] - least)[order]
        reached = arrays["test_reached"][order]
        label = f"{name} (mean {regret.mean():.1f})"
        axes.plot(x[order][reached], regret[reached], ".", color=color, markersize=4, label=label)
        axes.plot(x[order][~reached], regret[~reached], "x", color=color, markersize=5)
        lost |= not reached.all()
    limit = results.conditions.evaluation.max_steps
    remark = f"; crosses: not at the goal in {limit} steps" if lost else ""
    axes.set(
        xlabel="start of the drive (position, units of length)", ylabel="steps beyond the fewest possible"
    )
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    axes.locator_params(axis="x", nbins=6)
    axes.set_title(f"Regret by start, replicate {replicate}{remark}")
    axes.grid(alpha=0.3)
    axes.figure.legend(loc="outside right center", frameon=False, markerscale=2)
    return axes


def cell_edges(count: int) -> NDArray[np.float64]:
    """Of cells whose middles are 0, 1, ..., count - 1."""
    return np.linspace(-0.5, count - 0.5, count + 1)


def _name_rows(axes: "Axes", names: Sequence[str]) -> None:
    axes.set_yticks(np.arange(len(names)), names, parse_math=False)
    axes.set_ylim(len(names) - 0.5, -0.5)
