"""Watkins's Q(lambda): by hand, and against the book's box."""

from typing import Any

import pytest
from linear_walks import book_traces, learned, make, on_tasks, rates, step

from agents.algorithms.watkins_q_lambda import WatkinsQLambda


@pytest.mark.parametrize(
    ("next_action", "kept"),
    [
        (1, 0.25),  # greedy
        (2, 0.25),  # as good as the best
        (0, 0.0),  # explores: the traces are cut
    ],
)
@pytest.mark.parametrize("traces", ["accumulating", "replacing"])
def test_watkins_cuts_the_traces_after_an_action_that_explores(
    traces: str, next_action: int, kept: float
) -> None:
    agent = make(WatkinsQLambda, trace_decay=0.5, traces=traces)
    agent.weights[1] = [2.0, 4.0, 4.0]
    agent.begin_episode()
    agent.learn(*step(0, 0, -2.0, 1, next_action))  # -2 + 0.5 * 4, the best value, is no error at all
    assert agent.weights[0].tolist() == [0.0, 0.0, 0.0]
    value = agent.weights[1, next_action]
    agent.learn(*step(1, next_action, value + 8.0, 2, 0))  # an error of 8
    assert agent.weights[1, next_action] == value + 4.0
    assert agent.weights[0].tolist() == [4.0 * kept, 0.0, 0.0]


def test_watkins_judges_the_next_action_before_the_update() -> None:
    agent = make(WatkinsQLambda, trace_decay=0.5)
    agent.weights[0] = [4.0, 2.0, 0.0]
    agent.begin_episode()
    # Action 0 is the best when it is chosen; the update itself makes action 1 better.
    agent.learn(*step(0, 0, -8.0, 0, 0))
    assert agent.weights[0].tolist() == [4.0 + 0.5 * (-8.0 + 2.0 - 4.0), 2.0, 0.0]
    assert agent.memory.length[0] == 1


@on_tasks
@pytest.mark.parametrize("decay", [0.5, 1.0])
@pytest.mark.parametrize("traces", ["accumulating", "replacing"])
def test_watkins_is_the_books(task: Any, parameters: dict[str, Any], traces: Any, decay: float) -> None:
    agent = WatkinsQLambda.create(task, traces=traces, trace_decay=decay, **rates, **parameters)
    expected = book_traces(agent, 3, traces, decay, watkins=True)
    assert learned(agent, 3) == pytest.approx(expected, rel=1e-6, abs=1e-7)
