"""Which distribution do lengths of episodes have? Fits by maximum likelihood, and how good they are.

When the parameters are fitted to the data, the tables of Kolmogorov and Smirnov do not hold. So the distance
is compared with those of samples from the fitted distribution, each with a fit of its own.

Sources: H. Akaike, A new look at the statistical model identification, 1974 (AIC); W. Stute, W. Gonzáles
Manteiga & M. Presedo Quindimil, Bootstrap based goodness-of-fit-tests, 1993.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from arena.common.npz import Floats
from arena.common.parallel import parallel_map_unordered
from envs.foundation.checks import integer
from envs.foundation.errors import InvalidValueError
from envs.foundation.streams import stream

BOOTSTRAPS = 199
_WIDEST = 1e6  # of the shapes that are looked for


@dataclass(frozen=True)
class Family:
    """A family of distributions on the positive numbers.

    Attributes:
        name: in words.
        scipy: its name in ``scipy.stats``.
        fit: the parameters of greatest likelihood, in scipy's order: shapes, location, scale.
        parameters: how many of them are fitted.
    """

    name: str
    scipy: str
    fit: Callable[[Floats], tuple[float, ...]]
    parameters: int

    @property
    def law(self) -> Any:
        """Scipy's distribution, whose methods take the parameters."""
        from scipy import stats

        return getattr(stats, self.scipy)


@dataclass(frozen=True)
class Fit:
    """The member of a family that fits best.

    Attributes:
        family: which one.
        parameters: of greatest likelihood, in scipy's order.
        log_likelihood: natural logarithm.
        aic: 2 k - 2 log-likelihood; less is better.
        distance: of Kolmogorov and Smirnov, the greatest between the distribution functions.
        p_value: how often a sample of the fitted distribution, fitted anew, is as far from its fit, by
            parametric bootstrap.
    """

    family: Family
    parameters: tuple[float, ...]
    log_likelihood: float
    aic: float
    distance: float
    p_value: float

    def to_dict(self) -> dict[str, Any]:
        """Plain values."""
        return {**vars(self), "family": self.family.name, "parameters": list(self.parameters)}


def _log_normal(x: Floats) -> tuple[float, ...]:
    logs = np.log(x)
    return float(logs.std()), 0.0, float(np.exp(logs.mean()))


def _exponential(x: Floats) -> tuple[float, ...]:
    return 0.0, float(x.mean())


def _shifted_exponential(x: Floats) -> tuple[float, ...]:
    return float(x.min()), float(x.mean() - x.min())


def _gamma(x: Floats) -> tuple[float, ...]:
    from scipy.optimize import brentq
    from scipy.special import psi

    gap = np.log(x.mean()) - np.log(x).mean()
    shape = brentq(lambda a: np.log(a) - psi(a) - gap, 1.0 / _WIDEST, _WIDEST)
    return float(shape), 0.0, float(x.mean() / shape)


def _weibull(x: Floats) -> tuple[float, ...]:
    from scipy.optimize import brentq

    logs = np.log(x)
    logs -= logs.max()  # so that no power overflows

    def slope(shape: float) -> float:
        """Of the likelihood, with the best scale for this shape."""
        powers = np.exp(shape * logs)
        return float(powers @ logs / powers.sum() - 1.0 / shape - logs.mean())

    shape = brentq(slope, 1.0 / _WIDEST, _WIDEST)
    return float(shape), 0.0, float(x.max() * np.mean(np.exp(shape * logs)) ** (1.0 / shape))


def _inverse_gaussian(x: Floats) -> tuple[float, ...]:
    mean = x.mean()
    scale = 1.0 / np.mean(1.0 / x - 1.0 / mean)  # lambda; scipy's shape is the mean over it
    return float(mean / scale), 0.0, float(scale)


FAMILIES = (
    Family("log-normal", "lognorm", _log_normal, 2),
    Family("exponential", "expon", _exponential, 1),
    Family("shifted exponential", "expon", _shifted_exponential, 2),
    Family("gamma", "gamma", _gamma, 2),
    Family("Weibull", "weibull_min", _weibull, 2),
    Family("inverse Gaussian", "invgauss", _inverse_gaussian, 2),
)


def fit_all(lengths: ArrayLike, seed: int = 0, bootstraps: int = BOOTSTRAPS, n_jobs: int = 1) -> list[Fit]:
    """All families fitted to the lengths, the least AIC first.

    Args:
        lengths: positive, shape (n,), at least two different ones.
        seed: of the bootstrap, at least 0; each family has a stream of its own.
        bootstraps: samples, at least 1.
        n_jobs: workers, as joblib counts them; they change no bit.

    Raises:
        TypeError, ValueError: when an argument breaks its rule.
    """
    x = np.asarray(lengths, np.float64)
    if x.ndim != 1 or len(np.unique(x)) < 2 or not (np.isfinite(x).all() and x.min() > 0.0):
        raise InvalidValueError(
            f"lengths must be positive numbers of which at least two differ, got {np.unique(x)[:3].tolist()}"
        )
    seed, bootstraps = integer("seed", seed, 0), integer("bootstraps", bootstraps, 1)
    tasks = [(family, x, seed, bootstraps) for family in FAMILIES]
    return sorted(parallel_map_unordered(n_jobs, _fit, tasks), key=lambda fit: fit.aic)


def _fit(family: Family, x: Floats, seed: int, bootstraps: int) -> Fit:
    parameters = family.fit(x)
    distance = _distance(x, family, parameters)
    rng, further = stream(seed, "bootstrap", family.name), 0
    for _ in range(bootstraps):
        sample = family.law.rvs(*parameters, size=len(x), random_state=rng)
        further += _distance(sample, family, family.fit(sample)) >= distance
    likelihood = float(family.law.logpdf(x, *parameters).sum())
    aic = 2.0 * family.parameters - 2.0 * likelihood
    # The data are a sample as well, so that p is never 0 (Davison & Hinkley 1997, 4.2).
    return Fit(family, parameters, likelihood, aic, distance, (1 + further) / (1 + bootstraps))


def _distance(x: Floats, family: Family, parameters: tuple[float, ...]) -> float:
    below = family.law.cdf(np.sort(x), *parameters)
    steps = np.arange(len(x) + 1) / len(x)
    return float(max((steps[1:] - below).max(), (below - steps[:-1]).max()))
