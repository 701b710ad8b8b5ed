"""Optimal drives, backwards from the goal: a table of the best action in small cells.

When a car reaches the goal two things are open: its velocity, and how far beyond the goal its last step ends.
From many of these ends the relaxed car of ``agents.optimal.relaxed_car`` is driven backwards with the thrust
that the maximum principle asks for. These drives are the characteristics of Bellman's equation; they cover
the states from which the goal can be reached. Where several pass through a cell, the one that is nearest to
the goal counts. Clips are ignored: the table is a good driver, not a proof.
"""

import math

import numpy as np
from numpy.typing import NDArray

from agents.contract import Floats
from agents.discretization.grid import Grid
from agents.optimal.relaxed_car import Relaxed
from envs import Hill
from envs.compilation.kernels import compile_loop

LONGEST = 1000  # steps of a drive backwards
_WORSE = 2.0  # steps; less may be due to the size of a cell
_SPEEDS, _PHASES = 4000, 32  # of the ends: velocities at the goal, and parts of a step beyond it


def best_actions(hill: Hill, cells: Grid) -> NDArray[np.int8]:
    """The best action in each of ``cells``; where no drive passes, that of the nearest cell.

    Args:
        hill: one for whose relaxed car the theory applies.
        cells: of the table.
    """
    from scipy.ndimage import distance_transform_edt

    nearest = np.full(cells.size, np.inf)
    actions = np.ones(cells.size, np.int8)
    arguments = (Relaxed.of(hill), hill, cells, _SPEEDS, _PHASES, nearest, actions)
    compile_loop(drive_backwards, *arguments)(*arguments)
    unseen = np.isinf(nearest).reshape(cells.bins)
    where = distance_transform_edt(unseen, return_distances=False, return_indices=True)
    filled: NDArray[np.int8] = actions.reshape(cells.bins)[tuple(where)].ravel()
    return filled


def drive_backwards(
    car: Relaxed,
    hill: Hill,
    cells: Grid,
    speeds: int,
    phases: int,
    nearest: Floats,
    actions: NDArray[np.int8],
) -> None:
    """Drive backwards from all ends.

    Args:
        car: what is driven.
        hill: its bounds.
        cells: of the table.
        speeds: how many velocities at the goal are looked at.
        phases: how many parts of a step beyond it.
        nearest: fewest steps to the goal from each cell, infinity at first; lowered in place.
        actions: the action that begins them.
    """
    for end in range(speeds * phases):
        phase = (end % phases + 0.5) / phases
        v = hill.max_velocity * (end // phases + 0.5) / speeds
        x = hill.goal_position + phase * car.time_step * v
        by_x, by_v = 1.0, 0.0  # derivatives of the last position by this position and velocity
        for step in range(1, LONGEST + 1):
            sensitivity = by_v if car.explicit else by_v + car.time_step * by_x
            thrust = car.impulse if sensitivity >= 0.0 else -car.impulse
            x, v = step_back(car, x, v, thrust)
            on_track = hill.min_position <= x < hill.goal_position
            if not (on_track and hill.min_velocity <= v <= hill.max_velocity):
                break
            cell = cells.encode((x, v))
            if step - phase > nearest[cell] + _WORSE:
                break  # by Bellman's principle nothing before is optimal
            if step - phase < nearest[cell]:
                nearest[cell], actions[cell] = step - phase, 2 if thrust > 0.0 else 0
            by_v = car.keep * by_v + car.time_step * by_x if car.explicit else car.keep * sensitivity
            by_x += car.pull * car.omega * math.sin(car.omega * x) * sensitivity


def step_back(car: Relaxed, x: float, v: float, thrust: float) -> tuple[float, float]:
    """The state before ``(x, v)``."""
    if not car.explicit:
        x -= car.time_step * v
        return x, (v - thrust + car.pull * math.cos(car.omega * x)) / car.keep
    before = v
    for _ in range(4):  # Newton's method for the velocity before
        place = x - car.time_step * before
        error = car.keep * before + thrust - car.pull * math.cos(car.omega * place) - v
        before -= error / (car.keep - car.stiffness * math.sin(car.omega * place))
    return x - car.time_step * before, before
