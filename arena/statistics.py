"""How sure the means over replicates are."""

import math
from collections.abc import Iterable

import numpy as np


def mean_interval(values: Iterable[float], confidence: float = 0.95) -> tuple[float, float]:
    """Mean and half width of Student's t interval of it; NaN values are left out.

    The replicate is the unit. With fewer than two values the half width is NaN, with none both are.
    """
    from scipy.special import stdtrit

    found = np.asarray([value for value in values if not math.isnan(value)], dtype=float)
    if not len(found):
        return math.nan, math.nan
    mean = float(found.mean())
    if len(found) < 2:
        return mean, math.nan
    error = float(found.std(ddof=1)) / math.sqrt(len(found))
    return mean, float(stdtrit(len(found) - 1, 0.5 + confidence / 2.0)) * error


def correlation(x: Iterable[float], y: Iterable[float]) -> float:
    """Pearson's; NaN where one of them is constant or there are fewer than two pairs."""
    pairs = [(a, b) for a, b in zip(x, y, strict=True) if not (math.isnan(a) or math.isnan(b))]
    columns = np.asarray(pairs, dtype=float).reshape(-1, 2).T
    if columns.shape[1] < 2 or not columns.std(axis=1).all():
        return math.nan
    return float(np.corrcoef(columns)[0, 1])
