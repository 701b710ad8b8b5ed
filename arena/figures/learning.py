"""The paper's Figure 4: the accumulated reward while the agents learn."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from arena.analysis.curves import WINDOW, reward_curves
from arena.figures.style import DASHES, LINES, make_axes
from arena.results.results import Results
from envs.foundation.errors import InvalidValueError

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_learning(
    results: Results, entrants: Sequence[str], axes: "Axes | None" = None, window: int = WINDOW
) -> "Axes":
    """The curve of each entrant: the mean over its replicates, and a band from the least to the greatest.

    Args:
        results: of the tournament.
        entrants: names, at most as many as there are colours.
        axes: to draw on; None makes a figure.
        window: episodes that are averaged, the paper's N_m.

    Raises:
        ValueError: when there are too many entrants, or one has no curve.
    """
    if len(entrants) > len(LINES):
        raise InvalidValueError(
            f"entrants must be at most {len(LINES)} to be told apart, got {len(entrants)}"
        )
    curves = {name: reward_curves(results, name, window) for name in entrants}
    axes = make_axes(axes)
    for (name, curve), color, dashes in zip(curves.items(), LINES, DASHES):
        episodes = np.arange(window, window + curve.shape[1])
        count = f"{len(curve)} replicate{'s' * (len(curve) != 1)}"
        axes.plot(episodes, curve.mean(axis=0), color=color, linestyle=dashes, label=f"{name} ({count})")
        if len(curve) > 1:
            axes.fill_between(
                episodes, curve.min(axis=0), curve.max(axis=0), color=color, alpha=0.2, linewidth=0
            )
    axes.set(xlabel="episode of training", ylabel=f"accumulated reward\n(mean of {window} episodes)")
    axes.set_title("Learning: mean of the replicates, and the band that they fill")
    axes.legend(loc="lower right", frameon=False)
    axes.grid(alpha=0.3)
    return axes
