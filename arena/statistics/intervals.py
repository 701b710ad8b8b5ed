"""How sure scores over replicates are. The replicate is the unit, never the test episode.

The intervals were chosen by their measured coverage, see ``scripts/measured_coverage.py``.
"""

import math
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

RESAMPLES = 5000  # of a bootstrap: of ten replicates, 59 of them are beyond each end of a 95% interval


class Estimate(NamedTuple):
    """A value and the ends of its interval; NaN where there are too few replicates."""

    value: float
    low: float
    high: float


def mean_interval(values: Iterable[float], confidence: float = 0.95) -> tuple[float, float]:
    """Mean and half width of Student's t interval of it; NaN values are left out.

    The replicate is the unit. With fewer than two values the half width is NaN, with none both are.
    """
    from scipy.special import stdtrit

    known = np.asarray([value for value in values if not math.isnan(value)], dtype=float)
    if not len(known):
        return math.nan, math.nan
    mean = float(known.mean())
    if len(known) < 2:
        return mean, math.nan
    error = float(known.std(ddof=1)) / math.sqrt(len(known))
    return mean, float(stdtrit(len(known) - 1, 0.5 + confidence / 2.0)) * error


def mean_estimate(values: Iterable[float], confidence: float = 0.95) -> Estimate:
    """The same as an estimate with both ends."""
    mean, half = mean_interval(values, confidence)
    return Estimate(mean, mean - half, mean + half)


def correlation(x: Iterable[float], y: Iterable[float]) -> float:
    """Pearson's; NaN where one of them is constant or there are fewer than two pairs."""
    pairs = [(a, b) for a, b in zip(x, y, strict=True) if not (math.isnan(a) or math.isnan(b))]
    columns = np.asarray(pairs, dtype=float).reshape(-1, 2).T
    if columns.shape[1] < 2 or not columns.std(axis=1).all():
        return math.nan
    return float(np.corrcoef(columns)[0, 1])


def interquartile_mean(values: ArrayLike, axis: int = -1) -> NDArray[np.float64]:
    """Mean without the lowest and the highest quarter (Agarwal et al. 2021, "Deep Reinforcement Learning
    at the Edge of the Statistical Precipice"); of n values ``n // 4`` are left out at each end.

    It is ``scipy.stats.trim_mean(values, 0.25)``, without the second that importing that takes.
    """
    ordered = np.sort(np.moveaxis(np.asarray(values, dtype=float), axis, -1), axis=-1)
    count = ordered.shape[-1]
    middle: NDArray[np.float64] = ordered[..., count // 4 : count - count // 4].mean(axis=-1)
    return middle


def bootstrap_interval(
    values: ArrayLike,
    statistic: Callable[..., Any] = interquartile_mean,
    confidence: float = 0.95,
    seed: int = 0,
) -> Estimate:
    """The statistic and its percentile bootstrap interval, widened as Student's t is wider than the normal.

    Replicates are drawn with replacement: those of one hill are one stratum of Agarwal et al.'s
    stratified bootstrap. The tails that are cut off are not 2.5% each but what the normal distribution
    has beyond Student's quantile (Hesterberg 2015, "What Teachers Should Know About the Bootstrap",
    without his factor for the mean): with few replicates the plain percentiles, and BCa,
    cover too little. No interval goes beyond the values: with fewer than five all cover too little.

    Args:
        values: one a replicate.
        statistic: of the last axis, which it takes as ``axis``.
        confidence: of the interval.
        seed: of the resampling.
    """
    from scipy.special import ndtr, stdtrit

    sample = np.asarray(values, dtype=float)
    if not len(sample):
        return Estimate(math.nan, math.nan, math.nan)
    value = float(statistic(sample, axis=-1))
    if len(sample) < 2:
        return Estimate(value, math.nan, math.nan)
    drawn = np.random.default_rng(seed).integers(len(sample), size=(RESAMPLES, len(sample)))
    tail = float(ndtr(-stdtrit(len(sample) - 1, 0.5 + confidence / 2.0)))
    low, high = np.quantile(statistic(sample[drawn], axis=-1), [tail, 1.0 - tail])
    return Estimate(value, float(low), float(high))


def probability_of_improvement(x: ArrayLike, y: ArrayLike, confidence: float = 0.95) -> Estimate:
    """How likely a value of ``x`` is greater than one of ``y``; one that is equal counts half.

    That is Mann and Whitney's U over the number of pairs, as in Agarwal et al. (2021). The interval is
    method 5 of Newcombe (2006, "Confidence intervals for an effect size measure based on the
    Mann-Whitney statistic, part 2"), made for independent samples. Agarwal et al. take a bootstrap,
    which with ten replicates covers 51% in place of 95% when the true value is 0.98.
    """
    from scipy.special import ndtri

    first, second = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    if not len(first) or not len(second):
        return Estimate(math.nan, math.nan, math.nan)
    signs = np.sign(first[:, None] - second[None, :])
    value = float(0.5 + 0.5 * signs.mean())
    z = float(ndtri(0.5 + confidence / 2.0))
    pairs, extra = len(first) * len(second), (len(first) + len(second)) / 2.0 - 1.0

    def beyond(theta: float) -> bool:
        """Whether ``theta`` is so far from the value that it is outside the interval."""
        spread = 1.0 + extra * ((1.0 - theta) / (2.0 - theta) + theta / (1.0 + theta))
        return abs(theta - value) > z * math.sqrt(theta * (1.0 - theta) * spread / pairs)

    return Estimate(value, _border(beyond, value, 0.0), _border(beyond, value, 1.0))


def _border(beyond: Callable[[float], bool], inside: float, outside: float) -> float:
    """Where ``beyond`` changes between the two, by bisection."""
    if inside == outside:
        return inside
    for _ in range(60):
        middle = (inside + outside) / 2.0
        inside, outside = (inside, middle) if beyond(middle) else (middle, outside)
    return (inside + outside) / 2.0
