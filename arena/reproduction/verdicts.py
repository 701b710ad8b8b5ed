"""A claim of the paper beside the distribution of what we measured, and the verdict."""

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from arena.common.npz import Floats
from arena.common.plain import without_nan

REPRODUCED, NOT_REPRODUCED, NOT_TESTABLE = "reproduced", "not reproduced", "not testable"
CENTRAL = 95.0  # percent of our replicates that a number must be among to be reproduced


@dataclass(frozen=True)
class Claim:
    """One quantitative claim.

    Attributes:
        section: of the paper.
        statement: what is claimed.
        paper: the paper's number; NaN if it gives none.
        ours: mean over our replicates; NaN if we have none.
        low, high: the central 95% of our replicates; NaN if there is no distribution.
        percentile: of the paper's number among our replicates; NaN where that says nothing.
        verdict: ``"reproduced"``, ``"not reproduced"`` or ``"not testable"``.
        note: why, where the numbers do not say it.
    """

    section: str
    statement: str
    paper: float
    ours: float
    low: float
    high: float
    percentile: float
    verdict: str
    note: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Plain values, NaN as None."""
        plain_claim: dict[str, Any] = without_nan(asdict(self))
        return plain_claim


def number_claim(section: str, statement: str, paper: float, sample: ArrayLike, note: str = "") -> Claim:
    """A number: reproduced if it is among the central 95% of ours, as one more replicate would be."""
    known = _known(sample)
    if not len(known):
        return untestable_claim(section, statement, paper, known, "none of our replicates has such a number")
    low, high = _central(known)
    verdict = REPRODUCED if low <= paper <= high else NOT_REPRODUCED
    ours, percentile = float(known.mean()), _percentile(paper, known)
    return Claim(section, statement, paper, ours, low, high, percentile, verdict, note)


def distance_claim(section: str, statement: str, paper: float, sample: ArrayLike, note: str) -> Claim:
    """How far the paper is from us: reproduced if 95% of our replicates are not all nearer to the others."""
    known = _known(sample)
    if math.isnan(paper) or not len(known):
        return untestable_claim(section, statement, paper, known, "all our replicates have the same numbers")
    farthest = float(np.percentile(known, CENTRAL))
    verdict = REPRODUCED if paper <= farthest else NOT_REPRODUCED
    ours, percentile = float(known.mean()), _percentile(paper, known)
    return Claim(section, statement, paper, ours, 0.0, farthest, percentile, verdict, note)


def holds_claim(section: str, statement: str, sample: ArrayLike, note: str = "") -> Claim:
    """That something is so: reproduced if it is in 95% of the replicates. Ours is that share, in percent."""
    share = 100.0 * float(np.mean(np.asarray(sample, dtype=bool)))
    verdict = REPRODUCED if share >= CENTRAL else NOT_REPRODUCED
    note = "; ".join(part for part in ("ours: percent of the replicates in which it is so", note) if part)
    return Claim(section, statement, math.nan, share, math.nan, math.nan, math.nan, verdict, note)


def measured_claim(
    section: str, statement: str, paper: float, sample: ArrayLike, *, reproduced: bool, note: str
) -> Claim:
    """One that is decided by a test, which the note names."""
    verdict = REPRODUCED if reproduced else NOT_REPRODUCED
    return Claim(section, statement, paper, *_estimates(sample), math.nan, verdict, note)


def untestable_claim(section: str, statement: str, paper: float, sample: ArrayLike, why: str) -> Claim:
    """One that nothing we have can decide; ``sample`` is what we measured all the same, it may be empty."""
    return Claim(section, statement, paper, *_estimates(sample), math.nan, NOT_TESTABLE, why)


def _estimates(sample: ArrayLike) -> tuple[float, float, float]:
    known = _known(sample)
    return (float(known.mean()), *_central(known)) if len(known) else (math.nan, math.nan, math.nan)


def _known(sample: ArrayLike) -> Floats:
    values: Floats = np.asarray(sample, dtype=float)
    return values[~np.isnan(values)]


def _percentile(paper: float, known: Floats) -> float:
    """The share of ours below the paper's number, in percent; equal ones count half."""
    return float(100.0 * (np.mean(known < paper) + np.mean(known == paper) / 2.0))


def _central(known: Floats) -> tuple[float, float]:
    tail = (100.0 - CENTRAL) / 2.0
    low, high = np.percentile(known, (tail, 100.0 - tail))
    return float(low), float(high)
