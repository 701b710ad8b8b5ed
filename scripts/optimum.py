"""The fewest steps to the goal: what is proved, against a search that knows no theory.

    python scripts/optimum.py --starts 2000

prints the bounds of ``agents.optimal`` for starts drawn as the hill draws them; how they compare with an
exhaustive search of all drives of full thrust that change its direction at most twice; and how the drivers
that are made from the hill's constants do from the same starts.
"""

import argparse
import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.algorithms.value_iteration import ValueIteration
from agents.optimal import NEVER, Optimal, optimal_steps
from arena.execution.loops import EvaluationLoop, evaluate
from envs import Hill
from envs.compilation import compile_loop

Steps = NDArray[np.int64]
PATIENCE = 500


def exhaustive(hill: Hill, positions: NDArray[np.float64], most: int, found: Steps) -> None:
    """Fewest steps, at most ``most``, of all drives left-right-left and right-left-right."""
    for start in range(len(positions)):
        found[start] = most
        for first in (0, 2):
            one = (positions[start], 0.0)
            for begin in range(found[start]):  # of the second block
                other = one
                for last in range(begin, found[start]):  # of the third block
                    state, step, there = other, last, False
                    while step < found[start] and not there:
                        state, _, there = hill.step(state, first)
                        step += 1
                    if there:
                        found[start] = min(found[start], step)
                    other, _, there = hill.step(other, 2 - first)
                    if there:
                        found[start] = min(found[start], last + 1)
                        break
                one, _, there = hill.step(one, first)
                if there:
                    break


def lengths(hill: Hill, agent: Any, positions: NDArray[np.float64]) -> Steps:
    """Steps of an agent's greedy drives; ``NEVER`` where it needs more than ``PATIENCE``."""
    starts = np.stack([positions, np.zeros_like(positions)], axis=1)
    steps, reached = np.zeros(len(starts), np.int64), np.zeros(len(starts), np.bool_)
    loop = EvaluationLoop(hill, agent, hill.n_actions, starts, PATIENCE, steps, reached)
    compile_loop(evaluate, loop)(loop)
    return np.where(reached, steps, NEVER)


def told(label: str, steps: Steps, least: Steps) -> str:
    """A line about the drives of one agent."""
    there = steps < NEVER
    mean = f"mean {steps[there].mean():.3f}" if there.any() else "never there"
    return (
        f"{label:28}{mean}; {100 * np.mean(steps == least):.1f}% the optimum, "
        f"{100 * np.mean(~there):.1f}% not there in {PATIENCE} steps"
    )


def main() -> None:
    """Parse, compute, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--starts", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--integrator", choices=["semi-implicit", "explicit"], default="semi-implicit")
    arguments = parser.parse_args()

    hill, rng = Hill(integrator=arguments.integrator), np.random.default_rng(arguments.seed)
    positions = np.array([hill.reset(rng)[0] for _ in range(arguments.starts)])
    began, busy = time.perf_counter(), time.process_time()
    lower, upper = optimal_steps(hill, positions)
    clock, busy = time.perf_counter() - began, time.process_time() - busy
    print(
        f"{len(positions)} starts in [{hill.min_start}, {hill.max_start}): {clock:.1f} s, {busy:.1f} s busy"
    )
    print(f"lower bound: mean {lower.mean():.3f}, range {lower.min()}-{lower.max()}")
    print(f"upper bound: mean {upper.mean():.3f}, range {upper.min()}-{upper.max()}")
    print(f"equal: {100 * np.mean(lower == upper):.2f}%; greatest gap: {(upper - lower).max()}")

    found = np.zeros(len(positions), np.int64)
    search = (hill, positions, int(upper.max()) + 3, found)
    compile_loop(exhaustive, *search)(*search)
    print(f"exhaustive search of 2 switches: mean {found.mean():.3f}")
    print(
        f"the upper bound is better {np.sum(upper < found)} times, "
        f"equal {np.sum(upper == found)}, worse {np.sum(upper > found)}"
    )

    print(told("optimal", lengths(hill, Optimal.create(hill), positions), upper))
    for bins in (10, 20, 40):
        for polish in (0, 20):
            planner = ValueIteration.create(hill, bins=bins, polish=polish, rng=np.random.default_rng(1))
            label = f"{bins}x{bins}, {'polished' if polish else 'value iteration'}"
            print(told(label, lengths(hill, planner, positions), upper))


if __name__ == "__main__":
    main()
