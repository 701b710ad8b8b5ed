"""Semi-gradient n-step Sarsa: by hand, and against the book's box."""

from typing import Any

import numpy as np
import pytest
from linear_walks import Square, book_n_step, learned, make, on_tasks, rates, step, walks, weights

from agents import HarmonicRate, Sarsa
from agents.algorithms.semi_gradient_sarsa import SemiGradientSarsa


def test_two_step_sarsa_learns_one_step_late_from_two_rewards_and_the_value_after_them() -> None:
    agent = make(SemiGradientSarsa, n=2)
    agent.weights[2, 1] = 16.0
    agent.begin_episode()
    agent.learn(*step(0, 0, -1.0, 1, 2))
    assert agent.weights.tolist() == weights({(2, 1): 16.0})
    agent.learn(*step(1, 2, -2.0, 2, 1))
    first = 0.5 * (-1.0 + 0.5 * -2.0 + 0.25 * 16.0)
    assert agent.weights.tolist() == weights({(0, 0): first, (2, 1): 16.0})
    agent.learn(*step(2, 1, -4.0, 3, 0, end=True))
    second, third = 0.5 * (-2.0 + 0.5 * -4.0), 16.0 + 0.5 * (-4.0 - 16.0)
    assert agent.weights.tolist() == weights({(0, 0): first, (1, 2): second, (2, 1): third})


def test_steps_that_wait_at_a_time_limit_are_learned_when_the_next_episode_begins() -> None:
    agent = make(SemiGradientSarsa, n=3)
    agent.weights[2, 1] = 16.0
    agent.begin_episode()
    agent.learn(*step(0, 0, -1.0, 1, 2))
    agent.learn(*step(1, 2, -2.0, 2, 1))
    assert agent.weights.tolist() == weights({(2, 1): 16.0})
    agent.begin_episode()
    first, second = 0.5 * (-1.0 + 0.5 * -2.0 + 0.25 * 16.0), 0.5 * (-2.0 + 0.5 * 16.0)
    assert agent.weights.tolist() == weights({(0, 0): first, (1, 2): second, (2, 1): 16.0})
    agent.begin_episode()  # nothing is left
    assert agent.weights.tolist() == weights({(0, 0): first, (1, 2): second, (2, 1): 16.0})


def test_as_many_steps_as_an_episode_has_give_its_returns() -> None:
    agent = make(SemiGradientSarsa, n=50, step_size=1.0)
    agent.begin_episode()
    for one in (
        step(0, 0, 1.0, 1, 1),
        step(1, 1, 2.0, 2, 2),
        step(2, 2, 4.0, 3, 0),
        step(3, 0, 8.0, 0, 0, True),
    ):
        agent.learn(*one)
    assert agent.weights.tolist() == weights({(0, 0): 4.0, (1, 1): 6.0, (2, 2): 8.0, (3, 0): 8.0})


@on_tasks
@pytest.mark.parametrize("n", [1, 2, 3, 5, 1000])
def test_n_step_sarsa_is_the_books(task: Any, parameters: dict[str, Any], n: int) -> None:
    agent = SemiGradientSarsa.create(task, n=n, **rates, **parameters)
    assert learned(agent, 1) == pytest.approx(book_n_step(agent, 1, n), rel=1e-9, abs=1e-12)


def test_one_step_on_a_grid_is_tabular_sarsa_to_the_bit() -> None:
    tabular = Sarsa.create(Square(), bins=(3, 4), discount=0.9, step_size=HarmonicRate(0.25, 1.0, 0.0))
    for walk in walks(5, 2):
        for one in walk:
            tabular.learn(*one)
    linear = SemiGradientSarsa.create(Square(), bins=(3, 4), discount=0.9, step_size=0.25)
    assert np.array_equal(learned(linear, 5), tabular.values)
