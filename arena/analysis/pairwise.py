"""Two entrants side by side, and two files of one tournament: what is better, worse, or chance."""

from dataclasses import dataclass
from typing import Any

from arena.analysis.scores import SCORES, Scores, scores_of
from arena.analysis.standings import check_confidence
from arena.common.npz import Floats
from arena.common.plain import as_plain
from arena.results.results import Results
from arena.statistics.intervals import Estimate, bootstrap_interval, mean_estimate, probability_of_improvement
from arena.statistics.permutation import (
    holm,
    is_significant,
    paired_permutation_test,
    power_warning,
    sign_flip_test,
)
from envs.foundation.checks import choice, number
from envs.foundation.errors import InvalidValueError


@dataclass(frozen=True)
class Comparison:
    """Two entrants of a tournament.

    Attributes:
        by, confidence, replicates: what is compared, how sure the intervals are, how many count.
        a, b: the names.
        means: of each, with Student's t interval.
        interquartile: interquartile mean of each, with its bootstrap interval.
        difference: mean of a's score less b's in the same replicate, with Student's t interval.
        p_value: of the paired permutation test.
        probability: that a run of a is better than one of b, with Newcombe's interval.
        verdict: who is better, if it is not chance, in a sentence.
    """

    by: str
    confidence: float
    replicates: int
    a: str
    b: str
    means: tuple[Estimate, Estimate]
    interquartile: tuple[Estimate, Estimate]
    difference: Estimate
    p_value: float
    probability: Estimate
    verdict: str

    def to_dict(self) -> dict[str, Any]:
        """Plain values, NaN as None."""
        return as_plain(self)


def compare_entrants(
    results: Results,
    a: str,
    b: str,
    by: str = "steps",
    confidence: float = 0.95,
) -> Comparison:
    """Compare two entrants, chosen before the results were seen: nothing is corrected for others.

    Raises:
        ValueError: when there is no such entrant or score, or no replicate that all have run.
    """
    check_confidence(confidence)
    scores = scores_of(results, by)
    costs = scores.costs(by)
    for name in (a, b):
        choice("entrant", name, scores.entrants)
    if a == b:
        raise InvalidValueError(f"entrants must be two, got {a!r} twice")
    if not scores.replicates:
        raise InvalidValueError("there is no replicate that all entrants have run")
    i, j = scores.entrants.index(a), scores.entrants.index(b)
    first, second = scores.values[by][i], scores.values[by][j]
    p_value = paired_permutation_test(costs[i], costs[j])
    return Comparison(
        by,
        confidence,
        len(scores.replicates),
        a,
        b,
        (mean_estimate(first, confidence), mean_estimate(second, confidence)),
        (
            bootstrap_interval(first, confidence=confidence),
            bootstrap_interval(second, confidence=confidence),
        ),
        mean_estimate(first - second, confidence),
        p_value,
        probability_of_improvement(-costs[i], -costs[j], confidence),
        _verdict(a, b, float((costs[i] - costs[j]).mean()), p_value, confidence, len(scores.replicates)),
    )


def _verdict(a: str, b: str, difference: float, p_value: float, confidence: float, count: int) -> str:
    if is_significant(p_value, 1.0 - confidence):
        return f"{a if difference < 0.0 else b} is better than {b if difference < 0.0 else a}."
    return power_warning(count, 1, confidence) or "They cannot be told apart."


@dataclass(frozen=True)
class Regression:
    """What became of an entrant since the baseline.

    Attributes:
        entrant: its name.
        before, after: its mean scores.
        worse: mean of how much worse it is in the same replicate, negative for better, with Student's t
            interval; in the units of the score.
        p_value: that it is worse by no more than what is allowed; one-sided, corrected by Holm.
        regressed: whether it is worse beyond that and beyond chance.
    """

    entrant: str
    before: float
    after: float
    worse: Estimate
    p_value: float
    regressed: bool

    def to_dict(self) -> dict[str, Any]:
        """Plain values, NaN as None."""
        return as_plain(self)


def regressions(
    new: Results,
    old: Results,
    max_regression: float = 0.0,
    by: str = "steps",
    confidence: float = 0.95,
    *,
    relative: bool = False,
) -> tuple[Regression, ...]:
    """What became of the entrants that both have, in the order of ``new``.

    The replicates that both have are paired by their numbers. With the same seed they are tested from the
    same starts; with another one the pairs are by lot, and the test holds as well.

    Args:
        new: after the change.
        old: the baseline.
        max_regression: how much worse is allowed, in the units of the score.
        by: the score.
        confidence: 1 - the probability that any entrant is said to be worse though none is.
        relative: whether ``max_regression`` is a share of the baseline instead.

    Raises:
        ValueError: when the files cannot be compared, or have too few replicates to show anything: a gate
            that nothing can close is none.
    """
    check_confidence(confidence)
    allowed = number("max_regression", max_regression, 0)
    for key in ("hill", "training", "evaluation"):
        if new.config.get(key) != old.config.get(key):
            raise InvalidValueError(f"the files cannot be compared: their {key} differs")
    after, before = scores_of(new, by), scores_of(old, by)
    names = [name for name in after.entrants if name in before.entrants]
    if not names:
        raise InvalidValueError("the files cannot be compared: they have no entrant in common")
    both = sorted(set(after.replicates) & set(before.replicates))
    few = power_warning(len(both), len(names), confidence, one_sided=True)
    if few:
        raise InvalidValueError(few)
    now, then = _rows(after, by, names, both), _rows(before, by, names, both)
    sign = -1.0 if SCORES[by].more_is_better else 1.0
    worse = sign * (now - then)
    p_values = holm(sign_flip_test(worse - (allowed * then if relative else allowed), one_sided=True))
    return tuple(
        Regression(
            name,
            float(then[i].mean()),
            float(now[i].mean()),
            mean_estimate(worse[i], confidence),
            float(p_values[i]),
            bool(is_significant(p_values[i], 1.0 - confidence)),
        )
        for i, name in enumerate(names)
    )


def _rows(scores: Scores, by: str, names: list[str], replicates: list[int]) -> Floats:
    columns = [scores.replicates.index(replicate) for replicate in replicates]
    return scores.values[by][[scores.entrants.index(name) for name in names]][:, columns]
