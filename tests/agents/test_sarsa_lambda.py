"""Sarsa(lambda): by hand with discount and lambda 1/2, and against the book's boxes."""

from typing import Any

import numpy as np
import pytest
from linear_walks import book_traces, learned, make, on_tasks, rates, step, weights

from agents.algorithms.sarsa_lambda import SarsaLambda
from agents.algorithms.semi_gradient_sarsa import SemiGradientSarsa
from agents.algorithms.true_online_sarsa import TrueOnlineSarsa


@pytest.mark.parametrize(
    ("traces", "clear_others", "there", "other"),
    [
        # The trace of cell 0, action 0 is 1 + 1/16 or 1, that of action 1 there is 1/4 or removed.
        ("accumulating", False, 1.0625, 0.25),
        ("replacing", False, 1.0, 0.25),
        ("replacing", True, 1.0, 0.0),
    ],
)
def test_sarsa_lambda_moves_weights_by_their_traces(
    traces: str, clear_others: bool, there: float, other: float
) -> None:
    agent = make(SarsaLambda, trace_decay=0.5, traces=traces, clear_others=clear_others)
    agent.begin_episode()
    for visit in (step(0, 0, 0.0, 0, 1), step(0, 1, 0.0, 0, 0), step(0, 0, 8.0, 1, 0)):
        agent.learn(*visit)
    assert agent.weights.tolist() == weights({(0, 0): 4.0 * there, (0, 1): 4.0 * other})


@on_tasks
@pytest.mark.parametrize("decay", [0.0, 0.5, 0.95, 1.0])
@pytest.mark.parametrize("traces", ["accumulating", "replacing", "clearing", "dutch"])
def test_sarsa_lambda_is_the_books(task: Any, parameters: dict[str, Any], traces: Any, decay: float) -> None:
    given: dict[str, Any] = {**rates, **parameters, "trace_decay": decay}
    if traces == "dutch":  # with a large step size some traces are negative
        agent: Any = TrueOnlineSarsa.create(task, **{**given, "step_size": 1.5})
    elif traces == "clearing":
        agent = SarsaLambda.create(task, traces="replacing", clear_others=True, **given)
    else:
        agent = SarsaLambda.create(task, traces=traces, **given)
    assert learned(agent, 2) == pytest.approx(book_traces(agent, 2, traces, decay), rel=1e-6, abs=1e-7)


@pytest.mark.parametrize("cls", [SarsaLambda, TrueOnlineSarsa])
@on_tasks
def test_lambda_zero_is_one_step_sarsa(cls: Any, task: Any, parameters: dict[str, Any]) -> None:
    one_step = learned(SemiGradientSarsa.create(task, **rates, **parameters), 4)
    assert np.count_nonzero(one_step) > 10
    found = learned(cls.create(task, trace_decay=0.0, **rates, **parameters), 4)
    if cls is SarsaLambda:
        assert np.array_equal(found, one_step)
    else:  # the same up to rounding
        assert found == pytest.approx(one_step, rel=1e-12, abs=1e-14)
