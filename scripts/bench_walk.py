"""How fast are the random walks? Ours beside the same loop in C and in plain Python, in one run.

    python scripts/bench_walk.py

All three walk the same walks, to the bit; that is checked first. The loop in C has the default hill's
constants written in and numpy's generator (PCG64) in line; it is built when there is a compiler (``gcc -O3``,
without fused multiply-add, which would change bits). Plain Python walks a part of the episodes, for the time
of a step. Only ratios from one run mean something.
"""

import argparse
import ctypes
import json
import math
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from c_loops import built

from arena import random_walk
from arena.reproduction import PAPER
from arena.reproduction.published_values import PAPER_SECONDS
from envs.foundation.streams import stream

MAX_STEPS = 1_000_000

C = r"""
typedef unsigned __int128 u128;
static const u128 multiplier = ((u128)2549297995355413924ULL << 64) | 4865540595714422341ULL;

static inline double next_double(u128 *state, u128 increment)
{
    *state = *state * multiplier + increment;
    uint64_t mixed = (uint64_t)(*state >> 64) ^ (uint64_t)*state;
    unsigned turn = (unsigned)(*state >> 122);
    return (((mixed >> turn) | (mixed << (-turn & 63))) >> 11) * (1.0 / 9007199254740992.0);
}

int64_t walk(const uint64_t *seeded, int64_t max_steps, double *bounds)
{
    u128 state = ((u128)seeded[0] << 64) | seeded[1], increment = ((u128)seeded[2] << 64) | seeded[3];
    double x = -0.6 + (-0.4 - -0.6) * next_double(&state, increment), v = 0.0;
    double least_x = bounds[0], most_x = bounds[1], least_v = bounds[2], most_v = bounds[3];
    int64_t steps = 0;
    while (steps < max_steps) {
        int action = (int)(next_double(&state, increment) * 3.0);
        move(&x, &v, action);
        steps++;
        if (x < least_x) least_x = x;
        if (x > most_x) most_x = x;
        if (v < least_v) least_v = v;
        if (v > most_v) most_v = v;
        if (x >= 0.5) break;
    }
    bounds[0] = least_x, bounds[1] = most_x, bounds[2] = least_v, bounds[3] = most_v;
    return steps;
}
"""

Lengths = list[int]


def in_c(walk: Any) -> Callable[[int], Lengths]:
    """The walks of the function in C."""
    walk.restype, walk.argtypes = ctypes.c_int64, [ctypes.c_void_p, ctypes.c_int64, ctypes.c_void_p]

    def walks(episodes: int) -> Lengths:
        bounds, lengths = np.zeros(4), []
        for episode in range(episodes):
            told: Any = stream(0, "walk", str(episode)).bit_generator.state["state"]
            words = [part for key in ("state", "inc") for part in divmod(told[key], 2**64)]
            seeded = np.array(words, np.uint64)
            lengths.append(walk(seeded.ctypes.data, MAX_STEPS, bounds.ctypes.data))
        return lengths

    return walks


def in_python(episodes: int) -> Lengths:  # noqa: C901 (no calls, on purpose)
    """The same in plain Python, tuned: names are local, random numbers come in blocks."""
    cos, lengths = math.cos, []
    least_x = most_x = least_v = most_v = 0.0
    for episode in range(episodes):
        rng = stream(0, "walk", str(episode))
        x, v, steps = -0.6 + (-0.4 - -0.6) * rng.random(), 0.0, 0
        while x < 0.5 and steps < MAX_STEPS:
            for number in rng.random(4096).tolist():
                v += (int(number * 3.0) - 1) * 0.001 + cos(3.0 * x) * -0.0025
                if v < -0.07:
                    v = -0.07
                elif v > 0.07:
                    v = 0.07
                x += v
                if x < -1.2:
                    x = -1.2
                    if v < 0.0:  # noqa: PLR1730 (faster than ``max``)
                        v = 0.0
                if x < least_x:
                    least_x = x
                elif x > most_x:
                    most_x = x
                if v < least_v:
                    least_v = v
                elif v > most_v:
                    most_v = v
                steps += 1
                if x >= 0.5:
                    break
        lengths.append(steps)
    return lengths


def ours(episodes: int, jobs: int = 1) -> Lengths:
    """As the arena walks."""
    found: Lengths = random_walk(episodes, n_jobs=jobs, max_steps=MAX_STEPS).lengths.tolist()
    return found


def nanoseconds(walks: Callable[[int], Lengths], episodes: int) -> float:
    """Of a step."""
    began = time.perf_counter()
    lengths = walks(episodes)
    return (time.perf_counter() - began) / sum(lengths) * 1e9


def measure(episodes: int, repeats: int, part: int) -> dict[str, float]:
    """Nanoseconds a step, medians, and medians of the ratios, run by run."""
    contenders: dict[str, Callable[[int], Lengths]] = {"ours": ours, "ours, 2 workers": lambda n: ours(n, 2)}
    with tempfile.TemporaryDirectory() as folder:
        walk = built(C, "walk", Path(folder))
        if walk:
            contenders["C"] = in_c(walk)
        else:
            print("no C compiler: its loop is left out", file=sys.stderr)
        expected = in_python(part)
        for name, walks in contenders.items():  # compiles, and starts the workers, too
            if walks(episodes)[:part] != expected:
                raise AssertionError(f"{name} walked other walks")
        rounds = [
            {name: nanoseconds(walks, episodes) for name, walks in contenders.items()}
            | {"Python": nanoseconds(in_python, part)}
            for _ in range(repeats)
        ]
    names = rounds[0]
    found = {name: statistics.median(one[name] for one in rounds) for name in names}
    for name in names:
        found[f"{name} / ours"] = statistics.median(one[name] / one["ours"] for one in rounds)
    return found


def main() -> None:
    """Parse, measure, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--episodes", type=int, default=2000)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--part", type=int, default=40, help="episodes of the loop in Python")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    arguments = parser.parse_args()
    found = measure(arguments.episodes, arguments.repeats, min(arguments.part, arguments.episodes))
    if arguments.json:
        print(json.dumps(found))
        return
    print(f"{'':16} {'ns a step':>10} {'million steps a second':>23} {'time, ours = 1':>15}")
    for name in [name for name in found if "/" not in name]:
        row = f"{found[name]:10.1f} {1000.0 / found[name]:23.2f} {found[f'{name} / ours']:15.2f}"
        print(f"{name:16} {row}")
    theirs = 1e9 * PAPER_SECONDS / (PAPER.episodes * PAPER.mean)
    print(f"The paper's program took {theirs / 1000.0:.1f} microseconds a step, on an i7-5500U;")
    print(f"tuned plain Python takes {found['Python'] / 1000.0:.2f} here.")


if __name__ == "__main__":
    main()
