"""A driver by a table of best actions."""

from functools import lru_cache
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from agents.baselines import DoesNotLearn
from agents.contract import Observation
from agents.discretization.grid import Grid
from agents.optimal.characteristics import best_actions
from agents.optimal.relaxed_car import Relaxed
from agents.parameters.declared import Count
from agents.parameters.validation import validated
from envs import Dynamics, Hill
from envs.foundation.checks import instance
from envs.foundation.errors import InvalidValueError


class _Table(NamedTuple):
    cells: Grid
    actions: NDArray[np.int8]


class Optimal(DoesNotLearn, _Table):
    """Drives by a table of best actions, computed from the hill's constants; it learns nothing.

    On the default hill it needs the fewest steps from all but about one start in a thousand, and there one
    more: its cells are small, but no points.

    Attributes:
        cells: of the table.
        actions: the action in each, int8, shape (cells,), read-only.
    """

    __slots__ = ()
    name = "optimal"
    citation = "The fewest steps to the goal, with a certificate; and a driver that needs hardly more."

    @classmethod
    @validated
    def create(cls, task: Hill, *, bins: Count = 1000) -> Self:
        """The agent.

        Args:
            task: the hill; the agent knows its constants.
            bins: cells along position and along velocity.

        Raises:
            TypeError, ValueError: when ``task`` is no hill, has too much friction or other dynamics than
                the simplified; when a parameter breaks its rule.
        """
        return cls(*_table(instance("task", task, Hill), bins))

    def greedy(self, observation: Observation) -> int:
        """The best action of the observation's cell."""
        return int(self.actions[self.cells.encode(observation)])


@lru_cache(maxsize=8)
def _table(hill: Hill, bins: int) -> tuple[Grid, NDArray[np.int8]]:
    if hill.dynamics != Dynamics.SIMPLIFIED:
        raise InvalidValueError(f"dynamics must be simplified for this agent, got {hill.dynamics.label!r}")
    if not Relaxed.of(hill).applies:
        raise InvalidValueError(
            f"friction must be less, for so long a time step and so steep a hill, got {hill.friction}"
        )
    cells = Grid.over(hill, bins)
    actions = best_actions(hill, cells)
    actions.flags.writeable = False
    return cells, actions
