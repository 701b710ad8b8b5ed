"""The fewest steps to the goal, with a certificate.

How it is proved: ``agents.optimal.relaxed_car`` (what an optimal drive looks like),
``agents.optimal.certificate`` (drives of that kind that are too short are excluded),
``agents.optimal.lower_bound`` (the clips of the hill) and ``agents.optimal.conservative_cells``
(any hill, but coarsely).
"""

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from agents.baselines import MomentumAgent
from agents.contract import Floats, Integers
from agents.optimal.bang_bang import shorten
from agents.optimal.conservative_cells import BINS, cell_of, fewest_steps
from agents.optimal.driver import Optimal
from agents.optimal.lower_bound import affordable, lower_bound
from agents.optimal.relaxed_car import MAX_SWITCHES, NEVER, Relaxed, spacing
from envs import Hill
from envs.compilation.kernels import compile_loop
from envs.foundation.checks import instance, number

_PATIENCE = 20_000  # steps of a drive that seeks the goal


def optimal_steps(hill: Hill, positions: ArrayLike) -> tuple[Integers, Integers]:
    """Bounds of the fewest steps to the goal from rest at each position.

    The upper bound is attained by a drive on the hill, the lower one is proved by a computation, roundings
    included. Where they are equal they are the optimum; a gap means that no more was proved. There are gaps
    where the velocity is clipped on the way, and where the engine is so weak that many swings are needed.
    Takes 5 ms a start on the default hill, up to seconds where many swings are needed. Answers are kept in
    the process.

    Args:
        hill: what is driven on.
        positions: in units of length, between the hill's bounds.

    Returns:
        Lower and upper bounds, of the shape of ``positions``; ``NEVER`` where no drive was found, and where
        it is proved that there is none.

    Raises:
        TypeError, ValueError: when a position is no number on the hill.
    """
    instance("hill", hill, Hill)
    asked = np.asarray(positions, np.float64)
    for position in asked.flat:
        number("positions", float(position), hill.min_position, hill.max_position)
    known = _known(hill)
    missing = np.array(sorted({*map(float, asked.flat)} - known.keys()))
    if len(missing):
        known.update(zip(map(float, missing), zip(*_bounds(hill, missing), strict=True), strict=True))
    bounds = np.array([known[float(position)] for position in asked.flat], np.int64).reshape(-1, 2)
    return bounds[:, 0].reshape(asked.shape), bounds[:, 1].reshape(asked.shape)


@lru_cache(maxsize=16)
def _known(hill: Hill) -> dict[float, tuple[int, int]]:
    return {}


def _bounds(hill: Hill, positions: Floats) -> tuple[Integers, Integers]:
    car = Relaxed.of(hill)
    upper = np.full(len(positions), NEVER)
    _drive(hill, MomentumAgent.create(hill), positions, upper)
    if car.applies:
        _drive(hill, Optimal.create(hill), positions, upper)
    cells = fewest_steps(hill).reshape(BINS)
    lower = np.minimum(upper, [cells.flat[cell_of(hill, BINS, position, 0.0)] for position in positions])
    if car.applies:
        open_ = lower < upper
        proved = lower_bound(hill, positions[open_], upper[open_], cells)
        lower[open_] = np.maximum(lower[open_], proved)
        open_ = lower < upper
        upper[open_] = _shortened(hill, car, positions[open_], upper[open_], coast=False)
        open_ = (lower < upper) & (upper <= lower + 2)  # coasting gains no more
        upper[open_] = _shortened(hill, car, positions[open_], upper[open_], coast=True)
    return lower, upper


def _drive(hill: Hill, agent: object, positions: Floats, upper: Integers) -> None:
    arguments = (hill, agent, positions, _PATIENCE, upper)
    compile_loop(drive, *arguments)(*arguments)


def drive(hill: Hill, agent: MomentumAgent, positions: Floats, most: int, upper: Integers) -> None:
    """The steps that an agent needs from rest at each position.

    Args:
        hill: what is driven on.
        agent: who drives.
        positions: shape (starts,).
        most: where to give up.
        upper: lowered in place where it needs fewer, shape (starts,).
    """
    for start in range(positions.shape[0]):
        state = (positions[start], 0.0)
        for step in range(1, min(most, upper[start])):
            state, _, terminated = hill.step(state, agent.greedy(hill.observe(state)))
            if terminated:
                upper[start] = step
                break


def _shortened(hill: Hill, car: Relaxed, positions: Floats, upper: Integers, *, coast: bool) -> Integers:
    if len(upper) == 0:
        return upper
    gaps = spacing(car, of_velocity=False)
    horizons = np.minimum(upper, affordable(gaps, int(upper.max())))
    upper = upper.copy()
    arguments = (hill, positions, gaps, horizons, coast, upper, np.zeros(MAX_SWITCHES, np.int64))
    compile_loop(shorten, *arguments)(*arguments)
    return upper
