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
    first, second, next_episode = 0, 1, 2
    first_rng, second_rng = rngs[0], rngs[1]
    first_walk, second_walk = start(hill, first_rng), start(hill, second_rng)
    while first < episodes or second < episodes:
        first_state, _, first_there = hill.step(first_walk.state, int(first_rng.random() * n_actions))
        second_state, _, second_there = hill.step(second_walk.state, int(second_rng.random() * n_actions))
        first_walk, second_walk = first_walk.after(first_state), second_walk.after(second_state)
        if first_there or first_walk.steps == max_steps:
            record(first, first_walk, first_there, lengths, reached, bounds)
            first, next_episode = next_episode, next_episode + 1
            first_rng = rngs[min(first, episodes)]
            first_walk = start(hill, first_rng)
        if second_there or second_walk.steps == max_steps:
            record(second, second_walk, second_there, lengths, reached, bounds)
            second, next_episode = next_episode, next_episode + 1
            second_rng = rngs[min(second, episodes)]
            second_walk = start(hill, second_rng)


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
