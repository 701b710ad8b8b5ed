"""The states of several cars on one hill, stepped together."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from envs.compilation import CompilationError, entry_point
from envs.hill import Hill, State

COMPILED = 8
"""From so many cars on the loop over them is compiled: below, a call of machine code takes longer."""

Observation = NDArray[np.float64]
Moved = tuple[Sequence[Observation], list[float], list[bool]]


def make_fleet(hill: Hill, cars: int) -> "Fleet":
    """The states of ``cars`` cars, which are to be put somewhere first."""
    if cars >= COMPILED:
        try:
            return CompiledFleet(hill, cars)
        except CompilationError:  # somebody's hill with methods beyond numba
            pass
    return Fleet(hill, cars)


class Fleet:
    """Cars by number, stepped by Python.

    Args:
        hill: what they drive on.
        cars: how many.
    """

    def __init__(self, hill: Hill, cars: int) -> None:
        self.hill = hill
        self._states: list[State] = [(np.nan, np.nan)] * cars

    def put(self, car: int, state: State) -> None:
        """Put a car somewhere."""
        self._states[car] = state

    def states(self) -> list[State]:
        """Position and velocity of each car."""
        return self._states

    def observe(self, cars: list[int]) -> Sequence[Observation]:
        """What these cars observe, an array each."""
        return [np.array(self.hill.observe(self._states[car])) for car in cars]

    def step(self, cars: list[int], actions: list[int]) -> Moved:
        """Drive these cars one step: their observations, rewards, and whether they reached the goal."""
        hill, states = self.hill, self._states
        observations, rewards, terminated = [], [], []
        for car, action in zip(cars, actions, strict=True):
            states[car], reward, there = hill.step(states[car], action)
            observations.append(np.array(hill.observe(states[car])))
            rewards.append(reward)
            terminated.append(there)
        return observations, rewards, terminated


class CompiledFleet(Fleet):
    """The same, to the bit, in one compiled loop.

    Raises:
        CompilationError: when the hill cannot be compiled.
    """

    def __init__(self, hill: Hill, cars: int) -> None:
        self.hill = hill
        self._array = np.full((cars, 2), np.nan)
        self._loop = self._compiled()

    def put(self, car: int, state: State) -> None:  # noqa: D102 (described by the base, as all here)
        self._array[car] = state

    def states(self) -> list[State]:  # noqa: D102
        return [(position, velocity) for position, velocity in self._array.tolist()]

    def observe(self, cars: list[int]) -> Sequence[Observation]:  # noqa: D102
        return [np.array(self.hill.observe(state)) for state in map(tuple, self._array[cars].tolist())]

    def step(self, cars: list[int], actions: list[int]) -> Moved:  # noqa: D102
        arguments = self._arguments(cars, actions)
        self._loop(*arguments)
        *_, observations, rewards, terminated = arguments
        return list(observations), rewards.tolist(), terminated.tolist()  # rows: an array each

    def __getstate__(self) -> dict[str, Any]:
        """All but the machine code."""
        return {name: value for name, value in self.__dict__.items() if name != "_loop"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._loop = self._compiled()

    def _compiled(self) -> Callable[..., Any]:
        return entry_point(advance, *self._arguments([0], [0]))

    def _arguments(self, cars: list[int], actions: list[int]) -> tuple[Any, ...]:
        count = len(cars)
        return (
            self.hill,
            self._array,
            np.array(cars, np.int64),
            np.array(actions, np.int64),
            np.empty((count, 2)),
            np.empty(count),
            np.empty(count, np.bool_),
        )


def advance(
    hill: Any,
    states: NDArray[np.float64],
    cars: NDArray[np.int64],
    actions: NDArray[np.int64],
    observations: NDArray[np.float64],
    rewards: NDArray[np.float64],
    terminated: NDArray[np.bool_],
) -> None:
    """One step of some cars.

    Args:
        hill: what they drive on.
        states: of all cars, changed in place, shape (cars, 2).
        cars: the numbers of those that drive, shape (driving,).
        actions: of these, shape (driving,).
        observations: filled, shape (driving, 2).
        rewards: filled, shape (driving,).
        terminated: filled, shape (driving,).
    """
    for place in range(cars.shape[0]):
        car = cars[place]
        state = (states[car, 0], states[car, 1])
        state, rewards[place], terminated[place] = hill.step(state, actions[place])
        states[car, 0], states[car, 1] = state
        seen = hill.observe(state)
        observations[place, 0], observations[place, 1] = seen
