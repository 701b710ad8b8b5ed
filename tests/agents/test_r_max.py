"""R-MAX, by hand."""

import numpy as np
import pytest
from chain import Cells4, Chain

from agents.algorithms.r_max import RMax


def test_what_is_not_known_is_worth_the_greatest_return() -> None:
    agent = RMax.create(Chain(), bins=5, known=3, greatest_return=10.0, discount=0.5)
    for visit in range(3):
        assert np.all(agent.values == 10.0)
        agent.learn((0.5,), 0, -1.0 - visit, (1.5,), False)
    assert agent.values[0].tolist() == [-2.0 + 0.5 * 10.0, 10.0]
    assert agent.greedy((0.5,)) == agent.act((0.5,), 0.0, np.random.default_rng(1)) == 1


def test_values_are_computed_anew_when_the_visits_of_a_pair_have_doubled() -> None:
    agent = RMax.create(Chain(), bins=5, known=1)
    found = []
    for reward in (-1.0, -3.0, -8.0, -4.0, -9.0):  # means -1, -2, -4, -4, -5
        agent.learn((0.5,), 0, reward, (0.5,), True)
        found.append(agent.values[0, 0])
    assert found == [-1.0, -2.0, -2.0, -4.0, -4.0]


@pytest.mark.parametrize(("tolerance", "value"), [(0.0, -3.0), (0.99, -3.0), (1.0, -1.0)])
def test_value_iteration_stops_after_its_sweeps_or_when_little_changes(
    tolerance: float, value: float
) -> None:
    agent = RMax.create(Cells4(), bins=4, known=1, sweeps=3, tolerance=tolerance, discount=1.0)
    agent.learn((1.5,), 0, -1.0, (1.5,), False)  # each sweep finds one step more in this circle
    assert agent.values.tolist() == [[0.0], [value], [0.0], [0.0]]
