"""Lower bounds for any hill: the fewest steps to the goal from each cell, if cells could be crossed at will.

Around where an action leads from the states of a cell there is a rectangle (interval arithmetic). A car that
may go on from any cell that the rectangle touches is at least as fast as the real one. So its fewest steps,
by a breadth-first search backwards from the goal, are a lower bound for every state of the cell, with all
the clips; and a goal that it cannot reach cannot be reached. The bound is not tight: the car gains up to
the size of a cell in each step.
"""

import math

import numpy as np
from numpy.typing import NDArray

from agents.contract import Integers
from agents.optimal.relaxed_car import NEVER
from envs import Dynamics, Hill, Integrator
from envs.compilation.kernels import compile_loop

BINS = (800, 800)
"""Cells along position and velocity, unless others are given: searched in half a second."""

_MARGIN = 1e-9  # of a cell: far more than all roundings

Rectangle = tuple[float, float, float, float]


def fewest_steps(hill: Hill, bins: tuple[int, int] = BINS) -> Integers:
    """A lower bound of the steps to the goal from all states of each cell; ``NEVER`` if it cannot be reached.

    Args:
        hill: what is driven on.
        bins: cells along position and velocity, of equal size between the hill's bounds.
    """
    goal = math.prod(bins)  # one more cell
    ends = np.zeros(goal + 3, np.int64)
    nothing = np.zeros(0, np.int32)
    link = compile_loop(link_cells, hill, bins, ends, nothing)
    link(hill, bins, ends, nothing)
    np.cumsum(ends, out=ends)
    links = np.zeros(ends[-1], np.int32)
    link(hill, bins, ends, links)
    steps, queue = np.full(goal + 1, NEVER), np.full(goal + 1, goal)
    compile_loop(search_backwards, ends, links, steps, queue)(ends, links, steps, queue)
    return steps[:goal]


def link_cells(hill: Hill, bins: tuple[int, int], ends: Integers, links: NDArray[np.int32]) -> None:
    """Write from which cells each cell is reached in a step; the goal is one more cell after all others.

    Those from which cell c is reached will be ``links[ends[c] : ends[c + 1]]``.

    Args:
        hill: what is driven on.
        bins: cells along position and velocity.
        ends: if ``links`` is empty, how many links lead to cell c is added to ``ends[c + 2]``; else
            ``ends[c + 1]`` is where the links to cell c begin, and becomes where they end.
        links: the numbers of cells.
    """
    goal = bins[0] * bins[1]
    x_size = (hill.max_position - hill.min_position) / bins[0]
    v_size = (hill.max_velocity - hill.min_velocity) / bins[1]
    for cell in range(goal):
        x, v = hill.min_position + cell // bins[1] * x_size, hill.min_velocity + cell % bins[1] * v_size
        for action in range(3):
            left, right, slowest, fastest = image(hill, (x, v), (x + x_size, v + v_size), action)
            west = index(left - _MARGIN * x_size, hill.min_position, hill.max_position, bins[0])
            east = index(right + _MARGIN * x_size, hill.min_position, hill.max_position, bins[0])
            south = index(slowest - _MARGIN * v_size, hill.min_velocity, hill.max_velocity, bins[1])
            north = index(fastest + _MARGIN * v_size, hill.min_velocity, hill.max_velocity, bins[1])
            for column in range(west, east + 1):
                for target in range(column * bins[1] + south, column * bins[1] + north + 1):
                    add_link(ends, links, cell, target)
            if right + _MARGIN * x_size >= hill.goal_position:
                add_link(ends, links, cell, goal)


def add_link(ends: Integers, links: NDArray[np.int32], cell: int, target: int) -> None:
    """Count, or write, that ``target`` is reached from ``cell``; see ``link_cells``."""
    if links.shape[0] == 0:
        ends[target + 2] += 1
    else:
        links[ends[target + 1]] = cell
        ends[target + 1] += 1


def search_backwards(ends: Integers, links: NDArray[np.int32], steps: Integers, queue: Integers) -> None:
    """Breadth-first search from the last cell, the goal.

    Args:
        ends: see ``link_cells``.
        links: see ``link_cells``.
        steps: filled with the fewest steps of each cell; at first more than any.
        queue: room for all cells, the goal in its first place.
    """
    waiting, done = 1, 0
    steps[queue[0]] = 0
    while done < waiting:
        target = queue[done]
        done += 1
        for place in range(ends[target], ends[target + 1]):
            cell = links[place]
            if steps[cell] > steps[target] + 1:
                steps[cell] = steps[target] + 1
                queue[waiting] = cell
                waiting += 1


def cell_of(hill: Hill, bins: tuple[int, int], position: float, velocity: float) -> int:
    """The number of a cell that contains a state."""
    x = index(position, hill.min_position, hill.max_position, bins[0])
    return x * bins[1] + index(velocity, hill.min_velocity, hill.max_velocity, bins[1])


def index(value: float, low: float, high: float, bins: int) -> int:
    """The number of the interval, of ``bins`` equal ones, that contains ``value`` or is nearest to it."""
    return min(max(int((value - low) / (high - low) * bins), 0), bins - 1)


def image(hill: Hill, low: tuple[float, float], high: tuple[float, float], action: int) -> Rectangle:
    """A rectangle around where ``action`` leads from the states between ``low`` and ``high``.

    Returns:
        least and greatest position, least and greatest velocity.
    """
    h, pull = hill.time_step, hill.time_step * hill.gravity * hill.omega
    middle, half = 0.5 * (low[0] + high[0]), 0.5 * (high[0] - low[0])
    push = h * (action - 1) * (hill.thrust / hill.mass) - pull * math.cos(hill.omega * middle)
    vary = pull * hill.omega * half  # |cos(a) - cos(b)| <= |a - b|
    keep = 1.0 - h * hill.friction / hill.mass
    ends = (keep * low[1], keep * high[1])
    if hill.dynamics == Dynamics.CONSTRAINED:
        push, vary = constrained_push(hill, low, high, action)
        ends = (low[1], high[1])
    slowest = min(max(min(ends) + push - vary, hill.min_velocity), hill.max_velocity)
    fastest = min(max(max(ends) + push + vary, hill.min_velocity), hill.max_velocity)
    moving = (slowest, fastest)
    if hill.integrator == Integrator.EXPLICIT:
        moving = (low[1], high[1])
    left, right = low[0] + h * moving[0], high[0] + h * moving[1]
    if hill.inelastic_wall and left <= hill.min_position:
        fastest = max(fastest, 0.0)
    return left, right, slowest, fastest


def constrained_push(
    hill: Hill, low: tuple[float, float], high: tuple[float, float], action: int
) -> tuple[float, float]:
    """What the constrained dynamics add to the velocity in a step, from states between ``low`` and ``high``.

    The acceleration is N / D, where N = F/m - k_f v/m - g f' - f' f'' v^2 and D = 1 + f'^2. Its derivatives
    are bounded because ``|f'| <= omega``, ``|f''| <= omega^2``, the third derivative of f is -omega^2 f', and
    ``|f'| / D <= 1/2``.

    Returns:
        that from the middle, and by how much that from any other state differs from it, at most.
    """
    x, v = 0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])
    fastest, square = max(abs(low[1]), abs(high[1])), hill.omega * hill.omega
    slope, bend = hill.slope(x), -square * hill.height(x)
    drag, thrust = hill.friction / hill.mass, (action - 1) * (hill.thrust / hill.mass)
    middle = (thrust - drag * v - hill.gravity * slope - slope * bend * v * v) / (1.0 + slope * slope)
    centrifugal = square * fastest * fastest
    greatest = abs(thrust) + drag * fastest + 0.5 * (hill.gravity + centrifugal)  # of N / D
    by_position = square * (hill.gravity + centrifugal + fastest * fastest + greatest)  # |D'| / D <= omega^2
    by_velocity = drag + square * fastest
    half_x, half_v = 0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1])
    return hill.time_step * middle, hill.time_step * (by_position * half_x + by_velocity * half_v)
