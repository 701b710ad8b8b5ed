"""What is held of every agent that compiles."""

from typing import Any

import numpy as np
from bits import bits_of

from agents import Softmax, UpperConfidence
from arena import Entrant, Evaluation, Tournament, Training, run
from arena.execution.loops import TrainingLoop, episode_hook, learning_order, train
from envs import Hill
from envs.compilation import kernel_info

NEAR = Hill(goal_position=-0.44, min_start=-0.65, max_start=-0.45)
"""A hill whose goal is reached in some episodes by rolling, in others by chance or not at all."""

KINDS: list[dict[str, Any]] = [
    {"bins": (4, 5), "explore": UpperConfidence()},
    {"bins": (4, 5), "binning": "quantile"},
    {"bins": (4, 5), "binning": "kmeans", "explore": Softmax()},
]
"""Each kind of cells, and each kind of exploration."""


def assert_same_bits_from_both_drivers(cls: type[Any], parameters: dict[str, Any], limit: int = 60) -> None:
    """Compiled and interpreted, the agent learns the same, of goals and of time limits."""
    entrant = Entrant("it", cls, **parameters)
    race = Tournament((entrant,), NEAR, Training(12, limit), Evaluation(5, limit), replicates=2)
    with (
        run(race, n_jobs=1, driver="compiled") as compiled,
        run(race, n_jobs=1, driver="pettingzoo") as interpreted,
    ):
        assert set(compiled.frame().status) == set(interpreted.frame().status) == {"finished"}
        assert bits_of(compiled) == bits_of(interpreted)
        lengths = [compiled.arrays("it", replicate)["lengths"] for replicate in range(2)]
    assert np.min(lengths) < limit == np.max(lengths)


def assert_allocates_nothing(cls: type[Any], parameters: dict[str, Any]) -> None:
    """The kernel of training is the one without reference counts."""
    agent = Entrant("it", cls, **parameters).create(NEAR, np.random.default_rng(0))
    streams = np.random.default_rng(1), np.random.default_rng(2)
    parts = NEAR, agent, episode_hook(agent), learning_order(agent)
    loop = TrainingLoop(*parts, 3, 2, 50, *streams, np.zeros(2, np.int64))
    assert not kernel_info(train, loop, 0, 2).counts_references
