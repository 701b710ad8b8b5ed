"""Estimates, intervals, tests and places: by hand, beside scipy, and as they should behave in general."""

import importlib.util
import math
from itertools import product
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from paths import ROOT
from scipy import special, stats

from arena.analysis import area, moving_average, settled
from arena.statistics.intervals import (
    bootstrap_interval,
    interquartile_mean,
    mean_estimate,
    mean_interval,
    probability_of_improvement,
)
from arena.statistics.permutation import (
    EXACT,
    FLIPS,
    holm,
    needed_replicates,
    paired_permutation_test,
    power_warning,
    sign_flip_test,
    smallest_p,
)
from arena.statistics.ranks import rank_distribution, tie_groups

NUMBERS = st.floats(-1e6, 1e6).map(lambda x: round(x, 3))
EXACT_NUMBERS = st.integers(-(2**30), 2**30).map(lambda n: n / 1024)  # no sum of a few is rounded


def samples(least: int = 2, most: int = 9) -> st.SearchStrategy[list[float]]:
    return st.lists(NUMBERS, min_size=least, max_size=most)


def matrices(entrants: int = 5, replicates: int = 7) -> st.SearchStrategy[Any]:
    shapes = st.tuples(st.integers(1, entrants), st.integers(1, replicates))
    # Few values, so that there are ties.
    return shapes.flatmap(lambda shape: arrays(float, shape, elements=st.integers(0, 4).map(float)))


# Estimates and intervals.


def test_the_interquartile_mean_leaves_out_a_quarter_at_each_end() -> None:
    assert interquartile_mean([100.0, 1.0, 2.0, 3.0]) == 2.5
    assert interquartile_mean([1.0, 2.0, 4.0]) == pytest.approx(7.0 / 3.0)  # a quarter of three is none
    assert interquartile_mean([[0.0, 5.0], [0.0, 6.0], [0.0, 7.0], [9.0, 9.0]], axis=0).tolist() == [0.0, 6.5]


@settings(deadline=None)
@given(values=samples(1, 30))
def test_the_interquartile_mean_is_scipy_s_trimmed_mean(values: list[float]) -> None:
    assert interquartile_mean(values) == pytest.approx(stats.trim_mean(values, 0.25), abs=1e-6)


def test_an_estimate_of_the_mean_has_student_s_interval() -> None:
    values = [3.0, 5.0, 4.0, 9.0]
    expected = stats.t.interval(0.9, 3, np.mean(values), stats.sem(values))
    estimate = mean_estimate(values, 0.9)
    assert estimate.value == 5.25
    assert (estimate.low, estimate.high) == pytest.approx(expected)
    assert mean_interval(values, 0.9)[1] == pytest.approx(estimate.high - 5.25)
    assert math.isnan(mean_estimate([1.0]).low)


def test_the_bootstrap_draws_what_scipy_s_draws() -> None:
    values = np.random.default_rng(3).normal(size=12)
    ours = bootstrap_interval(values, np.mean)
    # The level at which scipy's plain percentiles are Student's tails.
    level = 1.0 - 2.0 * special.ndtr(-special.stdtrit(11, 0.975))
    theirs = stats.bootstrap(
        (values,), np.mean, n_resamples=20000, confidence_level=level, method="percentile"
    ).confidence_interval
    assert ours.value == pytest.approx(values.mean())
    assert (ours.low, ours.high) == pytest.approx((theirs.low, theirs.high), abs=0.1 * values.std())


def test_the_bootstrap_is_seeded_and_copes_with_little() -> None:
    values = [1.0, 5.5, 2.2, 8.0, 3.1, 7.7, 0.3, 4.9]
    assert bootstrap_interval(values, seed=1) == bootstrap_interval(values, seed=1)
    assert bootstrap_interval(values, np.mean, seed=1) != bootstrap_interval(values, np.mean, seed=2)
    assert bootstrap_interval([4.0] * 6) == (4.0, 4.0, 4.0)
    assert bootstrap_interval([4.0]).value == 4.0
    assert math.isnan(bootstrap_interval([4.0]).low)
    assert all(map(math.isnan, bootstrap_interval([])))


@settings(deadline=None)
@given(values=samples())
def test_a_bootstrap_interval_is_within_the_values(values: list[float]) -> None:
    value, low, high = bootstrap_interval(values)
    slack = 1e-9 * (1.0 + max(map(abs, values)))
    assert min(values) - slack <= low <= high <= max(values) + slack
    assert min(values) - slack <= value <= max(values) + slack


def test_the_probability_of_improvement_counts_pairs() -> None:
    assert probability_of_improvement([1.0, 3.0], [2.0, 0.0]).value == 0.75  # 1>0, 3>2, 3>0 of four
    assert probability_of_improvement([1.0, 1.0], [1.0, 0.0]).value == 0.75  # a tie counts half
    assert all(map(math.isnan, probability_of_improvement([], [1.0])))


def test_newcombe_s_interval_solves_his_equation() -> None:
    # Newcombe (2006), method 5: |theta - value|^2 = z^2 V(theta) at both ends.
    value, low, high = probability_of_improvement([1, 4, 5, 7, 8], [0, 2, 3, 6, 9], 0.95)
    assert 0.0 < low < value < high < 1.0
    for theta in (low, high):
        extra = 4.0
        variance = theta * (1 - theta) / 25.0
        variance *= 1 + extra * (1 - theta) / (2 - theta) + extra * theta / (1 + theta)
        assert (theta - value) ** 2 == pytest.approx(1.959963985**2 * variance, rel=1e-6)
    assert probability_of_improvement(range(10, 20), range(10)).high == 1.0
    assert 0.6 < probability_of_improvement(range(10, 20), range(10)).low < 0.9


@settings(deadline=None)
@given(x=samples(), y=samples(), confidence=st.floats(0.5, 0.999))
def test_improvement_turned_round_is_its_complement(
    x: list[float], y: list[float], confidence: float
) -> None:
    there, back = probability_of_improvement(x, y, confidence), probability_of_improvement(y, x, confidence)
    assert there.value == pytest.approx(1.0 - back.value)
    assert there.low == pytest.approx(1.0 - back.high, abs=1e-9)
    assert there.low <= there.value <= there.high
    u = (
        stats.mannwhitneyu(x, y, method="asymptotic", use_continuity=False).statistic
        if len({*x, *y}) > 1
        else None
    )
    if u is not None:
        assert there.value == pytest.approx(u / (len(x) * len(y)))


# The paired permutation test.


def test_a_permutation_test_by_hand() -> None:
    # Differences 1, 2, 4: sums of the flips are +-7, +-5, +-3, +-1; two of eight are as far out as 7.
    assert paired_permutation_test([1, 2, 4], [0, 0, 0]) == 0.25
    assert paired_permutation_test([1, 2, 4], [0, 0, 0], one_sided=True) == 0.125
    assert paired_permutation_test([0, 0, 0], [1, 2, 4], one_sided=True) == 1.0
    assert paired_permutation_test([1, 2, -4], [0, 0, 0]) == 1.0  # -1: nothing is nearer to zero
    assert paired_permutation_test([256, -258, 1.844], [0, 0, 0]) == 1.0  # rounded sums that are equal
    assert paired_permutation_test([5, 5], [5, 5]) == 1.0


@settings(max_examples=40, deadline=None)
@given(
    pairs=st.lists(st.tuples(EXACT_NUMBERS, EXACT_NUMBERS), min_size=2, max_size=9), one_sided=st.booleans()
)
def test_the_permutation_test_is_scipy_s(pairs: list[tuple[float, float]], one_sided: bool) -> None:
    # SciPy takes equal sums for different ones where rounding tells them apart, so here it does not:
    # the p-value of 256, -258 and 1.844 is 1, for no flip has a sum nearer to 0; SciPy 1.13 says 0.75.
    x, y = np.array(pairs).T
    theirs = stats.permutation_test(
        (x, y),
        lambda a, b, axis: np.mean(a - b, axis=axis),
        permutation_type="samples",
        n_resamples=10**6,
        alternative="greater" if one_sided else "two-sided",
        vectorized=True,
    )
    assert paired_permutation_test(x, y, one_sided=one_sided) == pytest.approx(theirs.pvalue)


def test_many_replicates_are_flipped_at_random_and_seeded() -> None:
    rng = np.random.default_rng(5)
    x, y = rng.normal(0.5, 1.0, EXACT + 3), rng.normal(size=EXACT + 3)
    p = paired_permutation_test(x, y)
    assert p == paired_permutation_test(x, y)
    assert p != paired_permutation_test(x, y, seed=1)
    differences = x - y
    signs = np.array(list(product((-1.0, 1.0), repeat=len(x) - 1)))
    exact = np.mean(np.abs(signs @ differences[1:] + differences[0]) >= abs(differences.sum()) - 1e-9)
    assert p == pytest.approx(exact, abs=5 * math.sqrt(exact * (1 - exact) / FLIPS))
    assert paired_permutation_test(x + 99.0, y) == 1.0 / (FLIPS + 1) == smallest_p(EXACT + 3)
    assert paired_permutation_test(x + 99.0, y, one_sided=True) == smallest_p(EXACT + 3, one_sided=True)


@settings(deadline=None)
@given(count=st.integers(1, EXACT), one_sided=st.booleans())
def test_nothing_is_below_the_smallest_p(count: int, one_sided: bool) -> None:
    apart = np.arange(1.0, count + 1.0)
    assert paired_permutation_test(apart, 0.0 * apart, one_sided=one_sided) == smallest_p(
        count, one_sided=one_sided
    )


def test_the_needed_replicates() -> None:
    assert smallest_p(3) == 0.25
    assert needed_replicates(1, 0.05) == 6  # 2 / 2^6 = 0.031
    assert needed_replicates(1, 0.05, one_sided=True) == 5
    assert needed_replicates(6, 0.05) == 8  # 6 * 2 / 2^8 = 0.047
    assert needed_replicates(1, 0.25) == 3
    assert needed_replicates(10**6, 0.05) is None
    assert power_warning(6, 1, 0.95) == ""
    assert power_warning(3, 1, 0.95) == (
        "With 3 replicates no difference can be shown at 95% confidence in 1 comparison: "
        "6 or more are needed."
    )
    assert power_warning(1, 6, 0.9) == (
        "With 1 replicate no difference can be shown at 90% confidence in 6 comparisons: "
        "7 or more are needed."
    )
    assert "no number of them is enough" in power_warning(90, 10**6, 0.95)


# Holm.


def test_holm_by_hand() -> None:
    assert holm([0.01, 0.04, 0.03, 0.005]).tolist() == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([0.9, 0.8]).tolist() == [1.0, 1.0]
    assert holm([]).tolist() == []


@settings(deadline=None)
@given(p=st.lists(st.floats(0, 1), min_size=1, max_size=12), data=st.data())
def test_holm_is_monotone_and_knows_no_order(p: list[float], data: st.DataObject) -> None:
    corrected = holm(p)
    assert (corrected >= np.array(p)).all()
    assert (corrected <= np.minimum(1.0, len(p) * np.array(p))).all()
    order = np.argsort(p)
    assert (np.diff(corrected[order]) >= 0.0).all()
    shuffled = data.draw(st.permutations(range(len(p))))
    assert holm([p[i] for i in shuffled]).tolist() == corrected[shuffled].tolist()
    # Holm's procedure as he wrote it: from the smallest on, until one is above level / those left.
    level, rejected = data.draw(st.floats(0.001, 0.5)), 0
    while rejected < len(p) and p[order[rejected]] * (len(p) - rejected) <= level:
        rejected += 1
    assert (corrected <= level).sum() == rejected


# Places.


def test_places_are_shared_by_those_that_cannot_be_told_apart() -> None:
    noise = np.array([0.0, 3.0, 1.0, 4.0, 2.0, 6.0, 5.0, 7.0, 9.0, 8.0])
    costs = np.array([noise + 100.0, noise, noise[::-1] + 0.5, noise + 50.0])
    ties = tie_groups(costs)
    assert ties.first.tolist() == [4, 1, 1, 3]
    assert ties.last.tolist() == [4, 2, 2, 3]
    assert ties.p_values[0, 1] == pytest.approx(6 * 2 / 2**10)  # the smallest of six comparisons
    assert ties.better[1].tolist() == [True, False, False, True]
    few = tie_groups(costs[:, :3])
    assert few.first.tolist() == [1, 1, 1, 1]
    assert few.last.tolist() == [4, 4, 4, 4]


def test_places_need_no_data() -> None:
    for shape in ((0, 0), (1, 0), (3, 0), (1, 4)):
        ties = tie_groups(np.zeros(shape))
        assert ties.first.tolist() == [1] * shape[0]
        assert ties.last.tolist() == [shape[0]] * shape[0]


@settings(deadline=None)
@given(costs=matrices(), confidence=st.sampled_from([0.5, 0.8, 0.95]), data=st.data())
def test_places_know_no_order_of_the_entrants(costs: Any, confidence: float, data: st.DataObject) -> None:
    shuffled = data.draw(st.permutations(range(len(costs))))
    ties, other = tie_groups(costs, confidence), tie_groups(costs[shuffled], confidence)
    assert other.first.tolist() == ties.first[shuffled].tolist()
    assert other.last.tolist() == ties.last[shuffled].tolist()
    assert (ties.first <= ties.last).all()
    assert ties.first.min() == 1
    assert not (ties.better & ties.better.T).any()
    shares = rank_distribution(costs)
    assert np.allclose(rank_distribution(costs[shuffled]), shares[shuffled])
    assert np.allclose(shares.sum(axis=0), 1.0)
    assert np.allclose(shares.sum(axis=1), 1.0)


def test_the_rank_distribution_by_hand() -> None:
    # Drawn from two replicates: both 0 (1/4), both 1 (1/4), one each (1/2: a mean of 0.5 for the first).
    shares = rank_distribution([[0.0, 1.0], [0.2, 0.2]])
    assert shares[0] == pytest.approx([0.25, 0.75], abs=0.03)
    assert shares[1] == pytest.approx([0.75, 0.25], abs=0.03)
    assert rank_distribution([[1.0, 2.0], [1.0, 2.0]]).tolist() == [[0.5, 0.5], [0.5, 0.5]]
    assert rank_distribution([[5.0], [1.0], [3.0]]).tolist() == [[0, 0, 1], [1, 0, 0], [0, 1, 0]]


# Learning curves.


def test_the_moving_average() -> None:
    assert moving_average([1, 2, 3, 6], 2).tolist() == [1.5, 2.5, 4.5]
    assert moving_average([1, 2], 3).tolist() == []
    assert len(moving_average(range(60))) == 11  # N_m = 50
    with pytest.raises(ValueError, match="window must be at least 1, got 0"):
        moving_average([1], 0)


def test_the_area_and_where_a_curve_settles() -> None:
    lengths = [9, 1, 9, 1, 1, 1]  # its means of two: 5, 5, 5, 1, 1
    assert area(lengths, 2) == 3.4
    assert settled(lengths, 5.0, 2) == 2  # from the end of the second episode on
    assert settled(lengths, 4.9, 2) == 5  # the fourth and fifth episodes are the first that are good enough
    assert settled(lengths, 0.9, 2) is None
    assert settled([1, 9], 4.0, 2) is None
    assert settled([1], 4.0, 2) is None
    assert math.isnan(area([1], 2))


# What the script measures.


def script() -> ModuleType:
    path = ROOT / "scripts" / "measured_coverage.py"
    spec = importlib.util.spec_from_file_location("measured_coverage", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


SCRIPT = script()
EXACT_CASES = [  # those that hold exactly, on the data that their assumptions are about
    case
    for case in SCRIPT.cases()
    if (case.what, case.data) == ("mean, Student's t", "normal")
    or (case.part in ("test", "holm", "gate") and case.replicates <= 10 and "shapes" not in case.what)
]


@pytest.mark.parametrize("case", EXACT_CASES, ids=lambda case: f"{case.what}, {case.data}, {case.replicates}")
def test_intervals_cover_and_tests_err_as_often_as_they_say(case: Any) -> None:
    """Chance alone, and the seed is fixed, would fail one in a hundred thousand of such tests."""
    trials = 300
    rate, error = SCRIPT.measure(case, trials)
    low, high = stats.binom.ppf([5e-6, 1.0 - 5e-6], trials, case.nominal) / trials
    assert rate <= high
    assert case.most or rate >= low
    assert error == pytest.approx(math.sqrt(case.nominal * (1 - case.nominal) / trials), rel=0.5)


def test_the_bootstrap_and_newcombe_cover_nearly_as_often_as_they_say() -> None:
    cases = {(case.what, case.data, case.replicates): case for case in SCRIPT.cases()}
    for what, data in (
        ("interquartile mean, bootstrap", "one in ten fails"),
        ("probability of improvement", "normal, true value 0.98"),
    ):
        rate, _ = SCRIPT.measure(cases[what, data, 10], 300)
        assert 0.90 <= rate <= 0.995, what  # 95%: five standard errors are 6%


def test_the_test_would_see_a_test_that_errs_too_often() -> None:
    rng = np.random.default_rng(0)
    p = sign_flip_test(rng.normal(0.4, 1.0, (400, 10)))  # the null hypothesis does not hold
    assert (p <= 0.05).mean() > 0.12
