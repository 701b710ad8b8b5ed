"""Who is better than whom, and the places that follow: paired permutation tests, Holm's correction, ties.

Everywhere less is better: a matrix of ``costs`` has a row an entrant and a column a replicate. The
replicates of all entrants are paired, because all are tested from the same starts.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from arena.common.npz import Floats

EXACT = 17  # replicates up to which all sign flips are tried
FLIPS = 2 ** (EXACT - 1) - 1  # that are drawn beyond
_CHUNK = 4096


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
    p: Floats = hits / tried if count <= EXACT else (hits + 1.0) / (tried + 1.0)
    return p


def smallest_p(replicates: int, *, one_sided: bool = False) -> float:
    """The smallest that the test can say of so many replicates, however far apart they are."""
    p = 2.0 ** (1 - min(replicates, EXACT)) if replicates else 1.0
    return p / 2.0 if one_sided and 0 < replicates <= EXACT else p


def needed_replicates(comparisons: int, level: float, *, one_sided: bool = False) -> int | None:
    """How many it takes so that so many tests can show a difference at all; None if no number does."""
    for replicates in range(1, EXACT + 1):
        if is_significant(smallest_p(replicates, one_sided=one_sided) * comparisons, level):
            return replicates
    return None


def power_warning(replicates: int, comparisons: int, confidence: float, *, one_sided: bool = False) -> str:
    """Why so many replicates can show nothing, in one sentence; empty if they can."""
    level = 1.0 - confidence
    if is_significant(smallest_p(replicates, one_sided=one_sided) * comparisons, level):
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
    adjusted = np.empty(len(p))
    adjusted[order] = np.minimum(corrected, 1.0)
    return adjusted


def is_significant(p: Any, level: float) -> Any:
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
