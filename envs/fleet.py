"""The states of several cars on one hill, stepped together by one compiled loop."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from envs.compilation.kernels import CompilationError, entry_point
from envs.hill import Hill

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]


class Fleet:
    """Cars by number, some of which drive.

    The loop is compiled at the first step; for a hill whose methods are beyond numba it is interpreted.

    Args:
        hill: what they drive on.
        cars: how many.

    Attributes:
        states: position and velocity of each car, shape (cars, 2); they are to be put somewhere first.
        driving: the numbers of the cars that drive, shape (driving,); all at first.
        actions: what these are to do, to be filled before each step, shape (driving,).
        observations: what these observed last, shape (driving, 2). This and the following two are
            overwritten by the next step.
        rewards: what these got last, shape (driving,).
        terminated: whether these have reached the goal, shape (driving,).
    """

    def __init__(self, hill: Hill, cars: int) -> None:
        self.hill = hill
        self.states = np.full((cars, 2), np.nan)
        self._count = np.array([cars])
        self._numbers, self._actions = np.arange(cars), np.zeros(cars, np.int64)
        self._observations, self._rewards = np.empty((cars, 2)), np.empty(cars)
        self._terminated = np.empty(cars, np.bool_)
        self._next: Callable[[], int] | None = None
        self.select(range(cars))

    def select(self, cars: Sequence[int] | Integers) -> None:
        """Let these cars drive from now on, and no others."""
        count = self._count[0] = len(cars)
        self._numbers[:count] = cars
        self.driving, self.actions = self._numbers[:count], self._actions[:count]
        self.observations, self.rewards = self._observations[:count], self._rewards[:count]
        self.terminated = self._terminated[:count]

    def step(self) -> int:
        """One step of the cars that drive, by their actions. How many of them reached the goal."""
        if self._next is None:
            self._next = self._loop()
        try:
            return self._next()
        except BaseException:
            self._next = None  # what has raised does not go on
            raise

    def __getstate__(self) -> dict[str, Any]:
        """All but the loop: a copy begins its own."""
        return self.__dict__ | {"_next": None}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self.select(self.driving)  # views of the arrays of the copy

    def _loop(self) -> Callable[[], int]:
        results = (self._observations, self._rewards, self._terminated)
        arguments = (self.hill, self.states, self._count, self._numbers, self._actions, *results)
        try:
            loop = entry_point(steps, *arguments)
        except CompilationError:
            loop = steps
        made: Iterator[int] = loop(*arguments)
        return made.__next__


def steps(
    hill: Any,
    states: Floats,
    count: Integers,
    numbers: Integers,
    actions: Integers,
    observations: Floats,
    rewards: Floats,
    terminated: Flags,
) -> Iterator[int]:
    """Step some cars each time that the next value is asked for: how many reached the goal.

    A generator, because the next value of a compiled one costs a twentieth of a call, which looks at each
    constant of the hill. Its arrays must outlive it: it does not count its references.

    Args:
        hill: what they drive on.
        states: of all cars, changed in place, shape (cars, 2).
        count: how many drive, shape (1,).
        numbers: of those that drive, at the beginning of shape (cars,), as in all that follow.
        actions: of these.
        observations: filled.
        rewards: filled.
        terminated: filled.
    """
    while True:
        there = 0
        for place in range(count[0]):
            car = numbers[place]
            state = (float(states[car, 0]), float(states[car, 1]))
            state, rewards[place], terminated[place] = hill.step(state, actions[place])
            states[car, 0], states[car, 1] = state
            seen = hill.observe(state)
            observations[place, 0], observations[place, 1] = seen
            there += terminated[place]
        yield there
