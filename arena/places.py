"""Who is better than whom, and the places that follow: paired permutation tests, Holm's correction, ties.

Everywhere less is better: a matrix of ``costs`` has a row an entrant and a column a replicate. The
replicates of all entrants are paired, because all are tested from the same starts.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arena.statistics import RESAMPLES

EXACT = 17  # replicates up to which all sign flips are tried
FLIPS = 2 ** (EXACT - 1) - 1  # that are drawn beyond
_CHUNK = 4096
Floats = NDArray[np.float64]


def paired_permutation_test(x: ArrayLike, y: ArrayLike, *, one_sided: bool = False, seed: int = 0) -> float:
    """How likely chance alone puts the means of paired values as far apart as they are.

    If a replicate's two values may as well be exchanged, its difference may as well have the other sign
    (Fisher 1935, "The Design of Experiments", section 21). All flips are counted where there are not too
    many, else ``FLIPS`` at random, with the observed one among them (Phipson and Smyth 2010), so that the
    rate of false positives is never above the level.

    Args:
        x: values, one a replicate.
        y: values of the same replicates.
        one_sided: only whether ``x`` is the greater.
        seed: of the random flips.
    """
    differences = np.asarray(x, dtype=float) - np.asarray(y, dtype=float)
    return float(sign_flip_test(differences[None, :], one_sided=one_sided, seed=seed)[0])


def sign_flip_test(differences: ArrayLike, *, one_sided: bool = False, seed: int = 0) -> Floats:
    """The same for each row of differences, all with the same flips."""
    rows = np.asarray(differences, dtype=float)
    count = rows.shape[1]
    observed, tolerance = rows.sum(axis=1), 1e-12 * np.abs(rows).sum(axis=1)
    hits = np.zeros(len(rows))
    tried = 0
    for signs in _flips(count, seed):
        sums = signs @ rows.T
        if one_sided:
            hits += (sums >= observed - tolerance).sum(axis=0)
            if count <= EXACT:  # the other half of the flips is this one turned
                hits += (-sums >= observed - tolerance).sum(axis=0)
                tried += len(signs)
        else:
            hits += (np.abs(sums) >= np.abs(observed) - tolerance).sum(axis=0)
        tried += len(signs)
    found: Floats = hits / tried if count <= EXACT else (hits + 1.0) / (tried + 1.0)
    return found


def smallest_p(replicates: int, *, one_sided: bool = False) -> float:
    """The smallest that the test can say of so many replicates, however far apart they are."""
    p = 2.0 ** (1 - min(replicates, EXACT)) if replicates else 1.0
    return p / 2.0 if one_sided and 0 < replicates <= EXACT else p


def needed_replicates(comparisons: int, level: float, *, one_sided: bool = False) -> int | None:
    """How many it takes so that so many tests can show a difference at all; None if no number does."""
    for replicates in range(1, EXACT + 1):
        if at_most(smallest_p(replicates, one_sided=one_sided) * comparisons, level):
            return replicates
    return None


def too_few(replicates: int, comparisons: int, confidence: float, *, one_sided: bool = False) -> str:
    """Why so many replicates can show nothing, in one sentence; empty if they can."""
    level = 1.0 - confidence
    if at_most(smallest_p(replicates, one_sided=one_sided) * comparisons, level):
        return ""
    needed = needed_replicates(comparisons, level, one_sided=one_sided)
    return (
        f"With {replicates} replicate{'s' * (replicates != 1)} no difference can be shown at "
        f"{100.0 * confidence:g}% confidence in {comparisons} comparison{'s' * (comparisons != 1)}: "
        + ("no number of them is enough." if needed is None else f"{needed} or more are needed.")
    )


def holm(p_values: ArrayLike) -> Floats:
    """The p-values corrected for their number (Holm 1979): rejecting those of at most 5% rejects one that
    is true in 5% of the cases at most, whatever their dependence.
    """
    p = np.asarray(p_values, dtype=float)
    order = np.argsort(p, kind="stable")
    corrected = np.maximum.accumulate(p[order] * np.arange(len(p), 0, -1))
    found = np.empty(len(p))
    found[order] = np.minimum(corrected, 1.0)
    return found


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
    found: Floats = np.round(taken / RESAMPLES, 12) + 0.0  # what rounding left of nothing is nothing
    return found


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
    apart = at_most(p_values, 1.0 - confidence)
    better = apart & (means[:, None] < means[None, :])
    return Ties(p_values, better, 1 + better.sum(axis=0), entrants - better.sum(axis=1))


def at_most(p: Any, level: float) -> Any:
    """Whether ``p``, a number or an array, is within the level; 1 - 0.95 is a little more than 0.05."""
    return p <= level * (1.0 + 1e-9)


def _flips(count: int, seed: int) -> Iterator[Floats]:
    """Rows of signs, in parts: all whose last is +1, or as many as ``FLIPS`` at random."""
    if count <= EXACT:
        total = 2 ** max(count - 1, 0)
        bits = np.arange(count)
        for start in range(0, total, _CHUNK):
            numbers = np.arange(start, min(start + _CHUNK, total))
            yield np.where((numbers[:, None] >> bits) & 1, -1.0, 1.0)
        return
    rng = np.random.default_rng(seed)
    for start in range(0, FLIPS, _CHUNK):
        yield np.where(rng.integers(2, size=(min(_CHUNK, FLIPS - start), count)), -1.0, 1.0)
