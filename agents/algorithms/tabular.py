"""A table of action values over cells, and how the agent explores."""

from typing import Generic, Literal, NamedTuple, Self, TypeVar

import numpy as np

from agents.contract import Floats, Integers, Observation, Task
from agents.discretization.cells import Binning, Bins, Cells, make_cells
from agents.learning.action_values import best_action
from agents.learning.exploration import Exploration, Softmax, UpperConfidence, make_exploration
from agents.learning.schedules import HarmonicRate, LinearDecay
from agents.learning.updates import Update, make_update
from agents.parameters.declared import Probability, StepSize
from agents.parameters.validation import validated
from envs.foundation.checks import number

Memory = TypeVar("Memory")

OF_THE_UPDATE = ("step_size", "count_visits", "goal")
"""Parameters without a use for agents that compute their values from a model."""


class TabularAgent(NamedTuple, Generic[Memory]):
    """What Q-learning, SARSA and their kin share (paper, section 4): everything but ``create`` and ``learn``.

    ``values`` and ``visits`` have shape (cells, actions); ``visits`` counts every time that an
    action was taken in a cell. Among equal values the lowest action is the greedy one.

    Attributes:
        memory: what else the agent keeps; None for one that needs no more.
    """

    cells: Cells
    values: Floats
    visits: Integers
    update: Update
    policy: Exploration
    memory: Memory

    @classmethod
    def with_memory(cls, table: "Tabular", memory: Memory) -> Self:
        """The agent with all that ``table`` has, and its memory."""
        cells, values, visits, update, policy, _ = table
        return cls(cells, values, visits, update, policy, memory)

    def begin_episode(self) -> None:
        """Let the update count episodes."""
        self.update.begin_episode()

    def act(self, observation: Observation, progress: float, rng: np.random.Generator) -> int:
        """What the exploration chooses in the observation's cell."""
        return self.policy.choose(self.values, self.visits, self.cells.encode(observation), progress, rng)

    def greedy(self, observation: Observation) -> int:
        """The best action of the observation's cell, Eq. (14)."""
        return best_action(self.values, self.cells.encode(observation))


class Tabular(TabularAgent[None]):
    """The table of an agent, with its parameters; one that keeps more ``extends`` its ``create``."""

    __slots__ = ()

    @classmethod
    @validated
    def create(
        cls,
        task: Task,
        *,
        bins: Bins = (20, 30),
        binning: Binning = "uniform",
        discount: Probability = 0.99,
        step_size: HarmonicRate | StepSize = HarmonicRate(),  # noqa: B008 (immutable)
        epsilon: LinearDecay | Probability = LinearDecay(),  # noqa: B008 (immutable)
        explore: Softmax | UpperConfidence | None = None,
        initial_values: float | tuple[float, float] = 0.0,
        count_visits: Literal["step", "episode", "state"] = "step",
        goal: Literal["terminal", "bootstrap", "zero"] = "terminal",
        rng: np.random.Generator | None = None,
    ) -> Self:
        """The agent before it has learned anything; the defaults are the paper's.

        Args:
            task: the hill.
            bins: cells along position and velocity, or their edges; see ``agents.make_cells``.
            binning: ``"uniform"``, ``"quantile"`` or ``"kmeans"``.
            discount: gamma, in [0, 1].
            step_size: alpha_n of Eq. (15), or a constant.
            epsilon: share of random actions.
            explore: what takes the place of epsilon-greedy exploration.
            initial_values: of the whole table, or (low, high) to draw each uniformly.
            count_visits: what n of Eq. (15) counts: each ``"step"`` that takes the action in the
                cell, one of them an ``"episode"``, or each visit of the ``"state"``'s cell.
            goal: ``"terminal"``: nothing follows it; ``"bootstrap"``: a cell like any other;
                ``"zero"``: reaching it sets the value to 0.
            rng: draws the initial values.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        cells = make_cells(task, bins, binning, rng)
        shape = (cells.size, task.n_actions)
        rate = step_size if isinstance(step_size, HarmonicRate) else HarmonicRate(step_size, 1.0, 0.0)
        values, visits = _initial(shape, initial_values, rng), np.zeros(shape, np.int64)
        update = make_update(shape, rate, discount, count_visits, goal)
        return cls(cells, values, visits, update, make_exploration(epsilon, explore), None)


def _initial(
    shape: tuple[int, int], values: float | tuple[float, float], rng: np.random.Generator | None
) -> Floats:
    if isinstance(values, float):
        return np.full(shape, values)
    low, high = values
    number("initial_values", high, low)
    return low + (high - low) * (rng or np.random.default_rng()).random(shape)
