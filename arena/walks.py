"""Algorithm 1 of the paper: random walks that find the bounds of the state and the lengths of episodes."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena.pool import imap
from envs import Hill
from envs.checks import instance, integer
from envs.compilation import compile_loop
from envs.streams import stream

_TOGETHER = 25  # episodes a task

Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class RandomWalk:
    """What the walks found.

    Attributes:
        lengths: int64, shape (episodes,): steps of each.
        reached: bool, shape (episodes,): whether it ended at the goal, not at the limit.
        position: least and greatest position; the paper begins both at 0.
        velocity: least and greatest velocity; likewise.
    """

    lengths: NDArray[np.int64]
    reached: NDArray[np.bool_]
    position: tuple[float, float]
    velocity: tuple[float, float]

    def to_dict(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "lengths": self.lengths.tolist(),
            "reached": self.reached.tolist(),
            "position": list(self.position),
            "velocity": list(self.velocity),
        }


def random_walk(
    episodes: int = 2000,
    hill: Hill = Hill(),  # noqa: B008 (immutable)
    seed: int = 0,
    n_jobs: int = -1,
    max_steps: int = 10_000_000,
    *,
    progress: Progress | None = None,
) -> RandomWalk:
    """Drive with random actions to the goal, again and again (paper, section 3.2, Algorithm 1).

    Each episode has a random stream of its own, so the results are the same bits for any number of
    workers, and the first episodes of a longer series are those of a shorter one.

    Args:
        episodes: ITMAX, at least 1.
        hill: what to drive on.
        seed: at least 0.
        n_jobs: workers, as joblib counts them.
        max_steps: where an episode is given up; at least 1.
        progress: called with the number of finished episodes and of all.

    Raises:
        TypeError, ValueError: when an argument breaks its rule.
    """
    instance("hill", hill, Hill)
    total, seed = integer("episodes", episodes, 1), integer("seed", seed, 0)
    limit = integer("max_steps", max_steps, 1)
    if integer("n_jobs", n_jobs) == 0:
        raise ValueError("n_jobs must not be 0: give a number of workers, or -1 for one a core")
    compile_loop(_walk, *_arguments(hill, seed, 0, limit))  # once, before the workers look for it
    tasks = [
        (hill, seed, first, min(first + _TOGETHER, total), limit) for first in range(0, total, _TOGETHER)
    ]
    lengths, reached = np.zeros(total, np.int64), np.zeros(total, np.bool_)
    bounds = np.zeros(4)
    done = 0
    for first, steps, ended, found in imap(n_jobs, _walks, tasks):
        lengths[first : first + len(steps)], reached[first : first + len(steps)] = steps, ended
        bounds[0::2] = np.minimum(bounds[0::2], found[0::2])
        bounds[1::2] = np.maximum(bounds[1::2], found[1::2])
        done += len(steps)
        if progress:
            progress(done, total)
    least_x, most_x, least_v, most_v = map(float, bounds)
    return RandomWalk(lengths, reached, (least_x, most_x), (least_v, most_v))


def _walks(
    hill: Hill, seed: int, first: int, last: int, limit: int
) -> tuple[int, NDArray[np.int64], NDArray[np.bool_], NDArray[np.float64]]:
    """In a worker: the episodes from ``first`` to ``last``."""
    lengths, reached = np.zeros(last - first, np.int64), np.zeros(last - first, np.bool_)
    bounds = np.zeros(4)
    for place, episode in enumerate(range(first, last)):
        arguments = (*_arguments(hill, seed, episode, limit)[:-1], bounds)
        lengths[place], reached[place] = compile_loop(_walk, *arguments)(*arguments)
    return first, lengths, reached, bounds


def _arguments(hill: Hill, seed: int, episode: int, limit: int) -> tuple[Any, ...]:
    return hill, stream(seed, "walk", str(episode)), limit, np.zeros(4)


def _walk(
    hill: Any, rng: np.random.Generator, max_steps: int, bounds: NDArray[np.float64]
) -> tuple[int, bool]:
    """One episode: its steps and whether it reached the goal; ``bounds`` are widened."""
    position, velocity = hill.reset(rng)
    least_x, most_x, least_v, most_v = bounds
    steps, terminated = 0, False
    while steps < max_steps and not terminated:
        (position, velocity), _, terminated = hill.step((position, velocity), int(rng.random() * 3.0))
        least_x, most_x = min(least_x, position), max(most_x, position)
        least_v, most_v = min(least_v, velocity), max(most_v, velocity)
        steps += 1
    bounds[0], bounds[1], bounds[2], bounds[3] = least_x, most_x, least_v, most_v
    return steps, terminated
