"""Agents that are not built in, for tests; a module of its own so that workers can import it."""

from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from arena import Entrant, Evaluation, Tournament, Training

ACTIONS = {"left": 0, "right": 2}


def clip(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)


class Leaky(NamedTuple):
    """Compiles, with a helper function, and allocates memory in every step."""

    memory: NDArray[np.float64]
    leak: float

    @classmethod
    def create(cls, task: Any, *, leak: float = 0.5, label: str = "none") -> Self:
        return cls(np.zeros(task.n_actions), leak)

    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> int:
        noisy = self.memory + np.array([rng.random(), rng.random(), rng.random()])
        return int(np.argmax(noisy))

    def learn(
        self,
        observation: Any,
        action: int,
        reward: float,
        next_observation: Any,
        next_action: int,
        terminated: bool,
    ) -> None:
        self.memory[action] += self.leak * clip(next_observation[1] * 100.0, -1.0, 1.0)

    def greedy(self, observation: Any) -> int:
        return 2 if observation[1] + self.memory[2] * 1e-9 >= 0.0 else 0


class Scripted:
    """A plain Python class with state of its own: runs interpreted."""

    def __init__(self, favourite: int = 2) -> None:
        self.favourite = favourite
        self.counts = np.zeros(3, np.int64)
        self.text = {"it": "does not compile"}

    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> int:
        return self.favourite if rng.random() < progress else int(rng.integers(3))

    def learn(
        self,
        observation: Any,
        action: int,
        reward: float,
        next_observation: Any,
        next_action: int,
        terminated: bool,
    ) -> None:
        self.counts[action] += 1

    def greedy(self, observation: Any) -> int:
        return 2 if observation[1] >= 0 else 0


class Uncompilable(Leaky):
    """A named tuple beyond numba's subset of Python."""

    __slots__ = ()

    def greedy(self, observation: Any) -> int:
        return ACTIONS["right" if observation[1] >= 0.0 else "left"]


class Failing(Leaky):
    """Raises in the middle of its training."""

    __slots__ = ()

    def learn(
        self,
        observation: Any,
        action: int,
        reward: float,
        next_observation: Any,
        next_action: int,
        terminated: bool,
    ) -> None:
        self.memory[0] += 1.0
        if self.memory[0] > 50.0:
            raise RuntimeError("no more")


class Astray(Leaky):
    """Chooses an action that there is not."""

    __slots__ = ()

    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> int:
        return 3 if progress > 0.4 else 1


def race_of(*entrants: Entrant, seed: int = 7) -> Tournament:
    return Tournament(
        entrants,
        training=Training(episodes=6, max_steps=120),
        evaluation=Evaluation(episodes=5, max_steps=150),
        replicates=2,
        seed=seed,
        name="race",
    )
