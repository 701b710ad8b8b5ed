"""The rules of learning, by hand: numbers are dyadic, so that most are exact."""

import math

import numpy as np
import pytest

from agents.learning.targets import (
    bootstrapped,
    double_value,
    epsilon_greedy_value,
    greatest_value,
    softmax_value,
)
from envs.compilation import compile_loop

VALUES = np.array([[9.0, -9.0, 0.0], [1.0, 5.0, 3.0]])
JUDGE = np.array([[-9.0, 9.0, 0.0], [7.0, 4.0, 8.0]])
TIED = np.array([[0.0, 0.0], [2.0, 2.0]])


def test_a_return_is_the_reward_and_the_discounted_rest() -> None:
    assert bootstrapped(-1.0, 0.5, 3.0) == 0.5
    assert bootstrapped(-1.0, 0.5, bootstrapped(-2.0, 0.5, bootstrapped(-4.0, 0.5, 8.0))) == -2.0
    assert bootstrapped(-1.0, 0.0, math.pi) == -1.0


def test_q_learning_takes_the_greatest_value_of_the_cell() -> None:
    assert [greatest_value(VALUES, cell) for cell in (0, 1)] == [9.0, 5.0]
    assert greatest_value(-VALUES, 1) == -1.0


def test_double_q_learning_lets_one_table_judge_what_the_other_deems_best() -> None:
    assert double_value(VALUES, JUDGE, 1) == 4.0  # action 1 of JUDGE, which would itself choose 2
    assert double_value(JUDGE, VALUES, 1) == 3.0
    assert double_value(TIED, np.array([[0.0, 0.0], [1.0, 6.0]]), 1) == 1.0  # of equal ones the lowest


@pytest.mark.parametrize(
    ("epsilon", "mean"), [(0.0, 5.0), (1.0, (1.0 + 5.0 + 3.0) / 3), (0.25, 0.25 * 3.0 + 0.75 * 5.0)]
)
def test_expected_sarsa_takes_the_mean_over_an_epsilon_greedy_action(epsilon: float, mean: float) -> None:
    assert epsilon_greedy_value(VALUES, 1, epsilon) == mean


def test_expected_sarsa_takes_the_mean_over_a_softmax() -> None:
    temperature = 1 / math.log(2)  # exp(value / temperature) is 2, 32 and 8
    assert softmax_value(VALUES, 1, temperature) == pytest.approx((2 * 1 + 32 * 5 + 8 * 3) / 42, rel=1e-14)
    assert softmax_value(VALUES + 1e3, 1, 1e-3) == 1005.0  # exp of 1e6 would be infinite
    assert softmax_value(TIED, 1, 0.5) == 2.0


@pytest.mark.parametrize(
    ("rule", "arguments"),
    [
        (bootstrapped, (-1.0, 0.99, 0.3)),
        (greatest_value, (VALUES, 1)),
        (double_value, (VALUES, JUDGE, 1)),
        (epsilon_greedy_value, (VALUES / 7, 1, 0.3)),
        (softmax_value, (VALUES, 1, 0.7)),
    ],
)
def test_compiled_rules_are_the_interpreters_to_the_bit(rule, arguments) -> None:  # type: ignore[no-untyped-def]
    assert compile_loop(rule, *arguments)(*arguments) == rule(*arguments)
