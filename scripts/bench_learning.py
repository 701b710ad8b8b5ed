"""How fast is the learning loop? The compiled driver beside the same loop written by hand, in one run.

    python scripts/bench_learning.py

The loop by hand is one numba function of numbers and arrays: the physics, the grid, the epsilon-greedy
choice and the update of Q-learning or SARSA written out in line, with the same random numbers. Both
learn the same table, to the bit; that is checked first. Only ratios from one run mean something.
"""

import argparse
import json
import math
import statistics
import time
from collections.abc import Callable
from typing import Any

import numba
import numpy as np

from agents import Grid, QLearning, Sarsa
from arena.execution.loops import TrainingLoop, episode_hook, learning_order, train
from envs import Hill
from envs.compilation import compile_loop


@numba.njit(nogil=True, error_model="numpy")
def by_hand(q, visits, edges, scale, n_p, n_v, episodes, max_steps, starts, rng, lengths, sarsa):  # type: ignore[no-untyped-def] # noqa: PLR0915, C901, PLR0912
    """The learning loop of the paper without a call."""
    for episode in range(episodes):
        epsilon = 0.6 + (0.01 - 0.6) * (episode / episodes)
        x, v = -0.6 + (-0.4 - -0.6) * starts.random(), 0.0
        f = (x + 1.2) * scale[0]
        i = int(f) if f < n_p - 1 else n_p - 1
        if x >= edges[0, i + 1]:
            i += 1
        f = (v + 0.07) * scale[1]
        j = int(f) if f < n_v - 1 else n_v - 1
        if v >= edges[1, j + 1]:
            j += 1
        cell = i * n_v + j
        if rng.random() < epsilon:
            action = int(rng.random() * 3)
        else:
            action = 0
            for a in range(1, 3):
                if q[cell, a] > q[cell, action]:
                    action = a
        steps = 0
        done = False
        while steps < max_steps and not done:
            v += (action - 1) * 0.001 + math.cos(3.0 * x) * -0.0025
            v = min(max(v, -0.07), 0.07)
            x = min(max(x + v, -1.2), 0.6)
            if x == -1.2 and v < 0.0:
                v = 0.0
            done = x >= 0.5
            f = (x + 1.2) * scale[0]
            i = int(f) if f < n_p - 1 else n_p - 1
            if x >= edges[0, i + 1]:
                i += 1
            f = (v + 0.07) * scale[1]
            j = int(f) if f < n_v - 1 else n_v - 1
            if v >= edges[1, j + 1]:
                j += 1
            next_cell = i * n_v + j
            best = 0
            for a in range(1, 3):
                if q[next_cell, a] > q[next_cell, best]:
                    best = a
            next_action = best
            if sarsa and rng.random() < epsilon:
                next_action = int(rng.random() * 3)
            target = -1.0
            if not done:
                target += 0.99 * q[next_cell, next_action]
            rate = 1.0 / (10.0 + 0.01 * visits[cell, action])
            q[cell, action] += rate * (target - q[cell, action])
            visits[cell, action] += 1
            steps += 1
            if not sarsa and not done and steps < max_steps:  # from the new values
                next_action = 0
                for a in range(1, 3):
                    if q[next_cell, a] > q[next_cell, next_action]:
                        next_action = a
                if rng.random() < epsilon:
                    next_action = int(rng.random() * 3)
            cell, action = next_cell, next_action
        lengths[episode] = steps


def compare(cls: type[Any], episodes: int, repeats: int) -> dict[str, float]:
    """Nanoseconds a step of both loops, medians, and the median of their ratios, pair by pair."""
    hill, bins, limit = Hill(), (20, 30), 30000
    grid = Grid.over(hill, bins)
    lengths = np.zeros(episodes, np.int64)

    def streams() -> tuple[np.random.Generator, np.random.Generator]:
        return np.random.default_rng(1), np.random.default_rng(2)

    def ours() -> Any:
        agent = cls.create(hill, bins=bins)

        def loop() -> TrainingLoop:
            parts = hill, agent, episode_hook(agent), learning_order(agent)
            return TrainingLoop(*parts, hill.n_actions, episodes, limit, *streams(), lengths)

        kernel = compile_loop(train, loop(), 0, episodes)
        return agent.values, lambda: kernel(loop(), 0, episodes)

    def hand() -> Any:
        q, visits = np.zeros((grid.size, 3)), np.zeros((grid.size, 3), np.int64)
        sarsa = cls is Sarsa
        return q, lambda: by_hand(
            q, visits, grid.edges, grid.scale, *bins, episodes, limit, *streams(), lengths, sarsa
        )

    tables = [_timed(make)[1] for make in (ours, hand)]  # compiles, too
    if not np.array_equal(*tables):
        raise AssertionError("the two loops learned different tables")
    pairs = [(_timed(ours)[0], _timed(hand)[0]) for _ in range(repeats)]
    steps = float(lengths.sum())
    return {
        "ours_ns": statistics.median(a for a, _ in pairs) / steps * 1e9,
        "by_hand_ns": statistics.median(b for _, b in pairs) / steps * 1e9,
        "ratio": statistics.median(a / b for a, b in pairs),
    }


def _timed(make: Callable[[], Any]) -> tuple[float, Any]:
    table, call = make()
    began = time.perf_counter()
    call()
    return time.perf_counter() - began, table


def main() -> None:
    """Parse, measure, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--episodes", type=int, default=4000)
    parser.add_argument("--repeats", type=int, default=7, help="pairs of runs")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    arguments = parser.parse_args()
    found = {cls.__name__: compare(cls, arguments.episodes, arguments.repeats) for cls in (QLearning, Sarsa)}
    if arguments.json:
        print(json.dumps(found))
        return
    for name, row in found.items():
        print(
            f"{name}: {row['ours_ns']:.0f} ns a step, by hand {row['by_hand_ns']:.0f} ns, "
            f"ratio {row['ratio']:.2f}"
        )


if __name__ == "__main__":
    main()
