"""Agents that fail in every way; a module of its own so that workers can import it."""

import ctypes
import os
import signal
import sys
import threading
import time
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray


class Healthy:
    """Interpreted; counts what it does. The failing ones change one method."""

    def __init__(self) -> None:
        self.table = np.zeros(3)

    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> Any:
        return int(rng.integers(3))

    def learn(
        self, observation: Any, action: Any, reward: float, next_observation: Any, next_action: Any, end: bool
    ) -> None:
        self.table[action] += 1.0
        if self.table.sum() > 100.0:
            self.fail()

    def greedy(self, observation: Any) -> Any:
        return 2 if observation[1] >= 0.0 else 0

    def fail(self) -> None:
        pass


class Raises(Healthy):
    def fail(self) -> None:
        raise RuntimeError("learned too much")


class RaisesInGreedy(Healthy):
    def greedy(self, observation: Any) -> Any:
        raise KeyError("no policy")


class RaisesWhenMade(Healthy):
    def __init__(self) -> None:
        raise RuntimeError("never made")


class RaisesAtEpisode(Healthy):
    def begin_episode(self) -> None:
        raise RuntimeError("no episodes")


class ActsBeyond(Healthy):
    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> Any:
        return 3


class ActsNan(Healthy):
    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> Any:
        return float("nan")


class ActsText(Healthy):
    def greedy(self, observation: Any) -> Any:
        return "left"


class TurnsNan(Healthy):
    def fail(self) -> None:
        self.table[0] = np.nan


class Exits(Healthy):
    def fail(self) -> None:
        sys.exit("enough")


class ExitsAtOnce(Healthy):
    def fail(self) -> None:
        os._exit(3)


class Crashes(Healthy):
    def fail(self) -> None:
        ctypes.string_at(0)


class IsKilled(Healthy):
    def fail(self) -> None:
        os.kill(os.getpid(), signal.SIGKILL)


class Hangs(Healthy):
    def fail(self) -> None:
        while True:
            time.sleep(0.1)


class HangsWithTheInterpreter(Healthy):
    def fail(self) -> None:
        ctypes.PyDLL(None).sleep(3600)  # holds the interpreter's lock: its own watchdog cannot run


class EatsMemory(Healthy):
    def fail(self) -> None:
        self.hoard = [np.ones(4_000_000) for _ in range(200)]
        time.sleep(3600)


class CannotTravel(Healthy):
    def __init__(self, lock: Any = threading.Lock()) -> None:  # noqa: B008 (on purpose)
        super().__init__()


class HangsCompiled(NamedTuple):
    """Compiled; hangs in machine code."""

    table: NDArray[np.float64]

    @classmethod
    def create(cls, task: Any) -> Self:
        return cls(np.zeros(3))

    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> int:
        return int(rng.random() * 3)

    def learn(
        self, observation: Any, action: int, reward: float, next_observation: Any, next_action: int, end: bool
    ) -> None:
        self.table[action] += 1.0
        while self.table[action] > 0.0:
            self.table[action] += 1.0

    def greedy(self, observation: Any) -> int:
        return 2
