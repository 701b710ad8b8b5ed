"""Learning curves: the moving average of the training episodes' steps, as in the paper's Figure 4.

The paper (section 4.3) plots "the moving average of each N_m consecutive accumulated rewards", N_m = 50.
The reward is -1 a step, so the accumulated reward of an episode is minus its steps, and a curve of steps
is the paper's turned upside down: it falls as the agent learns.
"""

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arena.results.results import Results
from envs.foundation.checks import choice, integer, number
from envs.foundation.errors import InvalidValueError

if TYPE_CHECKING:
    import pandas as pd

WINDOW = 50


def moving_average(values: ArrayLike, window: int = WINDOW) -> NDArray[np.float64]:
    """Mean of each ``window`` consecutive values; the first is of the first ``window`` of them.

    It has ``window - 1`` values less; none if there are fewer than ``window``.
    """
    series = np.asarray(values, dtype=float)
    window = integer("window", window, 1)
    if len(series) < window:
        return np.empty(0)
    curve: NDArray[np.float64] = np.lib.stride_tricks.sliding_window_view(series, window).mean(axis=1)
    return curve


def area(lengths: ArrayLike, window: int = WINDOW) -> float:
    """Mean height of the curve, in steps: the area under it, over its width; NaN if there is no curve.

    Less is better: learning sooner, and driving well in the end, both lower it.
    """
    curve = moving_average(lengths, window)
    return float(curve.mean()) if len(curve) else math.nan


def settled(lengths: ArrayLike, level: float, window: int = WINDOW) -> int | None:
    """The first episode, counted from 1, from whose end on the curve stays at or below ``level`` steps.

    In rewards: from which the moving average stays at or above ``-level``. None if it does not.
    """
    curve = moving_average(lengths, window)
    above = np.flatnonzero(curve > level)
    first = int(above[-1]) + 1 if len(above) else 0
    return first + window if first < len(curve) else None


def learning_curves(results: Results, level: float, window: int = WINDOW) -> "pd.DataFrame":
    """Entrant, replicate, ``area`` and ``settled`` of each finished run; what is not there is NaN.

    Args:
        results: of a tournament.
        level: steps an episode that ``settled`` is about.
        window: episodes that are averaged.
    """
    import pandas as pd

    level = number("level", level)
    rows = []
    for record in results.records:
        if record.finished:
            lengths = results.arrays(*record.key)["lengths"]
            first = settled(lengths, level, window)
            rows.append(
                {
                    "entrant": record.entrant,
                    "replicate": record.replicate,
                    "area": area(lengths, window),
                    "settled": math.nan if first is None else float(first),
                }
            )
    return pd.DataFrame(rows, columns=["entrant", "replicate", "area", "settled"])


def reward_curves(results: Results, entrant: str, window: int = WINDOW) -> NDArray[np.float64]:
    """Moving averages of the accumulated reward of an episode, one row a finished replicate.

    Shape (replicates, episodes - window + 1); the first column is the mean of the first ``window`` episodes.
    The reward of a step is -1, so the accumulated one is minus the steps; an episode that ends before the
    limit ends at the goal, the last step with the hill's ``goal_reward``.

    Raises:
        ValueError: when there is no such entrant, no replicate of it has finished, or there are fewer
            episodes than ``window``.
    """
    choice("entrant", entrant, results.entrants)
    lengths = [
        results.arrays(*record.key)["lengths"]
        for record in results.records
        if record.entrant == entrant and record.finished
    ]
    if not lengths:
        raise InvalidValueError(f"{entrant!r} has no finished run: there is no learning curve")
    episodes = results.conditions.training.episodes
    if integer("window", window, 1) > episodes:
        raise InvalidValueError(f"window must be at most the {episodes} training episodes, got {window}")
    conditions = results.conditions
    at_the_goal, limit = conditions.hill.goal_reward + 1.0, conditions.training.max_steps
    return np.array([moving_average(at_the_goal * (n < limit) - n, window) for n in lengths])
