"""Prioritized sweeping, by hand."""

from typing import Any

import pytest
from chain import Cells4
from walks import A, make, table

from agents.algorithms.prioritized_sweeping import PrioritizedSweeping


def swept(threshold: float, planning: int = 1) -> Any:
    """An agent that has seen 1 lead to 0, 2 lead to 0 and to 3, and now 0 lead to the goal with reward 8."""
    agent = PrioritizedSweeping.create(Cells4(), bins=4, discount=0.5, planning=planning, threshold=threshold)
    for cell, following in ((1, 0), (2, 0), (2, 3)):
        agent.learn((cell + 0.5,), 0, 0.0, (following + 0.5,), False)
    assert agent.values.tolist() == [[0.0]] * 4
    agent.learn((0.5,), 0, 8.0, (3.5,), True)
    return agent


def test_sweeping_begins_where_the_change_is_most_likely_to_matter() -> None:
    agent = swept(threshold=0.5)
    # The change of 8 has priority 8 in cell 1, and 8 times 1/2 in cell 2, which waits.
    assert agent.values.tolist() == [[8.0], [4.0], [0.0], [0.0]]
    agent.learn((3.5,), 0, 0.0, (0.5,), True)
    assert agent.values.tolist() == [[8.0], [4.0], [0.5 * (8.0 + 0.0) / 2], [0.0]]
    assert agent.visits.tolist() == [[1], [1], [2], [1]]


@pytest.mark.parametrize(("threshold", "second"), [(3.99, 2.0), (4.0, 0.0)])
def test_change_below_the_threshold_is_not_worth_a_sweep(threshold: float, second: float) -> None:
    agent = swept(threshold, planning=9)
    assert agent.values.tolist() == [[8.0], [4.0], [second], [0.0]]


def test_what_was_never_tried_keeps_its_initial_value() -> None:
    agent = make(PrioritizedSweeping, step_size=None, initial_values=-7.0)
    agent.learn(A, 1, 2.0, A, True)
    assert agent.values.tolist() == table(-7.0, 2.0, -7.0)
