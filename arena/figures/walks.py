"""The paper's Figures 1 and 2: the hill, and how long random walks are."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from arena.figures.style import BLACK, BLUE, DASHES, LINES, RED, SKY
from arena.reproduction.published_values import PAPER
from arena.reproduction.walk_study import WalkStudy
from arena.walks.distributions import Fit
from envs import Hill

if TYPE_CHECKING:
    from matplotlib.axes import Axes


BINS = 80
"""Of the paper's histogram."""


def draw_hill(axes: "Axes", hill: Hill = Hill()) -> "Axes":  # noqa: B008 (immutable)
    """The hill with a car at rest, the range of starts and the goal (paper, Figure 1).

    Args:
        axes: to draw on.
        hill: what is drawn.

    Returns:
        ``axes``.
    """
    x = np.linspace(hill.min_position, hill.max_position, 400)
    height = np.vectorize(hill.height)
    axes.plot(x, height(x), color=BLACK, label=f"y = sin {hill.omega:g}x")
    starts = np.linspace(hill.min_start, hill.max_start, 20)
    axes.plot(starts, height(starts), color=SKY, linewidth=6, alpha=0.7, zorder=1, label="starts")
    centre = 0.5 * (hill.min_start + hill.max_start)
    axes.plot(centre, hill.height(centre), "o", color=BLUE, markersize=9, label="car")
    goal = (hill.goal_position, hill.height(hill.goal_position))
    axes.plot(*goal, marker="^", color=RED, markersize=10, linestyle="none", label="goal")
    axes.axvline(hill.goal_position, color=RED, linestyle=":", linewidth=1)
    axes.set(xlabel="position x (units of length)", ylabel="height y (units of length)", title="The hill")
    axes.legend(loc="best", frameon=False)
    return axes


def draw_lengths(axes: "Axes", lengths: ArrayLike, fits: Sequence[Fit] = (), bins: int = BINS) -> "Axes":
    """A histogram of the lengths, with the densities fitted to them (paper, Figure 2).

    Args:
        axes: to draw on.
        lengths: in steps, shape (episodes,).
        fits: whose densities are drawn, as expected episodes a bin.
        bins: of equal width, from the least length to the greatest.

    Returns:
        ``axes``.
    """
    values = np.asarray(lengths, np.float64)
    _, edges, _ = axes.hist(values, bins, color="0.8", label=f"{len(values):,} episodes")
    width = edges[1] - edges[0]
    x = np.linspace(edges[0], edges[-1], 1000)[1:]  # a density may be infinite at its lower end
    for fit, color, dashes in zip(fits, LINES, DASHES):
        density = fit.family.law.pdf(x, *fit.parameters)
        axes.plot(x, len(values) * width * density, color=color, linestyle=dashes, label=fit.family.name)
    axes.set(xlabel="length of the episode (steps)", ylabel=f"episodes per bin of {width:,.0f} steps")
    axes.set_title("Lengths of random walks")
    axes.legend(frameon=False)
    return axes


def save_figure(study: WalkStudy, path: Path) -> None:
    """Both figures side by side, into a file whose suffix says which kind.

    Raises:
        OSError, ValueError: when it cannot be written.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12, 4.5), layout="constrained")
    left, right = figure.subplots(1, 2)
    draw_hill(left, study.walks[0].hill)
    draw_lengths(right, study.walks[0].lengths, study.fits)
    if study.on_the_papers_hill:
        right.axvline(PAPER.mean, color=BLACK, linewidth=1, linestyle=":", label="mean, the paper's")
        right.legend(frameon=False)
    figure.savefig(path, dpi=150)
