"""How fast are the environments? Everything in one run, side by side.

    pip install supersuit envpool
    python scripts/bench_envs.py

The parallel environment beside the same bookkeeping with bare dictionaries and no physics, which no other
with PettingZoo's interface can undercut by much, and beside SuperSuit's vector of Gymnasium cars. The vector
environment beside Gymnasium's synchronous vector, EnvPool and a loop in C. What is not installed is left out.
Steps of one car a second, medians of measurements taken in turns; the cars stand still, so that all episodes
have 200 steps.
"""

import argparse
import ctypes
import tempfile
import time
import warnings
from collections.abc import Callable
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from c_loops import built

from envs.mountain_car_v0 import parallel_env

STEPS = 200
"""Steps of an episode: of cars that do not reach the goal."""

ID = "envs:arena/MountainCar-v0"

C = r"""
void drive(int64_t cars, double *states, const int64_t *actions, int64_t *steps, uint64_t *chance,
           float *observations, double *rewards, uint8_t *terminated, uint8_t *truncated)
{
    for (int64_t car = 0; car < cars; car++) {
        double x = states[2 * car], v = states[2 * car + 1];
        if (steps[car] < 0) {  /* has ended: starts anew */
            *chance = *chance * 6364136223846793005ULL + 1442695040888963407ULL;
            x = -0.6 + 0.2 * ((*chance >> 11) * (1.0 / 9007199254740992.0)), v = 0.0;
            steps[car] = 0, rewards[car] = 0.0, terminated[car] = truncated[car] = 0;
        } else {
            move(&x, &v, actions[car]);
            steps[car]++, rewards[car] = -1.0;
            terminated[car] = x >= 0.5, truncated[car] = steps[car] >= 200;
            if (terminated[car] || truncated[car]) steps[car] = -1;
        }
        states[2 * car] = x, states[2 * car + 1] = v;
        observations[2 * car] = (float)x, observations[2 * car + 1] = (float)v;
    }
}
"""


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


class InC:
    """A vector environment that is one call of C."""

    def __init__(self, drive: Any, cars: int) -> None:
        self.drive, self.num_envs = drive, cars
        self.states, self.steps = np.zeros((cars, 2)), np.full(cars, -1)
        self.chance = np.array([1], np.uint64)

    def reset(self, seed: int | None = None) -> None:
        """All start in the next step."""
        self.steps[:] = -1

    def step(self, actions: np.ndarray[Any, np.dtype[np.int64]]) -> tuple[Any, ...]:
        """One step of all, in new arrays."""
        cars = self.num_envs
        told = np.empty((cars, 2), np.float32), np.empty(cars), np.empty(cars, bool), np.empty(cars, bool)
        arrays = (self.states, actions, self.steps, self.chance, *told)
        self.drive(ctypes.c_int64(cars), *(ctypes.c_void_p(array.ctypes.data) for array in arrays))
        return *told, {}


def parallel(cars: Any, seconds: float) -> float:
    """Steps of one car a second, resets included."""
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


def vector(cars: Any, count: int, seconds: float) -> float:
    """The same of a vector environment, which resets its cars itself."""
    cars.reset()
    actions = np.ones(count, np.int64)
    cars.step(actions)
    steps, began = 0, time.perf_counter()
    while time.perf_counter() - began < seconds:
        for _ in range(STEPS):
            cars.step(actions)
        steps += STEPS * count
    return steps / (time.perf_counter() - began)


def check_c(drive: Any) -> None:
    """See that the loop in C drives as our vector does, to the bit."""
    ours, theirs, rng = gymnasium.make_vec(ID, 5), InC(drive, 5), np.random.default_rng(1)
    ours.reset(seed=1, options={"start": (-0.5, 0.0)})
    theirs.states[:], theirs.steps[:] = (-0.5, 0.0), 0
    for _ in range(STEPS):
        actions = rng.integers(3, size=5)
        for one, other in zip(ours.step(actions)[:4], theirs.step(actions)[:4], strict=True):
            if one.tobytes() != other.tobytes():
                raise AssertionError("the loop in C drives otherwise")


def contenders_of_parallel(count: int, seconds: float) -> dict[str, Callable[[], float]]:
    """What the parallel environment is compared with, itself first."""
    found: dict[str, Callable[[], float]] = {
        "parallel_env": partial(parallel, parallel_env(count, max_steps=STEPS), seconds),
        "bare dictionaries": partial(parallel, BareDicts(count), seconds),
    }
    if find_spec("supersuit"):
        import supersuit  # type: ignore[import-not-found, unused-ignore]  # optional

        theirs = supersuit.gym_vec_env_v0(gymnasium.make("MountainCar-v0"), count)
        found["SuperSuit's vector"] = partial(vector, theirs, count, seconds)
    return found


def contenders_of_vector(count: int, seconds: float, drive: Any) -> dict[str, Callable[[], float]]:
    """What the vector environment is compared with, itself first."""
    sync = gymnasium.make_vec("MountainCar-v0", count, vectorization_mode="sync")
    found: dict[str, Any] = {"vector": gymnasium.make_vec(ID, count), "Gymnasium's sync vector": sync}
    if find_spec("envpool"):
        import envpool  # type: ignore[import-not-found, unused-ignore]  # optional

        found["EnvPool"] = envpool.make_gymnasium("MountainCar-v0", num_envs=count)
    if drive:
        found["C"] = InC(drive, count)
    return {name: partial(vector, cars, count, seconds) for name, cars in found.items()}


def table(
    sizes: list[int], repeats: int, contenders: Callable[[int], dict[str, Callable[[], float]]]
) -> None:
    """Print steps a second for each size; behind the first contender's, what it is of each other's."""
    for number, size in enumerate(sizes):
        measured = contenders(size)
        if not number:
            ours, *others = measured
            print("\n| cars |", " | ".join([ours, *(f"{name} | ratio" for name in others)]), "|")
            print("|---:|" + "---:|" * (2 * len(others) + 1))
        rounds = [[measure() for measure in measured.values()] for _ in range(repeats)]
        first, *rest = np.median(rounds, axis=0)
        row = [f"{first:,.0f}", *(f"{other:,.0f} | {first / other:.2f}" for other in rest)]
        print(f"| {size} |", " | ".join(row), "|", flush=True)


def main() -> None:
    """Parse, measure in turns, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=0.5, help="of each measurement")
    parser.add_argument("--repeats", type=int, default=5, help="measurements, of which the median counts")
    parser.add_argument("--cars", type=int, nargs="+", default=[1, 8, 64, 512])
    parser.add_argument("--vectors", type=int, nargs="+", default=[1, 64, 4096])
    arguments = parser.parse_args()
    seconds, repeats = arguments.seconds, arguments.repeats
    warnings.simplefilter("ignore")  # of the others
    gymnasium.logger.min_level = gymnasium.logger.ERROR
    with tempfile.TemporaryDirectory() as folder:
        drive = built(C, "drive", Path(folder))
        if drive:
            check_c(drive)
        table(arguments.cars, repeats, lambda count: contenders_of_parallel(count, seconds))
        table(arguments.vectors, repeats, lambda count: contenders_of_vector(count, seconds, drive))


if __name__ == "__main__":
    main()
