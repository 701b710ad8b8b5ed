"""The update of a table by temporal differences, Eq. (15), and the ways to read the paper's text of it."""

from enum import IntEnum
from typing import NamedTuple

import numpy as np

from agents.contract import Floats, Integers
from agents.learning.schedules import HarmonicRate
from agents.learning.targets import bootstrapped


class GoalRule(IntEnum):
    """What becomes of the value of the action that reaches the goal."""

    TERMINAL = 0
    """Nothing follows the goal: its target is the reward alone."""
    BOOTSTRAP = 1
    """The goal's cell is taken for a cell like any other."""
    ZERO = 2
    """The value is set to 0."""


class Counting(IntEnum):
    """What n of Eq. (15) counts."""

    STEP = 0
    """Every earlier time that the action was taken in the cell."""
    EPISODE = 1
    """The earlier episodes in which it was."""
    STATE = 2
    """Every earlier visit of the cell, whatever the action."""


class Update(NamedTuple):
    """Eq. (15): a step towards the target, the smaller the more often the action was taken before."""

    step_size: HarmonicRate
    discount: float
    goal: GoalRule
    counting: Counting
    episodes: Integers  # (cells, actions): episodes with a visit
    latest: Integers  # (cells, actions): the latest of them
    episode: Integers  # (1,): the number of this one

    def begin_episode(self) -> None:
        """Count the episode."""
        self.episode[0] += 1

    def apply(
        self,
        values: Floats,
        visits: Integers,
        cell: int,
        action: int,
        reward: float,
        next_value: float,
        terminated: bool,
    ) -> None:
        """Move ``values[cell, action]`` towards ``reward + discount * next_value``, and count the visit."""
        rate = self.step_size.at(self.earlier(visits, cell, action))
        visits[cell, action] += 1
        if terminated and self.goal == GoalRule.ZERO:
            values[cell, action] = 0.0
            return
        target = self.target(reward, next_value, terminated)
        values[cell, action] += rate * (target - values[cell, action])

    def target(self, reward: float, next_value: float, terminated: bool) -> float:
        """What a step returns: its target in Eq. (15).

        Args:
            reward: of the step.
            next_value: what the next step returns, or its value.
            terminated: whether the step reached the goal.
        """
        if not terminated or self.goal == GoalRule.BOOTSTRAP:
            return bootstrapped(reward, self.discount, next_value)
        return reward if self.goal == GoalRule.TERMINAL else 0.0

    def earlier(self, visits: Integers, cell: int, action: int) -> int:
        """The number n of Eq. (15); where episodes are counted, this one is from now on."""
        if self.counting == Counting.STEP:
            return visits[cell, action]  # type: ignore[no-any-return]  # an array has it
        if self.counting == Counting.STATE:
            total = 0
            for other in range(visits.shape[1]):
                total += visits[cell, other]
            return total
        if self.latest[cell, action] != self.episode[0]:
            self.latest[cell, action] = self.episode[0]
            self.episodes[cell, action] += 1
        return self.episodes[cell, action] - 1  # type: ignore[no-any-return]  # an array has it


def make_update(
    shape: tuple[int, int], step_size: HarmonicRate, discount: float, count_visits: str, goal: str
) -> Update:
    """The update for a table of ``shape`` (cells, actions).

    Args:
        shape: of the table.
        step_size: schedule of the step size.
        discount: of the next value.
        count_visits: ``"step"``, ``"episode"`` or ``"state"``, see ``Counting``.
        goal: ``"terminal"``, ``"bootstrap"`` or ``"zero"``, see ``GoalRule``.
    """
    episodes, latest, episode = (np.zeros(size, np.int64) for size in (shape, shape, 1))
    rule, counting = GoalRule[goal.upper()], Counting[count_visits.upper()]
    return Update(step_size, discount, rule, counting, episodes, latest, episode)
