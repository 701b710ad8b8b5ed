"""The paper, claim by claim: every quantitative one of sections 3.2 and 4.3.

The paper reports one run of each of its 32 cells, and one series of 2,000 random walks. A replicate of ours
is such a run of all 32 cells, or such a series, so each number of the paper is compared with the
distribution of that number over our replicates.
"""

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from arena.analysis.curves import moving_average, settled
from arena.common.npz import Floats
from arena.reproduction.goodness import chi_square, chi_square_spread, iterations_spread
from arena.reproduction.published_values import (
    MINIMUM_ACCURACY,
    PAPER,
    PAPER_SECONDS,
    REASONABLE,
    Key,
    published,
)
from arena.reproduction.tables import PAPER_SCORES, paper_tables
from arena.reproduction.verdicts import (
    Claim,
    distance_claim,
    holds_claim,
    measured_claim,
    number_claim,
    untestable_claim,
)
from arena.results.results import Results
from arena.statistics.intervals import correlation
from arena.statistics.permutation import holm, is_significant, paired_permutation_test
from arena.walks.series import RandomWalk

WALKS = 2000  # of a series
_BEST = ("sarsa", 20, 30)
_FEW = 10  # cells, to be named
_LEVEL = 0.05  # of the tests
_TAIL = 0.025  # of the replicates: what is rarer is not reproduced
_NEAR, _CALM = 1.2, 0.1  # Figure 4 converges if it stays so near its end, a factor, in that last share


def paper_claims(results: Results, walks: Sequence[RandomWalk]) -> list[Claim]:
    """A row for each claim of sections 3.2 and 4.3.

    Args:
        results: of the tournament ``paper``, all runs finished, with 2 replicates or more.
        walks: series of ``WALKS`` random walks each, on the paper's hill; two or more.

    Raises:
        ValueError: when the results are not those of the whole tournament.
    """
    return [*_walk_claims(walks), *results_claims(results)]


def results_claims(results: Results) -> list[Claim]:
    """The same without those of section 3.2, which are about random walks.

    Raises:
        ValueError: when the results are not those of the whole tournament.
    """
    tables = paper_tables(results)
    return [
        *_cell_claims(tables),
        *_table_claims(tables),
        *_count_claims(tables["accuracy"]),
        *_best_cell_claims(tables["mean_length"]),
        *_iteration_claims(tables["iterations"]),
        *_correlation_claims(tables),
        *_algorithm_claims(tables),
        *_figure_claims(results),
    ]


def _walk_claims(walks: Sequence[RandomWalk]) -> Iterator[Claim]:
    lengths = np.array([walk.lengths for walk in walks], dtype=float)
    bounds = np.array([(*walk.velocity, *walk.position) for walk in walks]).T
    for statement, paper, sample in (
        ("least length of a random walk", PAPER.least, lengths.min(axis=1)),
        ("greatest length", PAPER.most, lengths.max(axis=1)),
        ("mean length", PAPER.mean, lengths.mean(axis=1)),
        ("standard deviation of the lengths", PAPER.deviation, lengths.std(axis=1)),
        ("least velocity", PAPER.velocity[0], bounds[0]),
        ("greatest velocity", PAPER.velocity[1], bounds[1]),
        ("least position", PAPER.position[0], bounds[2]),
        ("greatest position", PAPER.position[1], bounds[3]),
    ):
        yield number_claim("3.2", statement, paper, sample)
    below = 100.0 * (lengths < REASONABLE).mean(axis=1)
    yield measured_claim(
        "3.2",
        f"more than 50% of the walks take less than {REASONABLE:,} steps",
        50.0,
        below,
        reproduced=bool(np.mean(below > 50.0) > _TAIL),
        note="percent that do; reproduced if it is more than 50 in more than 2.5% of our series",
    )
    why = "of the paper's machine and program"
    yield untestable_claim("3.2", f"seconds for {PAPER.episodes:,} walks", PAPER_SECONDS, [], why)


def _cell_claims(tables: dict[str, Floats]) -> Iterator[Claim]:
    for score, table, column in zip(PAPER_SCORES, ("Table 1", "Table 1", "Table 2"), range(3), strict=True):
        for number, ((algorithm, n_p, n_v), row) in enumerate(published().items()):
            statement = f"{score.replace('_', ' ')} of {algorithm} {n_p}x{n_v}"
            yield number_claim(table, statement, row[column], tables[score][number])


def _table_claims(tables: dict[str, Floats]) -> Iterator[Claim]:
    theirs = dict(zip(PAPER_SCORES, np.array(list(published().values())).T, strict=True))
    for table, scores in (("Table 1", PAPER_SCORES[:2]), ("Table 2", PAPER_SCORES[2:])):
        paper, ours = (np.concatenate([of[score] for score in scores]) for of in (theirs, tables))
        yield distance_claim(
            table,
            f"the whole table: chi-square over its {len(paper)} numbers",
            chi_square(ours, paper),
            chi_square_spread(ours),
            "mean square of the distances from our means, in standard deviations; ours: of each replicate",
        )


def _count_claims(accuracy: Floats) -> Iterator[Claim]:
    theirs = np.array([row[0] for row in published().values()])
    conditions: tuple[tuple[str, int, Callable[[Floats], NDArray[np.bool_]]], ...] = (
        (f"cells with an accuracy above {MINIMUM_ACCURACY:g}%", 32, lambda a: a > MINIMUM_ACCURACY),
        ("cells below 80%", 3, lambda a: a < 80.0),
        ("cells below 90%", 6, lambda a: a < 90.0),
        ("cells above 95%", 24, lambda a: a > 95.0),
        ("cells of 100%", 9, lambda a: a == 100.0),
    )
    for statement, paper, is_counted in conditions:
        cells = [_name(key) for key, counts in zip(published(), is_counted(theirs), strict=True) if counts]
        note = f"the paper's: {', '.join(cells)}" if len(cells) < _FEW else ""
        yield number_claim("4.3", statement, paper, is_counted(accuracy).sum(axis=0), note)


def _best_cell_claims(length: Floats) -> Iterator[Claim]:
    keys, theirs = list(published()), np.array([row[1] for row in published().values()])
    best = keys.index(_BEST)
    shortest = np.where(np.isnan(length), np.inf, length).argmin(axis=0)
    yield holds_claim("4.3", f"{_name(_BEST)} has the shortest mean length", shortest == best)
    beside = [i for i, key in enumerate(keys) if _neighbours(key, _BEST)]
    differences = {i: length[i] - length[best] for i in beside}
    p_values = holm([_chance(differences[i]) for i in beside])
    for i, p in zip(beside, p_values, strict=True):
        yield measured_claim(
            "4.3",
            f"{_name(_BEST)} drives shorter than {_name(keys[i])}",
            float(theirs[i] - theirs[best]),
            differences[i],
            reproduced=bool(is_significant(p, _LEVEL)) and float(np.nansum(differences[i])) > 0.0,
            note=f"steps by which it is; permutation test, Holm over {len(beside)}: p = {p:.2g}",
        )
    other = keys.index(("q-learning", *_BEST[1:]))
    yield number_claim(
        "4.3",
        f"{_name(keys[other])} is close: steps longer than {_name(_BEST)}",
        float(theirs[other] - theirs[best]),
        length[other] - length[best],
    )


def _neighbours(key: Key, other: Key) -> bool:
    return key[0] == other[0] and abs(key[1] - other[1]) + abs(key[2] - other[2]) == 10


def _iteration_claims(iterations: Floats) -> Iterator[Claim]:
    keys = list(published())
    theirs = np.array([row[2] for row in published().values()])
    fewest = iterations.argmin(axis=0)
    for key, note in (
        (
            ("q-learning", 20, 30),
            "so the sentence; but the accuracy and the length in it are those of 20x20",
        ),
        (("q-learning", 20, 20), "so Table 2, and the numbers in that sentence"),
    ):
        statement = f"{_name(key)} takes the fewest iterations"
        yield holds_claim("4.3", statement, fewest == keys.index(key), note)
    spread = iterations_spread(iterations)
    distance = 100.0 * float(np.sqrt(np.mean((theirs / iterations.mean(axis=1) - 1.0) ** 2)))
    note = "root mean square over the cells, in percent; ours: of each replicate from the mean of the others"
    yield distance_claim("Table 2", "distance from our mean iterations", distance, spread, note)


def _correlation_claims(tables: dict[str, Floats]) -> Iterator[Claim]:
    accuracy, length, iterations = (tables[score] for score in PAPER_SCORES)
    first, second = slice(0, 16), slice(16, 32)
    of_lengths = [row[1] for row in published().values()]
    printed = correlation(of_lengths[first], of_lengths[second])
    for statement, paper, score, other_score, note in (
        ("iterations, Q-learning and SARSA", 0.983, iterations[first], iterations[second], ""),
        ("accuracy, Q-learning and SARSA", 0.686, accuracy[first], accuracy[second], ""),
        (
            "lengths, Q-learning and SARSA",
            0.038,
            length[first],
            length[second],
            f"the paper's Table 1 gives {printed:.3f}",
        ),
        ("iterations and accuracy in Q-learning", -0.46, iterations[first], accuracy[first], ""),
        ("iterations and accuracy in SARSA", -0.33, iterations[second], accuracy[second], ""),
    ):
        sample = [correlation(a, b) for a, b in zip(score.T, other_score.T, strict=True)]
        yield number_claim("4.3", f"correlation of {statement}", paper, sample, note)


def _algorithm_claims(tables: dict[str, Floats]) -> Iterator[Claim]:
    theirs = np.array(list(published().values()))
    for column, score in enumerate(PAPER_SCORES):
        q_learning, sarsa = tables[score][:16], tables[score][16:]
        differences = _mean_of_cells(sarsa) - _mean_of_cells(q_learning)
        p = _chance(differences)
        yield measured_claim(
            "4.3",
            f"no significant difference in {score.replace('_', ' ')}",
            float(theirs[16:, column].mean() - theirs[:16, column].mean()),
            differences,
            reproduced=not is_significant(p, _LEVEL),
            note=f"SARSA less Q-learning, mean of 16 cells; paired permutation test: p = {p:.2g}",
        )


def _mean_of_cells(table: Floats) -> Floats:
    """Of each replicate; cells without a number are left out."""
    known = (~np.isnan(table)).sum(axis=0)
    return np.where(known > 0, np.nansum(table, axis=0) / np.maximum(known, 1), math.nan)


def _figure_claims(results: Results) -> Iterator[Claim]:
    replicates = range(results.config["replicates"])
    lengths = [results.arrays(_name(_BEST), replicate)["lengths"] for replicate in replicates]
    curves = [-moving_average(replicate) for replicate in lengths]
    rises = [curve[-1] > curve[0] for curve in curves]
    yield holds_claim("Figure 4", "the moving average of the rewards rises", rises)
    levels = [-_NEAR * curve[-round(_CALM * len(curve)) :].mean() for curve in curves]
    firsts = [settled(replicate, level) or math.inf for replicate, level in zip(lengths, levels, strict=True)]
    last = (1.0 - _CALM) * len(lengths[0])
    yield measured_claim(
        "Figure 4",
        "the moving average converges",
        math.nan,
        firsts,
        reproduced=bool(np.mean(np.array(firsts) > last) <= 2.0 * _TAIL),
        note=f"ours: the episode from which on it stays within {100.0 * (_NEAR - 1.0):.0f}% of the mean of "
        f"the last {100.0 * _CALM:.0f}%; reproduced if that is before episode {last:,.0f} in 95%",
    )
    ends, why = [curve[-1] for curve in curves], "the figure's numbers are not in the text"
    yield untestable_claim("Figure 4", "moving average of the rewards at the end", math.nan, ends, why)


def _chance(differences: Floats) -> float:
    """P-value of the mean difference; replicates without one are left out."""
    known = differences[~np.isnan(differences)]
    return paired_permutation_test(known, np.zeros(len(known)))


def _name(key: Key) -> str:
    algorithm, n_p, n_v = key
    return f"{algorithm} {n_p}x{n_v}"
