"""Dyna-Q and Dyna-Q+, by hand."""

import math
from typing import Any

import numpy as np
import pytest
from walks import A, B, Square, episodes, learn_all, make, table

from agents import HarmonicRate, QLearning
from agents.algorithms.dyna_q import DynaQ


class Draws:
    """Random numbers as they are told."""

    def __init__(self, *numbers: float) -> None:
        self.numbers = list(numbers)

    def random(self) -> float:
        return self.numbers.pop(0)


def with_draws(agent: Any, *numbers: float) -> Any:
    return agent._replace(memory=agent.memory._replace(rng=Draws(*numbers)))


@pytest.mark.parametrize(
    "rule",
    [{}, {"goal": "bootstrap", "count_visits": "episode"}, {"goal": "zero", "count_visits": "state"}],
)
def test_dyna_q_without_planning_is_q_learning(rule: dict[str, Any]) -> None:
    one = learn_all(DynaQ.create(Square(), bins=3, planning=0, **rule), episodes(1))
    other = learn_all(QLearning.create(Square(), bins=3, **rule), episodes(1))
    assert np.array_equal(one.values, other.values)
    assert np.array_equal(one.visits, other.visits)


def test_dyna_q_repeats_what_it_saw_last() -> None:
    agent = with_draws(make(DynaQ, planning=2), 0.0, 0.99, 0.6, 0.4, 0.0, 0.0)
    agent.learn(A, 0, -1.0, B, False)  # pair (A, 0) is all that was seen: it is learned three times
    value = 0.0
    for _ in range(3):
        value += 0.25 * (-1.0 + 0.5 * 5.0 - value)
    assert agent.values.tolist() == table(value, 0.0, 0.0)
    agent.learn(A, 2, 8.0, B, True)  # then (A, 2), which nothing follows, and (A, 0) once more
    after = 2.0 + 0.25 * (8.0 - 2.0)
    value += 0.25 * (1.5 - value)
    assert agent.values.tolist() == table(value, 0.0, after)
    agent.learn(A, 0, 3.0, A, False)  # from now on (A, 0) leads to A with reward 3
    for _ in range(3):
        value += 0.25 * (3.0 + 0.5 * max(value, after) - value)
    assert agent.values.tolist() == table(value, 0.0, after)
    assert agent.visits.tolist() == [[2, 0, 1], [0, 0, 0]]  # what is repeated is no visit


def test_step_size_of_what_is_repeated_follows_the_visits() -> None:
    agent = make(DynaQ, planning=1, step_size=HarmonicRate(1.0, 2.0, 2.0))
    agent.learn(A, 0, 8.0, B, True)
    assert agent.values[0, 0] == 4.0 + 0.25 * (8.0 - 4.0)  # the visit, then one after it


def test_curiosity_raises_rewards_of_what_was_not_tried_for_long() -> None:
    agent = with_draws(make(DynaQ, planning=1, curiosity=3.0), 0.0, 0.9, 0.9, 0.9, 0.0)
    agent.learn(A, 0, 0.0, B, True)
    for _ in range(3):
        agent.learn(A, 1, 0.0, B, True)
    assert agent.values.tolist() == table(0.0, 0.0, 0.0)  # what is repeated at once has no bonus
    agent.learn(A, 1, 0.0, B, True)  # repeats (A, 0), which was tried four steps ago
    assert agent.values.tolist() == table(0.25 * 3.0 * math.sqrt(4), 0.0, 0.0)
