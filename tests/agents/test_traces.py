"""Lists of traces: consistent, forgotten with their episode, without what is negligible."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from linear_walks import Square, make, step, walks

from agents.algorithms.sarsa_lambda import SarsaLambda
from agents.algorithms.true_online_sarsa import TrueOnlineSarsa
from agents.algorithms.watkins_q_lambda import WatkinsQLambda
from agents.learning.traces import NEGLIGIBLE

SETTINGS: list[tuple[type[Any], dict[str, Any]]] = [
    (SarsaLambda, {}),
    (SarsaLambda, {"traces": "accumulating"}),
    (SarsaLambda, {"clear_others": True}),
    (TrueOnlineSarsa, {}),
    (TrueOnlineSarsa, {"bins": (5, 6)}),
    (WatkinsQLambda, {}),
    (WatkinsQLambda, {"traces": "accumulating", "bins": 6}),
]


CLASSES = [SarsaLambda, TrueOnlineSarsa, WatkinsQLambda]


@pytest.mark.parametrize("cls", CLASSES)
def test_no_trace_outlives_its_episode(cls: type[Any]) -> None:
    agent = make(cls)
    for end in (False, True):
        agent.begin_episode()
        agent.learn(*step(0, 0, 0.0, 1, 0, end))
        agent.begin_episode()
        agent.learn(*step(2, 0, 8.0, 3, 0, True))
        assert agent.weights[0].tolist() == [0.0, 0.0, 0.0]
    assert agent.weights[2, 0] == 4.0 + 0.5 * (8.0 - 4.0)


def test_negligible_trace_is_dropped_and_no_other() -> None:
    agent = make(SarsaLambda, trace_decay=0.5)
    steps = math.ceil(math.log(NEGLIGIBLE) / math.log(0.25))
    agent.begin_episode()
    agent.learn(*step(0, 0, 0.0, 1, 0))
    for _ in range(steps - 2):
        agent.learn(*step(1, 0, 0.0, 1, 0))
    assert agent.memory.length[0] == 2
    agent.learn(*step(1, 0, 0.0, 1, 0))
    assert agent.memory.length[0] == 1
    assert agent.memory.positions.tolist() == [-1, -1, -1, 0] + [-1] * 8


@settings(deadline=None, max_examples=60)
@given(
    seed=st.integers(0, 2**32),
    decay=st.floats(0, 1),
    step_size=st.floats(0.01, 2),
    setting=st.sampled_from(SETTINGS),
)
def test_list_of_traces_is_consistent(
    seed: int, decay: float, step_size: float, setting: tuple[type[Any], dict[str, Any]]
) -> None:
    cls, parameters = setting
    agent = cls.create(Square(), **{**parameters, "trace_decay": decay, "step_size": step_size})
    traces = agent.memory.traces if cls is TrueOnlineSarsa else agent.memory
    for walk in walks(seed, 2, episodes=3):
        agent.begin_episode()
        assert traces.length[0] == 0
        for one in walk:
            agent.learn(*one)
            length = traces.length[0]
            assert traces.positions[traces.weights[:length]].tolist() == list(range(length))
            assert np.count_nonzero(traces.positions >= 0) == length
            assert np.all(np.abs(traces.values[:length]) >= NEGLIGIBLE)
