"""How agents explore: what is chosen how often, and the mean value of it."""

import math
from typing import Any

import numpy as np
import pytest

from agents import LinearDecay, Softmax, UpperConfidence
from agents.learning.exploration import EpsilonGreedy, make_exploration

VALUES = np.array([[9.0, -9.0, 0.0], [1.0, 2.0, 0.5]])
VISITS = np.array([[1, 1, 1], [4, 40, 3]])
MANY = 20_000


def shares(policy: Any, progress: float, values: Any = VALUES, visits: Any = VISITS) -> list[float]:
    """How often each action is chosen in cell 1."""
    rng = np.random.default_rng(1)
    chosen = [policy.choose(values, visits, 1, progress, rng) for _ in range(MANY)]
    return [chosen.count(action) / MANY for action in range(3)]


def assert_chosen(policy: Any, progress: float, expected: list[float]) -> None:
    for share, p in zip(shares(policy, progress), expected, strict=True):
        assert abs(share - p) <= 4 * math.sqrt(p * (1 - p) / MANY)
    mean = sum(p * value for p, value in zip(expected, VALUES[1], strict=True))
    assert policy.expected(VALUES, VISITS, 1, progress) == pytest.approx(mean, rel=1e-12)


@pytest.mark.parametrize(
    ("progress", "epsilon"), [(0.0, 0.9), (0.25, 0.6), (0.5, 0.3), (0.75, 0.3), (1.0, 0.3)]
)
def test_epsilon_greedy(progress: float, epsilon: float) -> None:
    policy = EpsilonGreedy(LinearDecay(0.9, 0.3, 0.5))
    assert_chosen(policy, progress, [epsilon / 3, 1 - epsilon + epsilon / 3, epsilon / 3])


@pytest.mark.parametrize(("progress", "temperature"), [(0.0, 2.0), (0.5, 1.25), (1.0, 0.5)])
def test_softmax(progress: float, temperature: float) -> None:
    weights = np.exp(VALUES[1] / temperature)
    assert_chosen(Softmax(2.0, 0.5), progress, list(weights / weights.sum()))


@pytest.mark.parametrize("shift", [-1e6, 1e6])
def test_softmax_bears_values_of_any_size(shift: float) -> None:
    assert shares(Softmax(0.5, 0.5), 0.0, VALUES + shift) == shares(Softmax(0.5, 0.5), 0.0)
    assert shares(Softmax(0.5, 0.5), 0.0, VALUES * 1e6) == [0.0, 1.0, 0.0]


@pytest.mark.parametrize("c", [0.0, 0.5, 1.0, 2.0, 5.0])
def test_upper_confidence_takes_the_greatest_bound(c: float) -> None:
    bounds = VALUES[1] + c * np.sqrt(math.log(47) / VISITS[1])
    policy = UpperConfidence(c)
    assert policy.choose(VALUES, VISITS, 1, 0.5, np.random.default_rng(1)) == int(np.argmax(bounds))
    assert policy.expected(VALUES, VISITS, 1, 0.5) == 2.0


def test_upper_confidence_takes_each_bound_for_the_greatest_somewhere() -> None:
    chosen = {
        UpperConfidence(c).choose(VALUES, VISITS, 1, 0.0, np.random.default_rng(1)) for c in (1.0, 2.0, 5.0)
    }
    assert chosen == {0, 1, 2}


@pytest.mark.parametrize(("visits", "first"), [([0, 0, 0], 0), ([3, 0, 0], 1), ([1, 99, 0], 2)])
def test_upper_confidence_tries_everything_first(visits: list[int], first: int) -> None:
    counts = np.array([[1, 1, 1], visits])
    assert UpperConfidence(0.0).choose(VALUES, counts, 1, 0.0, np.random.default_rng(1)) == first


def test_choice_of_exploration() -> None:
    assert make_exploration(0.25, None) == EpsilonGreedy(LinearDecay(0.25, 0.25))
    assert make_exploration(LinearDecay(0.5, 0.1), None) == EpsilonGreedy(LinearDecay(0.5, 0.1))
    assert make_exploration(0.25, Softmax(3.0, 1.0)) == Softmax(3.0, 1.0)
    assert make_exploration(0.25, UpperConfidence(3.0)) == UpperConfidence(3.0)


@pytest.mark.parametrize(
    ("kind", "field", "bad"),
    [
        (Softmax, "start", 0.0),
        (Softmax, "end", -1.0),
        (UpperConfidence, "c", -0.5),
        (LinearDecay, "until", 0.0),
    ],
)
def test_bad_parameter_is_refused_by_name(kind: Any, field: str, bad: float) -> None:
    with pytest.raises(ValueError, match=f"^{field} must be .*, got {bad}$"):
        kind(**{field: bad})


@pytest.mark.parametrize(
    ("progress", "value"), [(0.0, 1.0), (0.1, 0.75), (0.2, 0.5), (0.4, 0.0), (0.41, 0.0), (0.99, 0.0)]
)
def test_linear_decay_is_over_when_it_is_said(progress: float, value: float) -> None:
    assert LinearDecay(1.0, 0.0, 0.4).at(progress) == value
