"""As many replicates as it takes: ``replicates = "adaptive"``.

Replicates are added five at a time. At each look the places are tested as always, paired permutation tests
with Holm's correction, but at a part of the level: Lan and DeMets (1983, "Discrete sequential boundaries for
clinical trials") spend the error over the looks by a function of the share of the budget that is used; here
it is the one that approximates Pocock's boundaries, ``level * log(1 + (e - 1) * share)``. The looks' parts
add up to the whole, so by the union bound the chance of any false difference, at any look and in any pair, is
at most the whole. That needs no joint distribution of the looks, which permutation tests of many pairs do not
offer, and costs some power against boundaries that make use of it.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from arena.statistics.permutation import smallest_p
from arena.statistics.ranks import tie_groups

ADAPTIVE = "adaptive"
BATCH = 5
MAX_REPLICATES = 10_000


class Look(NamedTuple):
    """After how many replicates the places are tested, and at which level."""

    replicates: int
    level: float


def looks(entrants: int, max_replicates: int, confidence: float) -> list[Look]:
    """When the places of so many entrants are tested, and at which levels; none if that can show nothing.

    A look whose level no data could reach is left out; what it would have spent is left for the next.

    Args:
        entrants: how many race.
        max_replicates: at which the tournament ends in any case.
        confidence: 1 - the error that all looks may spend together.
    """
    comparisons = max(1, entrants * (entrants - 1) // 2)
    all_looks: list[Look] = []
    spent = 0.0
    for replicates in [*range(BATCH, max_replicates, BATCH), max_replicates]:
        level = (1.0 - confidence) * math.log1p((math.e - 1.0) * replicates / max_replicates) - spent
        if comparisons * smallest_p(replicates) <= level:
            all_looks.append(Look(replicates, level))
            spent += level
    return all_looks


def decided(costs: ArrayLike, look: Look, leaders: int = 1) -> bool:
    """Whether the first ``leaders`` entrants, by their means, are each told apart from all others.

    Args:
        costs: less is better; a row an entrant, a column a replicate. Those of the look are counted.
        look: when and at which level.
        leaders: how many places have to be decided.
    """
    values = np.asarray(costs, dtype=float)[:, : look.replicates]
    ties = tie_groups(values, 1.0 - look.level)
    first = np.argsort(values.mean(axis=1), kind="stable")[:leaders]
    apart = ties.better | ties.better.T
    return bool((apart[first].sum(axis=1) == len(values) - 1).all())


def look_at(replicates: int, entrants: int, max_replicates: int, confidence: float) -> Look | None:
    """The look of an adaptive tournament after so many replicates, if there is one.

    Args:
        replicates: that have been run.
        entrants: how many race.
        max_replicates: at which the tournament ends in any case.
        confidence: 1 - the error that all looks may spend together.
    """
    all_looks = looks(entrants, max_replicates, confidence)
    return next((look for look in all_looks if look.replicates == replicates), None)
