"""The leaderboard: places that entrants share who cannot be told apart, scores, and how sure they are."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from arena.analysis.scores import Scores, scores_of
from arena.results.results import Results
from arena.statistics.intervals import Estimate, bootstrap_interval, mean_estimate
from arena.statistics.permutation import power_warning
from arena.statistics.ranks import rank_distribution, tie_groups
from arena.statistics.sequential import ADAPTIVE, decided, look_at
from envs.foundation.checks import number
from envs.foundation.errors import InvalidValueError

if TYPE_CHECKING:
    import pandas as pd
from arena.common.plain import as_plain

_USUAL = ("steps", "accuracy", "length", "iterations")
_BESIDE = {"regret": ("regret_median", "regret_90", "accuracy", "iterations")}


@dataclass(frozen=True)
class Standing:
    """One entrant's line.

    Attributes:
        place: 1 + how many are better beyond chance; those that cannot be told apart share it.
        last_place: how many entrants there are, less those that are worse beyond chance.
        entrant: its name.
        scores: mean of each score over the replicates, and Student's t interval.
        interquartile: interquartile mean of the score that decides, and its bootstrap interval.
        shares: how often it takes each place when the replicates are drawn anew.
        tied: names of those that it cannot be told apart from.
        failed: runs that failed.
    """

    place: int
    last_place: int
    entrant: str
    scores: dict[str, Estimate]
    interquartile: Estimate
    shares: tuple[float, ...]
    tied: tuple[str, ...]
    failed: int

    @property
    def places(self) -> str:
        """The places that chance leaves it, such as ``2-4``."""
        return f"{self.place}" if self.place == self.last_place else f"{self.place}-{self.last_place}"


@dataclass(frozen=True)
class Leaderboard:
    """Who is best by one score.

    Attributes:
        by: the score.
        confidence: of the intervals and the places.
        replicates: that count: those that all entrants have run.
        standings: by place, then by mean.
        p_values: of all pairs in the order of the standings, corrected by Holm.
        remarks: what a reader has to know of the places, sentences.
    """

    by: str
    confidence: float
    replicates: int
    standings: tuple[Standing, ...]
    p_values: tuple[tuple[float, ...], ...]
    remarks: tuple[str, ...]

    @property
    def shown(self) -> list[str]:
        """The scores that tables show, the one that decides first."""
        return [self.by, *(name for name in _BESIDE.get(self.by, _USUAL) if name != self.by)]

    def to_dict(self) -> dict[str, Any]:
        """Plain values, NaN as None; each estimate as value, low and high."""
        return as_plain(self)

    def frame(self) -> "pd.DataFrame":
        """A row an entrant; a score has columns for its mean and both ends of the interval."""
        import pandas as pd

        rows = []
        for standing in self.standings:
            row: dict[str, Any] = {
                "place": standing.place,
                "last_place": standing.last_place,
                "entrant": standing.entrant,
            }
            for name, estimate in {**standing.scores, f"{self.by}_iqm": standing.interquartile}.items():
                row |= {name: estimate.value, f"{name}_low": estimate.low, f"{name}_high": estimate.high}
            rows.append(
                {**row, "first": standing.shares[0], "failed": standing.failed, "replicates": self.replicates}
            )
        return pd.DataFrame(rows)


def leaderboard(
    results: Results, by: str = "steps", confidence: float = 0.95, scores: Scores | None = None
) -> Leaderboard:
    """The entrants of a tournament in the order of their scores.

    Args:
        results: the tournament's; it need not be finished.
        by: a name in ``arena.analysis.scores.SCORES``.
        confidence: of the intervals and the places. Places of an adaptive tournament are tested at the
            level of its last look, whatever is asked.
        scores: what ``scores_of(results, by)`` returns, where that is there already.

    Raises:
        ValueError: when there is no such score, or the confidence is not between 0 and 1.
    """
    check_confidence(confidence)
    scores = scores_of(results, by) if scores is None else scores
    costs = scores.costs(by)
    entrants, count = costs.shape
    places_at, remarks = _places_at(results, scores, confidence)
    ties = tie_groups(costs, places_at)
    shares = rank_distribution(costs) if count else np.full((entrants, entrants), np.nan)
    means = costs.mean(axis=1) if count else np.zeros(entrants)
    order = sorted(range(entrants), key=lambda i: (ties.first[i], means[i], scores.entrants[i]))
    apart = ties.better | ties.better.T
    standings = tuple(
        Standing(
            int(ties.first[i]),
            int(ties.last[i]),
            scores.entrants[i],
            {name: mean_estimate(matrix[i], confidence) for name, matrix in scores.values.items()},
            bootstrap_interval(scores.values[by][i], confidence=confidence),
            tuple(map(float, shares[i])),
            tuple(scores.entrants[j] for j in order if j != i and not apart[i, j]),
            int(scores.failed[i].sum()),
        )
        for i in order
    )
    p_values = tuple(tuple(float(ties.p_values[i, j]) for j in order) for i in order)
    return Leaderboard(by, confidence, count, standings, p_values, remarks)


def check_confidence(confidence: float) -> None:
    """See that it is one.

    Raises:
        ValueError: when it is not between 0 and 1.
    """
    if not 0.0 < number("confidence", confidence) < 1.0:
        raise InvalidValueError(f"confidence must be between 0 and 1, got {confidence!r}")


def _places_at(results: Results, scores: Scores, confidence: float) -> tuple[float, tuple[str, ...]]:
    """The confidence at which the places are tested, and what there is to say of it."""
    config, entrants, count = results.config, len(scores.entrants), len(scores.replicates)
    pairs = entrants * (entrants - 1) // 2
    if config["replicates"] != ADAPTIVE:
        warning = power_warning(count, pairs, confidence) if pairs else ""
        return confidence, (warning,) if warning else ()
    most, leaders = config["max_replicates"], config["leaders"]
    look = look_at(count, entrants, most, config["confidence"])
    whose = "place is" if leaders == 1 else f"{leaders} places are"
    if look is None:
        return 1.0, (f"Adaptive, and not finished: {count} of at most {most} replicates.",)
    if decided(scores.costs("steps"), look, leaders):
        saved = most - count
        state = f"decided after {count} of at most {most} replicates: {saved} saved"
        state += f", {saved * entrants:,} runs"
    else:
        state = f"not decided after {count} of at most {most} replicates"
    at = f"{100.0 * config['confidence']:g}% confidence over all looks"
    return 1.0 - look.level, (f"The first {whose} {state} ({at}).",)
