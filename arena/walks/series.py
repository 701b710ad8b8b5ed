"""Random walks on the hill: the bounds of the state and the lengths of episodes (paper, section 3.2)."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena.common.parallel import parallel_map_unordered
from arena.common.plain import plain
from arena.walks.loop import TOGETHER, walk
from envs import Hill
from envs.compilation.kernels import compile_loop
from envs.foundation.checks import instance, integer
from envs.foundation.errors import InvalidValueError
from envs.foundation.streams import stream

Progress = Callable[[int, int], None]
_Part = tuple[int, NDArray[np.int64], NDArray[np.bool_], NDArray[np.float64]]


@dataclass(frozen=True)
class RandomWalk:
    """What the walks found: the results of the paper's Algorithm 1.

    Attributes:
        hill: what was driven on.
        seed: master of the random streams.
        max_steps: where an episode was given up.
        lengths: int64, shape (episodes,): steps of each.
        reached: bool, shape (episodes,): whether it ended at the goal, not at the limit.
        position: least and greatest position, in units of length; the paper begins both at 0.
        velocity: least and greatest velocity, in units of length per unit of time; likewise.
    """

    hill: Hill
    seed: int
    max_steps: int
    lengths: NDArray[np.int64]
    reached: NDArray[np.bool_]
    position: tuple[float, float]
    velocity: tuple[float, float]

    def to_dict(self) -> dict[str, Any]:
        """Plain values."""
        return {name: plain(value) for name, value in vars(self).items()}


class InterruptedWalk(KeyboardInterrupt):
    """A ``KeyboardInterrupt`` during the walks.

    Attributes:
        walk: the first of the episodes, as far as they were finished: the same as a series of only these.
        episodes: how many there should have been.
    """

    def __init__(self, walk: RandomWalk, episodes: int) -> None:
        super().__init__(f"interrupted after {len(walk.lengths)} of {episodes} episodes")
        self.walk, self.episodes = walk, episodes


def random_walk(
    episodes: int = 2000,
    hill: Hill = Hill(),  # noqa: B008 (immutable)
    seed: int = 0,
    n_jobs: int = -1,
    max_steps: int = 1_000_000,
    *,
    compiled: bool = True,
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
        max_steps: where an episode is given up, as on a hill whose goal cannot be reached; at least 1.
        compiled: whether the loop is compiled; interpreted it gives the same bits, 50 times slower.
        progress: called with the number of finished episodes and of all.

    Raises:
        TypeError, ValueError: when an argument breaks its rule.
        InterruptedWalk: at Ctrl-C, with what was finished.
    """
    instance("hill", hill, Hill)
    total, seed = integer("episodes", episodes, 1), integer("seed", seed, 0)
    limit = integer("max_steps", max_steps, 1)
    if integer("n_jobs", n_jobs) == 0:
        raise InvalidValueError("n_jobs must not be 0: give a number of workers, or -1 for one a core")
    parts: dict[int, _Part] = {}
    try:
        if compiled:
            _loop(_arguments(hill, seed, range(1), limit))  # once, before the workers look for it
        tasks = [
            (hill, seed, range(first, min(first + TOGETHER, total)), limit, compiled)
            for first in range(0, total, TOGETHER)
        ]
        done = 0
        for part in parallel_map_unordered(n_jobs, _walks, tasks):
            parts[part[0]] = part
            done += len(part[1])
            if progress:
                progress(done, total)
    except KeyboardInterrupt:
        raise InterruptedWalk(_joined(hill, seed, limit, parts), total) from None
    return _joined(hill, seed, limit, parts)


def _joined(hill: Hill, seed: int, limit: int, parts: dict[int, _Part]) -> RandomWalk:
    """All episodes before the first that is missing."""
    lengths, reached, bounds = np.zeros(0, np.int64), np.zeros(0, np.bool_), np.zeros((1, 4))
    for place, first in enumerate(sorted(parts)):
        if first != place * TOGETHER:
            break
        _, steps, there, more_bounds = parts[first]
        lengths, reached = np.append(lengths, steps), np.append(reached, there)
        bounds = np.vstack([bounds, more_bounds])
    least_x, _, least_v, _ = map(float, bounds.min(axis=0))
    _, most_x, _, most_v = map(float, bounds.max(axis=0))
    return RandomWalk(hill, seed, limit, lengths, reached, (least_x, most_x), (least_v, most_v))


def _walks(hill: Hill, seed: int, episodes: range, limit: int, compiled: bool) -> _Part:
    """In a worker: some of the episodes."""
    arguments = _arguments(hill, seed, episodes, limit)
    (_loop(arguments) if compiled else walk)(*arguments)
    lengths, reached, bounds = arguments[-3:]
    return episodes.start, lengths, reached, bounds


def _loop(arguments: tuple[Any, ...]) -> Callable[..., Any]:
    return compile_loop(walk, *arguments)


def _arguments(hill: Hill, seed: int, episodes: range, limit: int) -> tuple[Any, ...]:
    rngs = [stream(seed, "walk", str(episode)) for episode in episodes]
    spare = [stream(seed, "walk", "spare")] * (TOGETHER + 1 - len(rngs))
    lengths, reached = np.zeros(len(rngs), np.int64), np.zeros(len(rngs), np.bool_)
    return hill, hill.n_actions, (*rngs, *spare), limit, lengths, reached, np.zeros(4)
