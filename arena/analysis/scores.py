"""The scores that entrants are ranked by: one value a run, what is missing counted as the worst."""

import math
from collections import Counter
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena.analysis.regret import Bounds, fewest_steps
from arena.common.npz import Floats
from arena.results.records import RunRecord
from arena.results.results import Results
from envs.foundation.checks import choice
from envs.foundation.errors import InvalidValueError


class Score(NamedTuple):
    """What a score is: in words, with how many decimals it is printed, and whether more is better."""

    description: str
    decimals: int
    more_is_better: bool = False


SCORES: dict[str, Score] = {
    "steps": Score("steps of a test drive, one that fails counted at the limit", 1),
    "accuracy": Score("percent of the test drives that reach the goal", 1, more_is_better=True),
    "length": Score("steps of the test drives that reach the goal", 1),
    "regret": Score("steps of a test drive beyond the fewest possible from its start", 1),
    "iterations": Score("steps of training", 0),
}
_ATTRIBUTES = {name: name for name in SCORES} | {"length": "mean_length"}  # of the records
QUANTILES = {"regret_median": 0.5, "regret_90": 0.9}


def decimals(name: str) -> int:
    """With how many a score, or a quantile of one, is printed."""
    return SCORES[name.partition("_")[0]].decimals


@dataclass(frozen=True)
class Scores:
    """The scores of a tournament.

    Only replicates that all entrants have run are there. A run that failed has the worst score that is
    possible: no test drive reaches the goal, and training takes all of its steps. So has the length of a
    run in which no test drive reaches the goal. An entrant gains nothing by failing where it would be bad.

    Attributes:
        entrants: names.
        replicates: numbers of the replicates.
        values: a matrix a score, a row an entrant, a column a replicate.
        failed: which of these runs failed, a matrix like those.
    """

    entrants: tuple[str, ...]
    replicates: tuple[int, ...]
    values: dict[str, Floats]
    failed: NDArray[np.bool_]

    def costs(self, by: str) -> Floats:
        """The scores ``by`` so that less is better.

        Raises:
            ValueError: when there is no such score.
        """
        choice("by", by, [name for name in SCORES if name in self.values])
        return -self.values[by] if SCORES[by].more_is_better else self.values[by]


def scores_of(results: Results, by: str = "steps", bounds: Bounds | None = None) -> Scores:
    """The scores of all entrants in the replicates that all of them have run.

    Args:
        results: of a tournament; it need not be finished.
        by: a name in ``SCORES``. Only for ``"regret"``, which takes some milliseconds a start of the
            test, are there ``regret``, its mean over the starts, ``regret_median`` and ``regret_90``,
            its quantiles.
        bounds: for ``"regret"``, in place of what ``arena.analysis.regret.fewest_steps`` finds.

    Raises:
        ValueError: when there is no such score, or the bounds do not fit.
    """
    choice("by", by, SCORES)
    entrants = tuple(results.entrants)
    records = {record.key: record for record in results.records}
    counts = Counter(replicate for _, replicate in records)
    replicates = tuple(sorted(replicate for replicate, n in counts.items() if n == len(entrants)))
    training, limit = results.conditions.training, results.conditions.evaluation.max_steps
    worst = {"accuracy": 0.0, "length": limit, "steps": limit}
    worst["iterations"] = training.episodes * training.max_steps
    table = [[records[name, replicate] for replicate in replicates] for name in entrants]
    values = {
        name: _matrix(table, [[_value(record, _ATTRIBUTES[name], most) for record in row] for row in table])
        for name, most in worst.items()
    }
    if by == "regret":
        bounds = bounds or fewest_steps(results, replicates)
        regrets = [[_regrets(results, record, bounds) for record in row] for row in table]
        values["regret"] = _matrix(table, [[regret.mean() for regret in row] for row in regrets])
        for name, share in QUANTILES.items():
            values[name] = _matrix(table, [[np.quantile(regret, share) for regret in row] for row in regrets])
    order = [name for name in (*SCORES, *QUANTILES) if name in values]
    failed = _matrix(table, [[not record.finished for record in row] for row in table]) > 0.0
    return Scores(entrants, replicates, {name: values[name] for name in order}, failed)


def _matrix(table: list[list[Any]], values: list[list[Any]]) -> Floats:
    return np.array(values, dtype=float).reshape(len(table), len(table[0]) if table else 0)


def _value(record: RunRecord, attribute: str, worst: float) -> float:
    value = getattr(record, attribute)
    return float(worst if not record.finished or math.isnan(value) else value)


def _regrets(results: Results, record: RunRecord, bounds: Bounds) -> Floats:
    """Steps beyond the bound, a value a start."""
    evaluation, number = results.conditions.evaluation, record.replicate
    if record.finished:
        lengths = results.arrays(record.entrant, number)["test_lengths"].astype(float)
    else:
        lengths = np.full(evaluation.episodes, float(evaluation.max_steps))
    least = np.asarray(bounds[number], dtype=float)
    if least.shape != lengths.shape:
        raise InvalidValueError(
            f"bounds of replicate {number} must have {len(lengths)} values, got {least.size}"
        )
    regrets: Floats = lengths - least
    return regrets


def improvement(scores: Scores, by: str) -> NDArray[np.float64]:
    """The probability that a run of the row's entrant is better than one of the column's, ties half.

    Shape (entrants, entrants); the values of ``arena.statistics.probability_of_improvement``.
    """
    costs = scores.costs(by)
    return np.array(
        [0.5 - 0.5 * np.sign(row[:, None] - costs[:, None, :]).mean(axis=(1, 2)) for row in costs]
    )
