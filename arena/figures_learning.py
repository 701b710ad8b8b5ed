"""The paper's Figure 4: the accumulated reward while the agents learn."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from arena.adaptive import ADAPTIVE
from arena.curves import WINDOW, moving_average
from arena.palette import DASHES, LINES, make_axes
from arena.results import Results
from envs.checks import choice, integer

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def reward_curves(results: Results, entrant: str, window: int = WINDOW) -> NDArray[np.float64]:
    """Moving averages of the accumulated reward of an episode, one row a finished replicate.

    Shape (replicates, episodes - window + 1); the first column is the mean of the first ``window`` episodes.
    The reward of a step is -1, so the accumulated one is minus the steps.

    Raises:
        ValueError: when there is no such entrant, no replicate of it has finished, or there are fewer
            episodes than ``window``.
    """
    config = results.config
    choice("entrant", entrant, [one["name"] for one in config["entrants"]])
    most = config["max_replicates"] if config["replicates"] == ADAPTIVE else config["replicates"]
    finished = list(_lengths(results, entrant, range(most)))
    if not finished:
        raise ValueError(f"{entrant!r} has no finished run: there is no learning curve")
    episodes = config["training"]["episodes"]
    if integer("window", window, 1) > episodes:
        raise ValueError(f"window must be at most the {episodes} training episodes, got {window}")
    return np.array([-moving_average(lengths, window) for lengths in finished])


def _lengths(results: Results, entrant: str, replicates: Iterable[int]) -> Iterator[NDArray[np.int64]]:
    """Steps of the training episodes of the finished runs."""
    for replicate in replicates:
        with suppress(KeyError):  # not run yet; one that failed has no arrays
            yield results.arrays(entrant, replicate)["lengths"]


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
        raise ValueError(f"entrants must be at most {len(LINES)} to be told apart, got {len(entrants)}")
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
