"""The paper, claim by claim: what it says, what we measured, and whether one agrees with the other.

The paper reports one run of each of its 32 cells. A replicate of ours is such a run of all 32, so each
number of the paper is compared with the distribution of that number over our replicates: it is
reproduced if it lies between the 2.5th and the 97.5th percentile.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena.comparison import published, without_nan
from arena.random_walk import RandomWalk
from arena.results import Results
from arena.statistics import correlation

REPRODUCED, NOT_REPRODUCED, NOT_TESTABLE = "reproduced", "not reproduced", "not testable"
_CENTRAL = (2.5, 97.5)
_SCORES = ("accuracy", "mean_length", "iterations")
_BEST = ("sarsa", 20, 30)

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Claim:
    """One quantitative claim.

    Attributes:
        section: of the paper.
        statement: what is claimed.
        paper: the paper's number; NaN if it gives none.
        ours: mean over our replicates; NaN if we have none.
        low, high: the central 95% of our replicates.
        percentile: of the paper's number among them.
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
        found: dict[str, Any] = without_nan(asdict(self))
        return found


def verdicts(results: Results, walk: RandomWalk) -> list[Claim]:
    """A row for each claim of sections 3.2 and 4.3.

    Args:
        results: of the tournament ``paper`` with two replicates or more.
        walk: 2,000 random walks or more, in sets of 2,000.

    Raises:
        ValueError: when the results are not those of the whole tournament.
    """
    tables = _tables(results)
    return [*_walk_claims(walk), *_cell_claims(tables), *_count_claims(tables), *_text_claims(tables)]


def _tables(results: Results) -> dict[str, Floats]:
    """Each score, shape (cells, replicates), cells in the paper's order."""
    replicates = results.config["replicates"]
    cells = {key: number for number, key in enumerate(published())}
    found = {score: np.full((len(cells), replicates), np.nan) for score in _SCORES}
    for run in results.runs:
        bins = run["parameters"].get("bins")
        key = (run["agent"], *bins) if isinstance(bins, list) else None
        if key not in cells or run["status"] != "finished":
            raise ValueError(
                f"results must be those of the whole tournament paper, got {run['entrant']!r} {run['status']}"
            )
        for score in _SCORES:
            found[score][cells[key], run["replicate"]] = math.nan if run[score] is None else run[score]
    if replicates < 2 or np.isnan(found["iterations"]).any():
        raise ValueError(
            f"results must be those of the whole tournament paper with 2 replicates or more, got {results!r}"
        )
    return found


def _walk_claims(walk: RandomWalk) -> Iterator[Claim]:
    sets = walk.lengths[: len(walk.lengths) // 2000 * 2000].reshape(-1, 2000).astype(float)
    for statement, paper, sample in (
        ("least length of 2,000 random walks", 865, sets.min(axis=1)),
        ("greatest length", 324_776, sets.max(axis=1)),
        ("mean length", 42_209.101, sets.mean(axis=1)),
        ("standard deviation of the length", 37_989.213, sets.std(axis=1)),
    ):
        yield _claim("3.2", statement, paper, sample)
    shares = 100.0 * (sets < 30_000).mean(axis=1)
    yield _bound("3.2", "share of walks below 30,000 steps is more than 50%", 50.0, shares)
    for statement, paper, ours in (
        ("least velocity", -0.06587993, walk.velocity[0]),
        ("greatest velocity", 0.05977063, walk.velocity[1]),
        ("least position", -1.2, walk.position[0]),
        ("greatest position", 0.52564615, walk.position[1]),
    ):
        near = abs(paper - ours) <= 0.01
        verdict = REPRODUCED if near else NOT_REPRODUCED
        yield Claim(
            "3.2", statement, paper, ours, ours, ours, math.nan, verdict, "within 0.01; ours of all walks"
        )
    yield _untestable("3.2", "1,057.8 s for 2,000 walks", 1057.793, "of the paper's machine and program")


def _cell_claims(tables: dict[str, Floats]) -> Iterator[Claim]:
    for number, (key, row) in enumerate(published().items()):
        algorithm, n_p, n_v = key
        for score, table, paper in zip(_SCORES, ("Table 1", "Table 1", "Table 2"), row, strict=True):
            statement = f"{score.replace('_', ' ')} of {algorithm} {n_p} x {n_v}"
            yield _claim(table, statement, paper, tables[score][number])


def _count_claims(tables: dict[str, Floats]) -> Iterator[Claim]:
    accuracy = tables["accuracy"]
    for statement, paper, counts in (
        ("cells with an accuracy above 73%", 32, accuracy > 73),
        ("below 80%", 3, accuracy < 80),
        ("below 90%", 6, accuracy < 90),
        ("above 95%", 24, accuracy > 95),
        ("of 100%", 9, accuracy == 100),
    ):
        yield _claim("4.3", statement, paper, counts.sum(axis=0).astype(float))


def _text_claims(tables: dict[str, Floats]) -> Iterator[Claim]:
    keys = list(published())
    accuracy, length, iterations = (tables[score] for score in _SCORES)
    best = keys.index(_BEST)
    shortest = 100.0 * (np.nanargmin(length, axis=0) == best)
    yield _shares(
        "4.3", "SARSA 20 x 30 has the shortest mean length", shortest, "of the replicates, in percent"
    )
    yield from _neighbours(length, keys, best)
    for n_p, n_v, where in ((20, 30, "the text"), (20, 20, "the tables")):
        fewest = 100.0 * (iterations.argmin(axis=0) == keys.index(("q-learning", n_p, n_v)))
        statement = f"Q-learning {n_p} x {n_v} takes the fewest iterations ({where})"
        yield _shares("4.3", statement, fewest, "of the replicates, in percent; ours: 10 x 10")
    first, second = slice(0, 16), slice(16, 32)
    for statement, paper, one, other in (
        ("correlation of iterations, Q-learning and SARSA", 0.983, iterations[first], iterations[second]),
        ("correlation of accuracy, Q-learning and SARSA", 0.686, accuracy[first], accuracy[second]),
        ("correlation of lengths, Q-learning and SARSA", 0.038, length[first], length[second]),
        ("correlation of iterations and accuracy in Q-learning", -0.46, iterations[first], accuracy[first]),
        ("correlation of iterations and accuracy in SARSA", -0.33, iterations[second], accuracy[second]),
    ):
        note = "the paper's own table gives 0.056" if paper == 0.038 else ""
        sample = np.array([correlation(a, b) for a, b in zip(one.T, other.T, strict=True)])
        yield _claim("4.3", statement, paper, sample, note)
    for score in _SCORES:
        yield _algorithms(score, tables[score][first], tables[score][second])
    yield _untestable(
        "4.3",
        "Figure 4 shows that the rewards converge",
        math.nan,
        "the figure's numbers are not in the text",
    )


def _neighbours(length: Floats, keys: Sequence[tuple[str, int, int]], best: int) -> Iterator[Claim]:
    """Whether the best cell can be told from those beside it."""
    for number, (algorithm, n_p, n_v) in enumerate(keys):
        if algorithm == _BEST[0] and abs(n_p - _BEST[1]) + abs(n_v - _BEST[2]) == 10:
            differences = length[number] - length[best]
            told = _sign_flip(differences) * 4 < 0.05  # Bonferroni over the four
            verdict = REPRODUCED if told and np.nanmean(differences) > 0 else NOT_REPRODUCED
            statement = f"SARSA 20 x 30 drives shorter than {n_p} x {n_v}"
            note = "steps longer than 20 x 30; paired permutation test, Bonferroni over 4"
            yield _measured("4.3", statement, differences, verdict, note)


def _algorithms(score: str, q_learning: Floats, sarsa: Floats) -> Claim:
    differences = np.nanmean(sarsa, axis=0) - np.nanmean(q_learning, axis=0)
    p = _sign_flip(differences)
    verdict = NOT_REPRODUCED if p < 0.05 else REPRODUCED
    statement = f"no significant difference between SARSA and Q-learning in {score.replace('_', ' ')}"
    return _measured("4.3", statement, differences, verdict, f"SARSA - Q-learning over 16 cells; p = {p:.2g}")


def _sign_flip(differences: Floats) -> float:
    """Two-sided p of a paired permutation test that the mean difference is 0."""
    found = differences[~np.isnan(differences)]
    flips = np.random.default_rng(0).choice([-1.0, 1.0], (9999, len(found)))
    extreme = np.abs(flips @ found) >= abs(found.sum()) * (1.0 - 1e-12)
    return float((extreme.sum() + 1) / 10_000)


def _claim(section: str, statement: str, paper: float, sample: Floats, note: str = "") -> Claim:
    found = sample[~np.isnan(sample)]
    low, high = np.percentile(found, _CENTRAL)
    percentile = 100.0 * (np.mean(found < paper) + np.mean(found == paper) / 2.0)
    verdict = REPRODUCED if low <= paper <= high else NOT_REPRODUCED
    return Claim(section, statement, paper, float(found.mean()), low, high, percentile, verdict, note)


def _bound(section: str, statement: str, bound: float, sample: Floats) -> Claim:
    low, high = np.percentile(sample, _CENTRAL)
    verdict = REPRODUCED if low > bound else NOT_REPRODUCED
    return Claim(section, statement, bound, float(sample.mean()), low, high, math.nan, verdict)


def _shares(section: str, statement: str, sample: Floats, note: str) -> Claim:
    """A claim that something holds; it is reproduced if it does in most replicates."""
    share = float(sample.mean())
    verdict = REPRODUCED if share > 50 else NOT_REPRODUCED
    return Claim(section, statement, math.nan, share, math.nan, math.nan, math.nan, verdict, note)


def _measured(section: str, statement: str, sample: Floats, verdict: str, note: str) -> Claim:
    found = sample[~np.isnan(sample)]
    low, high = np.percentile(found, _CENTRAL)
    return Claim(section, statement, math.nan, float(found.mean()), low, high, math.nan, verdict, note)


def _untestable(section: str, statement: str, paper: float, why: str) -> Claim:
    return Claim(section, statement, paper, math.nan, math.nan, math.nan, math.nan, NOT_TESTABLE, why)
