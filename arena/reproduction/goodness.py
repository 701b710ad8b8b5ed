"""How near a table of the paper is to ours, and how near it would be if its protocol were ours."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from arena.common.npz import Floats
from arena.statistics.intervals import correlation, mean_interval

_NOTHING = 1e-9  # as much may rounding make of the deviation of equal numbers


@dataclass(frozen=True)
class Fit:
    """Our means over the replicates beside the paper's numbers.

    Attributes:
        correlation: over the cells.
        difference: mean relative difference of ours, in percent.
        error: root mean square of the relative differences, in percent.
        chance: the error that one of our replicates has beside the mean of the others, in percent: so far
            would the paper be if its protocol were ours. NaN for one replicate, or while runs are missing.
        chi_square: of the paper's numbers, over the number of cells, see ``chi_square``; likewise.
    """

    correlation: float
    difference: float
    error: float
    chance: float
    chi_square: float


def fit(ours: Floats, theirs: ArrayLike) -> Fit:
    """The fit of a table.

    Args:
        ours: shape (cells, replicates); NaN for a run that is not finished.
        theirs: the paper's, shape (cells,).
    """
    paper, known = np.asarray(theirs, float), ~np.isnan(ours).all(axis=1)
    means = np.where(known, _means(ours)[:, 0], math.nan)
    ratios = 100.0 * (means / paper - 1.0)[known]
    whole = ours.shape[1] > 1 and not np.isnan(ours).any()
    return Fit(
        correlation(means, paper),
        mean_interval(ratios)[0],
        math.sqrt(mean_interval(ratios**2)[0]),
        float(iterations_spread(ours).mean()) if whole else math.nan,
        chi_square(ours, paper) if whole else math.nan,
    )


def iterations_spread(iterations: Floats) -> Floats:
    """How far each replicate is from the mean of the others: root mean square over the cells, in percent.

    So far would the paper's Table 2 be from our means if its protocol were ours.

    Args:
        iterations: shape (cells, replicates), two replicates or more.
    """
    ratios = iterations / _means_of_the_others(iterations)
    spread: Floats = 100.0 * np.sqrt(np.mean((ratios - 1.0) ** 2, axis=0))
    return spread


def chi_square(ours: Floats, theirs: ArrayLike) -> float:
    """The mean square, over the cells, of the paper's distance from our mean in standard deviations.

    About 1 if the paper's numbers are those of one more replicate. Cells that have the same number in all
    replicates, or in less than two have one, say nothing by this measure; NaN if there are no others.

    Args:
        ours: shape (cells, replicates), two replicates or more.
        theirs: the paper's, shape (cells,).
    """
    return float(_mean_square(np.asarray(theirs, float)[:, None] - _means(ours), ours)[0])


def chi_square_spread(ours: Floats) -> Floats:
    """The same of each replicate beside the mean of the others, shape (replicates,)."""
    return _mean_square(ours - _means_of_the_others(ours), ours)


def _mean_square(distances: Floats, ours: Floats) -> Floats:
    """Over the cells, in standard deviations."""
    several = (~np.isnan(ours)).sum(axis=1) > 1
    deviations = np.nanstd(ours[several], axis=1, ddof=1, keepdims=True)
    differ = deviations[:, 0] > _NOTHING
    if not differ.any():
        return np.full(distances.shape[1], math.nan)
    square: Floats = np.nanmean((distances[several][differ] / deviations[differ]) ** 2, axis=0)
    return square


def _means(ours: Floats) -> Floats:
    known = np.maximum((~np.isnan(ours)).sum(axis=1, keepdims=True), 1)
    means: Floats = np.nansum(ours, axis=1, keepdims=True) / known
    return means


def _means_of_the_others(ours: Floats) -> Floats:
    known = ~np.isnan(ours)
    others = np.maximum(known.sum(axis=1, keepdims=True) - known, 1)
    means: Floats = (np.nansum(ours, axis=1, keepdims=True) - np.nan_to_num(ours)) / others
    return means
