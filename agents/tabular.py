"""A table of action values over the cells of a grid, driven epsilon-greedily."""

from collections.abc import Sequence
from typing import Any, NamedTuple, Self

import numpy as np

from agents.contract import Observation, Task
from agents.grid import Grid
from agents.policies import Table, best_action, epsilon_greedy
from agents.schedules import HarmonicRate, LinearDecay
from agents.updates import Counts, Update, make_update
from envs.checks import number


class Tabular(NamedTuple):
    """What Q-learning and SARSA share (paper, section 4): everything but ``learn``.

    ``values`` and ``visits`` have shape (cells, actions); ``visits`` counts every time that an
    action was taken in a cell. Among equal values the lowest action is the greedy one.
    """

    grid: Grid
    values: Table
    visits: Counts
    update: Update
    epsilon: LinearDecay

    @classmethod
    def create(
        cls,
        task: Task,
        *,
        bins: int | Sequence[int] = (20, 30),
        discount: float = 0.99,
        step_size: HarmonicRate = HarmonicRate(),  # noqa: B008 (immutable)
        epsilon: LinearDecay = LinearDecay(),  # noqa: B008 (immutable)
        initial_values: float | Sequence[float] = 0.0,
        count_visits: str = "step",
        goal: str = "terminal",
        rng: np.random.Generator | None = None,
    ) -> Self:
        """The agent before it has learned anything; the defaults are the paper's.

        Args:
            task: the hill.
            bins: cells along position and velocity.
            discount: gamma, in [0, 1].
            step_size: alpha_n of Eq. (15).
            epsilon: share of random actions.
            initial_values: of the whole table, or (low, high) to draw each uniformly.
            count_visits: what n of Eq. (15) counts: each ``"step"`` that takes the action in the
                cell, one of them an ``"episode"``, or each visit of the ``"state"``'s cell.
            goal: ``"terminal"``: nothing follows it; ``"bootstrap"``: a cell like any other;
                ``"zero"``: reaching it sets the value to 0.
            rng: draws the initial values.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        grid = Grid.over(task, bins)
        shape = (grid.size, task.n_actions)
        discount = number("discount", discount, 0, 1)
        for name, schedule in (("step_size", step_size), ("epsilon", epsilon)):
            if not callable(getattr(schedule, "at", None)):
                raise TypeError(f"{name} must be a schedule with a method at, got {schedule!r}")
        update = make_update(shape, step_size, discount, count_visits, goal)
        return cls(grid, _initial(shape, initial_values, rng), np.zeros(shape, np.int64), update, epsilon)

    def begin_episode(self) -> None:
        """Let the update count episodes."""
        self.update.begin_episode()

    def act(self, observation: Observation, progress: float, rng: np.random.Generator) -> int:
        """Epsilon-greedy in the observation's cell."""
        return epsilon_greedy(self.values, self.grid.encode(observation), self.epsilon.at(progress), rng)

    def greedy(self, observation: Observation) -> int:
        """The best action of the observation's cell, Eq. (14)."""
        return best_action(self.values, self.grid.encode(observation))


def _initial(shape: tuple[int, int], values: Any, rng: np.random.Generator | None) -> Table:
    if not isinstance(values, Sequence):
        return np.full(shape, number("initial_values", values))
    if len(values) != 2:
        raise ValueError(f"initial_values must be a number or (low, high), got {values!r}")
    low = number("initial_values", values[0])
    high = number("initial_values", values[1], low)
    return low + (high - low) * (rng or np.random.default_rng()).random(shape)
