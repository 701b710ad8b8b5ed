"""The loop of the random walks: plain Python, which numba compiles together with the hill."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

TOGETHER = 25
"""Episodes of one call."""

State = tuple[float, float]


class Walk(NamedTuple):
    """One random walk on its way.

    Attributes:
        state: where the car is.
        steps: taken so far.
        least: least position and velocity, each at most 0.
        most: greatest position and velocity, each at least 0.
    """

    state: State
    steps: int
    least: State
    most: State

    def after(self, state: State) -> "Walk":
        """The walk, one step further."""
        (x, v), (least_x, least_v), (most_x, most_v) = state, self.least, self.most
        return Walk(
            state, self.steps + 1, (min(least_x, x), min(least_v, v)), (max(most_x, x), max(most_v, v))
        )


def start(hill: Any, rng: np.random.Generator) -> Walk:
    """A walk that begins; the paper's Algorithm 1 begins all its bounds at 0."""
    return Walk(hill.reset(rng), 0, (0.0, 0.0), (0.0, 0.0))


def walk(
    hill: Any,
    n_actions: int,
    rngs: tuple[np.random.Generator, ...],
    max_steps: int,
    lengths: NDArray[np.int64],
    reached: NDArray[np.bool_],
    bounds: NDArray[np.float64],
) -> None:
    """Walk at random to the goal, once for each of ``lengths`` (paper, section 3.2, Algorithm 1).

    Two cars take turns. A car's next step waits long for its last one, for the cosine most of all, and
    meanwhile the processor works on the other car. That nearly halves the time.

    Args:
        hill: the model of the car.
        n_actions: the actions are 0, 1, ..., n_actions - 1.
        rngs: a stream for each episode; then at least one more, for a car that has no episode left and
            drives on for nothing. ``TOGETHER`` + 1 of them, as numba compiles for each number anew.
        max_steps: where an episode is given up.
        lengths: filled with the steps of each episode, shape (episodes,).
        reached: filled with whether it ended at the goal, shape (episodes,).
        bounds: least and greatest position, least and greatest velocity: widened in place, shape (4,).
    """
    episodes = len(lengths)
    one, other, following = 0, 1, 2
    one_rng, other_rng = rngs[0], rngs[1]
    one_walk, other_walk = start(hill, one_rng), start(hill, other_rng)
    while one < episodes or other < episodes:
        one_state, _, one_there = hill.step(one_walk.state, int(one_rng.random() * n_actions))
        other_state, _, other_there = hill.step(other_walk.state, int(other_rng.random() * n_actions))
        one_walk, other_walk = one_walk.after(one_state), other_walk.after(other_state)
        if one_there or one_walk.steps == max_steps:
            record(one, one_walk, one_there, lengths, reached, bounds)
            one, following = following, following + 1
            one_rng = rngs[min(one, episodes)]
            one_walk = start(hill, one_rng)
        if other_there or other_walk.steps == max_steps:
            record(other, other_walk, other_there, lengths, reached, bounds)
            other, following = following, following + 1
            other_rng = rngs[min(other, episodes)]
            other_walk = start(hill, other_rng)


def record(
    episode: int,
    walk: Walk,
    there: bool,
    lengths: NDArray[np.int64],
    reached: NDArray[np.bool_],
    bounds: NDArray[np.float64],
) -> None:
    """Write down a walk that has ended, unless it was for nothing."""
    if episode < len(lengths):
        lengths[episode], reached[episode] = walk.steps, there
        bounds[0], bounds[1] = min(bounds[0], walk.least[0]), max(bounds[1], walk.most[0])
        bounds[2], bounds[3] = min(bounds[2], walk.least[1]), max(bounds[3], walk.most[1])
