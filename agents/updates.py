"""The update of a table by temporal differences, Eq. (15), and the ways to read the paper's text of it."""

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from agents.policies import Table
from agents.schedules import HarmonicRate
from envs.checks import choice

Counts = NDArray[np.int64]


class GoalRule(IntEnum):
    """What becomes of the value of the action that reaches the goal."""

    TERMINAL = 0
    """Nothing follows the goal: its target is the reward alone."""
    BOOTSTRAP = 1
    """The goal's cell is taken for a cell like any other."""
    ZERO = 2
    """The value is set to 0."""


class StepUpdate(NamedTuple):
    """Eq. (15), with n the number of times that the action was taken in the cell."""

    step_size: HarmonicRate
    discount: float
    goal: GoalRule

    def begin_episode(self) -> None:
        """Nothing to do."""

    def apply(
        self,
        values: Table,
        visits: Counts,
        cell: int,
        action: int,
        reward: float,
        next_value: float,
        terminated: bool,
    ) -> None:
        """Move ``values[cell, action]`` towards ``reward + discount * next_value``."""
        rate = self.step_size.at(visits[cell, action])
        towards(values, cell, action, reward, next_value, terminated, rate, self.discount, self.goal)
        visits[cell, action] += 1


class EpisodeUpdate(NamedTuple):
    """Eq. (15), with n the number of earlier episodes in which the action was taken in the cell."""

    step_size: HarmonicRate
    discount: float
    goal: GoalRule
    episodes: Counts  # (cells, actions): episodes with a visit
    latest: Counts  # (cells, actions): the latest of them
    now: Counts  # (1,): this episode

    def begin_episode(self) -> None:
        """Count the episode."""
        self.now[0] += 1

    def apply(
        self,
        values: Table,
        visits: Counts,
        cell: int,
        action: int,
        reward: float,
        next_value: float,
        terminated: bool,
    ) -> None:
        """Move ``values[cell, action]`` towards ``reward + discount * next_value``."""
        if self.latest[cell, action] != self.now[0]:
            self.latest[cell, action] = self.now[0]
            self.episodes[cell, action] += 1
        rate = self.step_size.at(self.episodes[cell, action] - 1)
        towards(values, cell, action, reward, next_value, terminated, rate, self.discount, self.goal)
        visits[cell, action] += 1


class StateUpdate(NamedTuple):
    """Eq. (15), with n the number of times that the cell was visited, whatever the action."""

    step_size: HarmonicRate
    discount: float
    goal: GoalRule

    def begin_episode(self) -> None:
        """Nothing to do."""

    def apply(
        self,
        values: Table,
        visits: Counts,
        cell: int,
        action: int,
        reward: float,
        next_value: float,
        terminated: bool,
    ) -> None:
        """Move ``values[cell, action]`` towards ``reward + discount * next_value``."""
        earlier = 0
        for other in range(visits.shape[1]):
            earlier += visits[cell, other]
        rate = self.step_size.at(earlier)
        towards(values, cell, action, reward, next_value, terminated, rate, self.discount, self.goal)
        visits[cell, action] += 1


Update = StepUpdate | EpisodeUpdate | StateUpdate


def towards(
    values: Table,
    cell: int,
    action: int,
    reward: float,
    next_value: float,
    terminated: bool,
    rate: float,
    discount: float,
    goal: GoalRule,
) -> None:
    """The new value of Eq. (15): a step of ``rate`` from the old one towards the target."""
    if terminated and goal == GoalRule.ZERO:
        values[cell, action] = 0.0
        return
    target = reward
    if not terminated or goal == GoalRule.BOOTSTRAP:
        target += discount * next_value
    values[cell, action] += rate * (target - values[cell, action])


def make_update(
    shape: tuple[int, int], step_size: HarmonicRate, discount: float, count_visits: str, goal: str
) -> Update:
    """The update for a table of ``shape`` (cells, actions).

    Args:
        shape: of the table.
        step_size: schedule of the step size.
        discount: of the next value.
        count_visits: ``"step"``: every time the action was taken in the cell; ``"episode"``: once
            an episode; ``"state"``: every visit of the cell.
        goal: ``"terminal"``, ``"bootstrap"`` or ``"zero"``, see ``GoalRule``.
    """
    rule = GoalRule[choice("goal", goal, [rule.name.lower() for rule in GoalRule]).upper()]
    match choice("count_visits", count_visits, ["step", "episode", "state"]):
        case "step":
            return StepUpdate(step_size, discount, rule)
        case "state":
            return StateUpdate(step_size, discount, rule)
    episodes, latest, now = (np.zeros(size, np.int64) for size in (shape, shape, 1))
    return EpisodeUpdate(step_size, discount, rule, episodes, latest, now)
