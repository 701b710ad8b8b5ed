"""Do the intervals cover, and do the tests cry wolf, as often as they say? On data with known truth.

    python scripts/measured_coverage.py --trials 2000

prints the Markdown table of docs/statistics.md. In each trial data are drawn anew, and it is looked whether
an interval holds the truth, or whether a test finds a difference that is not there.
"""

import argparse
import math
import zlib
from collections.abc import Callable, Iterator
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena.statistics.intervals import (
    Estimate,
    bootstrap_interval,
    interquartile_mean,
    mean_estimate,
    probability_of_improvement,
)
from arena.statistics.permutation import holm, paired_permutation_test, sign_flip_test, smallest_p
from arena.statistics.ranks import tie_groups
from arena.statistics.sequential import decided, looks

Floats = NDArray[np.float64]
Draw = Callable[[np.random.Generator, tuple[int, ...]], Floats]

DATA: dict[str, Draw] = {
    "normal": lambda rng, shape: rng.normal(150.0, 10.0, shape),
    "skewed (lognormal)": lambda rng, shape: 120.0 + rng.lognormal(3.0, 0.8, shape),
    "one in ten fails": lambda rng, shape: np.where(
        rng.random(shape) < 0.1, rng.normal(350.0, 60.0, shape), rng.normal(150.0, 8.0, shape)
    ),
    "piled up at 100%": lambda rng, shape: np.minimum(100.0, rng.normal(99.5, 3.0, shape)),
}


class Case(NamedTuple):
    """A claim that can be tried.

    Attributes:
        part: what the script's ``--parts`` calls it.
        what, data, replicates: what is tried, on what.
        nominal: how often ``trial`` should be true.
        most: whether that is the most that is allowed, and less is no fault.
        trial: draws data and says whether it happened.
    """

    part: str
    what: str
    data: str
    replicates: int
    nominal: float
    most: bool
    trial: Callable[[np.random.Generator], bool]


@cache
def truth(data: str) -> tuple[float, float]:
    """Mean and interquartile mean of the population, from a million draws."""
    values = DATA[data](np.random.default_rng(1), (1_000_000,))
    return float(values.mean()), float(interquartile_mean(values))


def holds(estimate: Estimate, true: float) -> bool:
    """Whether the interval holds the truth; an interval of one point may be off by rounding."""
    return estimate.low - 1e-9 <= true <= estimate.high + 1e-9


def intervals() -> Iterator[Case]:
    """Of the mean and the interquartile mean."""
    for data, draw in DATA.items():
        for n in (5, 10, 20):

            def mean(rng: np.random.Generator, draw: Draw = draw, n: int = n, data: str = data) -> bool:
                return holds(mean_estimate(draw(rng, (n,))), truth(data)[0])

            def iqm(rng: np.random.Generator, draw: Draw = draw, n: int = n, data: str = data) -> bool:
                return holds(bootstrap_interval(draw(rng, (n,))), truth(data)[1])

            def other(rng: np.random.Generator, draw: Draw = draw, n: int = n, data: str = data) -> bool:
                return holds(bootstrap_interval(draw(rng, (n,)), np.mean), truth(data)[0])

            yield Case("mean", "mean, Student's t", data, n, 0.95, False, mean)
            yield Case("mean", "mean, bootstrap (not used)", data, n, 0.95, False, other)
            yield Case("iqm", "interquartile mean, bootstrap", data, n, 0.95, False, iqm)


def probabilities() -> Iterator[Case]:
    """Of the probability of improvement: normal values, a shift and a scale between the two."""
    for shift, scale in ((0.0, 1.0), (1.0, 1.0), (3.0, 1.0), (1.0, 4.0)):
        true = 0.5 + 0.5 * math.erf(shift / math.sqrt(2.0 * (1.0 + scale**2)))
        for n in (5, 10, 20):

            def trial(
                rng: np.random.Generator, n: int = n, a: float = shift, b: float = scale, p: float = true
            ) -> bool:
                return holds(probability_of_improvement(rng.normal(a, b, n), rng.normal(size=n)), p)

            def other(
                rng: np.random.Generator, n: int = n, a: float = shift, b: float = scale, p: float = true
            ) -> bool:
                return holds(resampled(rng.normal(a, b, n), rng.normal(size=n), rng), p)

            data = f"normal, true value {true:.2f}" + (", unequal spread" if scale != 1.0 else "")
            yield Case("probability", "probability of improvement", data, n, 0.95, False, trial)
            if shift == 3.0:
                what = "probability of improvement, bootstrap (not used)"
                yield Case("probability", what, data, n, 0.95, False, other)


def resampled(x: Floats, y: Floats, rng: np.random.Generator) -> Estimate:
    """The probability of improvement with the percentiles of a bootstrap."""
    signs = 0.5 + 0.5 * np.sign(x[:, None] - y[None, :])
    first, second = (rng.multinomial(len(one), np.full(len(one), 1.0 / len(one)), 1000) for one in (x, y))
    values = np.einsum("bi,ij,bj->b", first, signs, second) / (len(x) * len(y))
    low, high = np.quantile(values, [0.025, 0.975])
    return Estimate(float(signs.mean()), float(low), float(high))


def tests() -> Iterator[Case]:
    """False positives of one test at 5%."""
    for data, draw in DATA.items():
        for n in (6, 10, 20):

            def trial(rng: np.random.Generator, draw: Draw = draw, n: int = n) -> bool:
                return paired_permutation_test(*draw(rng, (2, n))) <= 0.05

            # Of the p-values that there can be, the largest that is no more than 5%.
            step = smallest_p(n)
            ties = data == "piled up at 100%"
            nominal = 0.05 if ties else math.floor(0.05 / step) * step
            yield Case("test", "paired permutation test", data, n, nominal, ties, trial)
    for n in (10, 20):

        def unlike(rng: np.random.Generator, n: int = n) -> bool:
            skewed = DATA["skewed (lognormal)"]
            same_mean = rng.normal(truth("skewed (lognormal)")[0], 10.0, n)
            return paired_permutation_test(skewed(rng, (n,)), same_mean) <= 0.05

        yield Case("test", "same, other shapes", "lognormal and normal, equal means", n, 0.05, True, unlike)


def families() -> Iterator[Case]:
    """False positives of any of many tests."""
    for data in ("normal", "one in ten fails"):

        def equal(rng: np.random.Generator, draw: Draw = DATA[data]) -> bool:
            return bool(tie_groups(draw(rng, (4, 10))).better.any())

        def one_better(rng: np.random.Generator, draw: Draw = DATA[data]) -> bool:
            costs = draw(rng, (4, 10))
            costs[0] -= 60.0
            return bool(tie_groups(costs).better[1:].any())

        def gate(rng: np.random.Generator, draw: Draw = DATA[data]) -> bool:
            worse = draw(rng, (4, 10)) - draw(rng, (4, 10))
            return bool((holm(sign_flip_test(worse, one_sided=True)) <= 0.05).any())

        def outside(rng: np.random.Generator, draw: Draw = DATA[data]) -> bool:
            ties = tie_groups(draw(rng, (4, 10)) + np.array([[0.0], [20.0], [20.0], [60.0]]))
            best, worst = np.array([1, 2, 2, 4]), np.array([1, 3, 3, 4])
            return bool(((ties.first > worst) | (ties.last < best)).any())

        yield Case("holm", "any false difference, 4 equal", data, 10, 0.05, True, equal)
        yield Case("holm", "any false difference, 1 of 4 better", data, 10, 0.05, True, one_better)
        yield Case("holm", "any place outside its range, 4 that differ", data, 10, 0.05, True, outside)
        yield Case("gate", "any false regression, 4 equal", data, 10, 0.05, True, gate)


def sequential() -> Iterator[Case]:
    """False positives over all looks, and what is saved."""
    plan = looks(3, 20, 0.95)

    def any_look(rng: np.random.Generator) -> bool:
        costs = DATA["normal"](rng, (3, 20))
        return any(tie_groups(costs[:, : at.replicates], 1.0 - at.level).better.any() for at in plan)

    def wrong(rng: np.random.Generator) -> bool:
        costs = DATA["normal"](rng, (3, 20)) - np.array([[0.0], [12.0], [0.0]])
        for at in plan:
            if decided(costs, at):
                return bool(costs[:, : at.replicates].mean(axis=1).argmin() != 1)
        return False

    yield Case("adaptive", "any false difference at any look, 3 equal", "normal", 20, 0.05, True, any_look)
    yield Case("adaptive", "the wrong leader, 1 of 3 better", "normal", 20, 0.05, True, wrong)


def cases() -> list[Case]:
    """All of them."""
    return [*intervals(), *probabilities(), *tests(), *families(), *sequential()]


def measure(case: Case, trials: int) -> tuple[float, float]:
    """How often it happened, and the sampling error of that."""
    identity = f"{case.what} {case.data} {case.replicates}".encode()
    rng = np.random.default_rng(zlib.crc32(identity))
    rate = sum(case.trial(rng) for _ in range(trials)) / trials
    return rate, math.sqrt(max(rate * (1.0 - rate), case.nominal * (1.0 - case.nominal)) / trials)


def used(trials: int) -> list[tuple[float, float, float]]:
    """By how much one of three is better, in standard deviations: replicates used of 50, share decided."""
    plan = looks(3, 50, 0.95)
    found = []
    for better in (0.5, 1.0, 2.0, 4.0):
        rng = np.random.default_rng(0)
        counts, ends = [], 0
        for _ in range(trials):
            costs = rng.normal(size=(3, 50)) - np.array([[better], [0.0], [0.0]])
            at = next((look.replicates for look in plan if decided(costs, look)), None)
            counts.append(50 if at is None else at)
            ends += at is not None
        found.append((better, float(np.mean(counts)), ends / trials))
    return found


def main() -> None:
    """Parse, try, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--trials", type=int, default=2000)
    parser.add_argument("--parts", nargs="+", choices=sorted({case.part for case in cases()} | {"saved"}))
    arguments = parser.parse_args()
    print("| what | data | replicates | nominal | measured | sampling error |")
    print("|---|---|---:|---:|---:|---:|")
    for case in cases():
        if arguments.parts is None or case.part in arguments.parts:
            rate, error = measure(case, arguments.trials)
            nominal = f"{'at most ' if case.most else ''}{100.0 * case.nominal:.1f}%"
            print(
                f"| {case.what} | {case.data} | {case.replicates} | {nominal} "
                f"| {100.0 * rate:.1f}% | {100.0 * error:.1f}% |",
                flush=True,
            )
    if arguments.parts is None or "saved" in arguments.parts:
        print("\n| better by, in standard deviations | mean replicates, of 50 | decided |")
        print("|---:|---:|---:|")
        for better, count, share in used(max(1, arguments.trials // 20)):
            print(f"| {better:g} | {count:.1f} | {100.0 * share:.0f}% |", flush=True)


if __name__ == "__main__":
    main()
