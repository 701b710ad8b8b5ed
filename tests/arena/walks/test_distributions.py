"""Fits of distributions: by hand, beside scipy's own, and whether their p-values can be relied on."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from arena.walks.distributions import FAMILIES, Fit, fit_all

FEW = [1.0, 2.0, 3.0, 6.0]


def by_name(fits: list[Fit]) -> dict[str, Fit]:
    return {fit.family.name: fit for fit in fits}


def test_fits_of_four_numbers_by_hand() -> None:
    found = by_name(fit_all(FEW, bootstraps=1))
    assert found["exponential"].parameters == (0.0, 3.0)
    assert found["exponential"].log_likelihood == pytest.approx(-4 * math.log(3.0) - 4)
    assert found["exponential"].aic == pytest.approx(2 + 8 * math.log(3.0) + 8)
    assert found["shifted exponential"].parameters == (1.0, 2.0)
    assert found["shifted exponential"].log_likelihood == pytest.approx(-4 * math.log(2.0) - 4)
    assert found["shifted exponential"].aic == pytest.approx(4 + 8 * math.log(2.0) + 8)
    # At 1 none is below by the fit, and a quarter of the data is not above.
    assert found["shifted exponential"].distance == pytest.approx(0.25)
    # 1/lambda is the mean of 1/x - 1/mean = (1 + 1/2 + 1/3 + 1/6) / 4 - 1/3 = 1/6.
    assert found["inverse Gaussian"].parameters == pytest.approx((0.5, 0.0, 6.0))
    assert found["log-normal"].parameters[2] == pytest.approx(36 ** (1 / 4))


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)
@given(shape=st.floats(0.3, 5.0), scale=st.sampled_from([1e-3, 1.0, 1e5]), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=15, deadline=None)
def test_no_parameters_are_likelier_than_those_found(
    family: Any, shape: float, scale: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    x = scale * rng.gamma(shape, size=80)
    found = np.array(family.fit(x))
    best = family.law.logpdf(x, *found).sum()
    for other in found * rng.uniform(0.9, 1.1, (20, len(found))):
        assert family.law.logpdf(x, *other).sum() <= best + 1e-6


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)
def test_fits_are_those_of_scipy(family: Any) -> None:
    x = np.random.default_rng(1).gamma(1.3, 30_000.0, 400)
    fixed = {} if family.name == "shifted exponential" else {"floc": 0}
    free = family.law.fit(x, **fixed)
    assert family.fit(x) == pytest.approx(free, rel=1e-4)
    found = by_name(fit_all(x, bootstraps=1))[family.name]
    expected = stats.kstest(x, family.law(*free).cdf).statistic
    assert found.distance == pytest.approx(expected)


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)
def test_a_sample_is_recognized(family: Any) -> None:
    parameters = {"lognorm": (1.0, 0.0, 3e4), "expon": (0.0, 4e4), "invgauss": (2.0, 0.0, 2e4)}
    chosen = parameters.get(family.scipy, (3.0, 0.0, 2e4))
    if family.name == "shifted exponential":
        chosen = (2e4, 4e4)
    x = family.law.rvs(*chosen, size=1000, random_state=np.random.default_rng(2))
    fits = fit_all(x, bootstraps=39)
    assert by_name(fits)[family.name].p_value > 0.05
    # Gamma and Weibull contain the exponential, with a parameter more.
    assert by_name(fits)[family.name].aic <= fits[0].aic + 2.0
    assert [fit.aic for fit in fits] == sorted(fit.aic for fit in fits)
    assert fits[-1].p_value == 1 / 40


@pytest.mark.statistical
def test_p_values_of_true_families_are_uniform() -> None:
    # Without a fit to each sample of the bootstrap they would nearly all be above 1/2.
    rng = np.random.default_rng(3)
    found = [
        by_name(fit_all(rng.exponential(size=30), seed, bootstraps=19))["exponential"].p_value
        for seed in range(60)
    ]
    assert 18 <= sum(p <= 0.5 for p in found) <= 42  # three standard deviations


def test_the_same_seed_gives_the_same_p_values() -> None:
    x = np.random.default_rng(4).gamma(2.0, size=50)
    assert fit_all(x, 5, 50) == fit_all(x, 5, 50, n_jobs=2)
    assert fit_all(x, 5, 50) != fit_all(x, 6, 50)


@pytest.mark.parametrize(
    "bad", [[], [1.0], [2.0, 2.0], [1.0, 0.0], [1.0, -1.0], [1.0, math.nan], [[1.0, 2.0]]]
)
def test_lengths_that_no_family_fits_are_refused(bad: Any) -> None:
    with pytest.raises(
        ValueError, match=r"^lengths must be positive numbers of which at least two differ, got "
    ):
        fit_all(bad)
