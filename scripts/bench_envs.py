"""How fast are the environments? Everything in one run, side by side.

    python scripts/bench_envs.py

The parallel environment beside the same bookkeeping with bare dictionaries and no physics, which no other
with PettingZoo's interface can undercut, and beside SuperSuit's vector of Gymnasium cars where SuperSuit is
installed; the vector environment beside Gymnasium's synchronous vector. Steps of one car a second.
"""

import argparse
import time
from collections.abc import Callable
from functools import partial
from importlib.util import find_spec
from typing import Any

import gymnasium
import numpy as np

from envs.mountain_car_v0 import parallel_env

STEPS = 200
"""Steps of an episode: of cars that do not reach the goal."""


class BareDicts:
    """A parallel environment's bookkeeping alone: it drives nothing."""

    def __init__(self, cars: int) -> None:
        self.possible_agents = [f"car_{number}" for number in range(cars)]
        self.agents: list[str] = []
        self.steps = 0

    def reset(self, seed: int | None = None) -> tuple[dict[str, Any], dict[str, Any]]:
        """All cars, at rest."""
        self.agents, self.steps = list(self.possible_agents), 0
        return {car: np.zeros(2) for car in self.agents}, {car: {} for car in self.agents}

    def step(self, actions: dict[str, int]) -> tuple[dict[str, Any], ...]:
        """As many steps as an episode has."""
        cars, self.steps = self.agents, self.steps + 1
        late = self.steps >= STEPS
        chosen = {car: actions[car] for car in cars}
        observations = {car: np.array((chosen[car], 0.0)) for car in cars}
        self.agents = [car for car in cars if not late]
        return (
            observations,
            dict.fromkeys(cars, -1.0),
            dict.fromkeys(cars, False),
            dict.fromkeys(cars, late),
            {car: {} for car in cars},
        )


def parallel(cars: Any, seconds: float) -> float:
    """Steps of one car a second, resets included; the cars stand still."""
    cars.reset(seed=1)
    cars.step(dict.fromkeys(cars.agents, 1))  # compiled now, if at all
    count, began = 0, time.perf_counter()
    while time.perf_counter() - began < seconds:
        cars.reset()
        actions = dict.fromkeys(cars.agents, 1)
        for _ in range(STEPS):
            cars.step(actions)
        count += STEPS * len(actions)
    return count / (time.perf_counter() - began)


def vector(cars: Any, seconds: float) -> float:
    """The same of a vector environment, which resets its cars itself."""
    cars.reset(seed=1)
    actions = np.ones(cars.num_envs, np.int64)
    cars.step(actions)  # compiled now, if at all
    count, began = 0, time.perf_counter()
    while time.perf_counter() - began < seconds:
        for _ in range(STEPS):
            cars.step(actions)
        count += STEPS * cars.num_envs
    return count / (time.perf_counter() - began)


def super_suit(cars: int) -> Any:
    """SuperSuit's vector of Gymnasium cars."""
    import supersuit  # type: ignore[import-not-found, unused-ignore]  # optional

    single = gymnasium.make("MountainCar-v0")
    return supersuit.gym_vec_env_v0(single, cars)


def main() -> None:
    """Parse, measure in turns, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=0.5, help="of each measurement")
    parser.add_argument("--repeats", type=int, default=5, help="measurements, of which the median counts")
    parser.add_argument("--cars", type=int, nargs="+", default=[1, 8, 64, 512])
    parser.add_argument("--vectors", type=int, nargs="+", default=[1, 64, 4096])
    arguments = parser.parse_args()
    seconds, repeats = arguments.seconds, arguments.repeats

    print("| cars | parallel_env | bare dictionaries | ratio |")
    print("|---:|---:|---:|---:|")
    for count in arguments.cars:
        ours, floor = compared(
            partial(parallel, parallel_env(count, max_steps=STEPS), seconds),
            partial(parallel, BareDicts(count), seconds),
            repeats,
        )
        print(f"| {count} | {ours:,.0f} | {floor:,.0f} | {ours / floor:.2f} |", flush=True)
    if find_spec("supersuit"):
        ours, theirs = compared(
            partial(parallel, parallel_env(64, max_steps=STEPS), seconds),
            partial(vector, super_suit(64), seconds),
            repeats,
        )
        print(f"\nparallel_env with 64 cars is {ours / theirs:.1f} times SuperSuit's vector of 64 cars.")
    else:
        print("\nSuperSuit is not installed: no comparison with its vector.")
    print("\n| cars | vector environment | Gymnasium's sync vector | ratio |")
    print("|---:|---:|---:|---:|")
    for count in arguments.vectors:
        ours, theirs = compared(
            partial(vector, gymnasium.make_vec("envs:arena/MountainCar-v0", count), seconds),
            partial(vector, gymnasium.make_vec("MountainCar-v0", count, vectorization_mode="sync"), seconds),
            repeats,
        )
        print(f"| {count} | {ours:,.0f} | {theirs:,.0f} | {ours / theirs:,.0f} |", flush=True)


def compared(ours: Callable[[], float], theirs: Callable[[], float], repeats: int) -> tuple[float, float]:
    """The medians of measurements taken in turns."""
    pairs = [(ours(), theirs()) for _ in range(repeats)]
    medians = np.median(pairs, axis=0)
    return float(medians[0]), float(medians[1])


if __name__ == "__main__":
    main()
