"""Places that entrants share who cannot be told apart, and how sure each place is."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arena.common.npz import Floats
from arena.statistics.intervals import RESAMPLES
from arena.statistics.permutation import holm, is_significant, sign_flip_test


def rank_distribution(costs: ArrayLike, seed: int = 0) -> Floats:
    """How often each entrant (row) takes each place (column), over bootstrap samples of the replicates.

    The replicates are drawn for all entrants together, because they are paired. Entrants with equal means
    share the places that they take.
    """
    values = np.asarray(costs, dtype=float)
    entrants, count = values.shape
    drawn = np.random.default_rng(seed).integers(count, size=(RESAMPLES, count))
    means = np.stack([row[drawn].mean(axis=1) for row in values])
    order = np.argsort(means, axis=0, kind="stable")
    ordered = np.take_along_axis(means, order, axis=0)
    first, last = _runs(ordered)
    share = 1.0 / (last - first + 1)  # of each place from the first to the last of its equals
    changes = np.zeros(entrants * (entrants + 1))
    for place, sign in ((first, 1.0), (last + 1, -1.0)):
        changes += sign * np.bincount((order * (entrants + 1) + place).ravel(), share.ravel(), len(changes))
    taken = changes.reshape(entrants, entrants + 1)[:, :-1].cumsum(axis=1)
    shares: Floats = np.round(taken / RESAMPLES, 12) + 0.0  # what rounding left of nothing is nothing
    return shares


def _runs(ordered: Floats) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """For each value of ascending columns, the first and the last row of its equals."""
    rows = np.arange(len(ordered))[:, None]
    changes = ordered[1:] != ordered[:-1]
    begins = np.vstack([np.ones((1, ordered.shape[1]), np.bool_), changes])
    ends = np.vstack([changes, np.ones((1, ordered.shape[1]), np.bool_)])
    first = np.maximum.accumulate(np.where(begins, rows, 0), axis=0)
    last = np.minimum.accumulate(np.where(ends, rows, len(ordered))[::-1], axis=0)[::-1]
    return first, last


@dataclass(frozen=True)
class Ties:
    """Who can be told apart.

    Attributes:
        p_values: of each pair, corrected by Holm; 1 on the diagonal.
        better: whether the row's entrant is better than the column's beyond chance.
        first: 1 + how many are better than this one beyond chance: its place, which those that cannot be
            told apart share.
        last: how many there are, less those that are worse beyond chance. With the asked confidence all
            the true places are within their ``first`` and ``last`` (Mogstad, Romano, Shaikh and Wilhelm
            2024, "Inference for Ranks").
    """

    p_values: Floats
    better: NDArray[np.bool_]
    first: NDArray[np.int64]
    last: NDArray[np.int64]


def tie_groups(costs: ArrayLike, confidence: float = 0.95, seed: int = 0) -> Ties:
    """Places so that entrants which cannot be told apart share one.

    Each pair's paired permutation test, all corrected by Holm at the level ``1 - confidence``.
    """
    values = np.asarray(costs, dtype=float)
    entrants, count = values.shape
    above = np.triu_indices(entrants, 1)
    p_values = np.ones((entrants, entrants))
    if count:
        p_values[above] = holm(sign_flip_test(values[above[0]] - values[above[1]], seed=seed))
    p_values = np.minimum(p_values, p_values.T)
    means = values.mean(axis=1) if count else np.zeros(entrants)
    apart = is_significant(p_values, 1.0 - confidence)
    better = apart & (means[:, None] < means[None, :])
    return Ties(p_values, better, 1 + better.sum(axis=0), entrants - better.sum(axis=1))
