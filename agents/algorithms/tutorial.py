"""The Q-learning of the tutorial that the paper starts from, digitized."""

from typing import Any, Self

import numpy as np

from agents.algorithms.q_learning import QLearning
from agents.contract import Task
from agents.learning.schedules import LinearDecay
from agents.parameters.declared import validated
from agents.parameters.inheritance import inherits


class TutorialQLearning(QLearning):
    """Q-learning with the tutorial's parameters in place of the paper's.

    Step size 0.1, discount 0.95, table from U(-2, 0), 20x20 cells, epsilon from 1 to 0 at half of the
    episodes, and a goal step sets the value to 0. In one thing it differs: the tutorial makes no
    update in the step in which the time runs out. An agent is not told of the time limit, so here
    that step, one an episode, is learned like any other.
    """

    __slots__ = ()

    @classmethod
    @validated
    @inherits(
        QLearning.create,
        bins=20,
        discount=0.95,
        step_size=0.1,
        epsilon=LinearDecay(1.0, 0.0, 0.5),
        initial_values=(-2.0, 0.0),
        goal="zero",
    )
    def create(cls, task: Task, *, rng: np.random.Generator | None = None, **inherited: Any) -> Self:
        """The agent before it has learned anything.

        Args:
            task: the hill.
            rng: draws the initial values.
            inherited: see ``Tabular.create``; the defaults are the tutorial's.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        return super().create(task, rng=rng, **inherited)
