"""Agents that break one rule of the contract each, beside a good one."""

import math
import random
import threading
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from agents.baselines import DoesNotLearn

Table = NDArray[np.float64]
LOCK = threading.Lock()


class Good(NamedTuple):
    """Holds to every rule; the others change one method."""

    values: Table
    n_actions: int

    @classmethod
    def create(cls, task: Any) -> Self:
        return cls(np.zeros(task.n_actions), task.n_actions)

    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> Any:
        return int(rng.random() * self.n_actions)

    def learn(
        self,
        observation: Any,
        action: int,
        reward: float,
        next_observation: Any,
        next_action: int,
        terminated: bool,
    ) -> None:
        self.values[action] += 0.1 * (abs(next_observation[1]) - self.values[action])

    def greedy(self, observation: Any) -> Any:
        return 2 if observation[1] >= 0.0 else 0


class Plain:
    """As good, but no named tuple: it runs interpreted, so nothing is compiled for it."""

    def __init__(self) -> None:
        self.values, self.n_actions = np.zeros(3), 3

    act = Good.act
    learn = Good.learn
    greedy = Good.greedy


class ChoosesThree(Plain):
    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> Any:
        return int(rng.random() * 3.5)


class ChoosesMinusOne(Good):
    __slots__ = ()

    def greedy(self, observation: Any) -> Any:
        return 2 if observation[1] >= 0.0 else -1


class ReturnsFloat(Good):
    __slots__ = ()

    def greedy(self, observation: Any) -> Any:
        return np.sign(observation[1]) + 1.0


class ReturnsBool(Plain):
    def greedy(self, observation: Any) -> Any:
        return bool(observation[1] >= 0.0)


class ForgetsTheLastCell(Good):
    """Ten cells, and the upper corner of the box is in the eleventh."""

    __slots__ = ()

    def greedy(self, observation: Any) -> Any:
        return [0, 0, 0, 0, 1, 1, 2, 2, 2, 2][int((observation[0] + 1.2) / (0.6 + 1.2) * 10)]


class BreaksFarAway(Plain):
    """NaN when the car jumps farther than any car can."""

    def learn(
        self,
        observation: Any,
        action: int,
        reward: float,
        next_observation: Any,
        next_action: int,
        terminated: bool,
    ) -> None:
        if abs(next_observation[0] - observation[0]) > 1.0:
            self.values[action] = math.nan


class RaisesFarAway(Plain):
    def learn(
        self,
        observation: Any,
        action: int,
        reward: float,
        next_observation: Any,
        next_action: int,
        terminated: bool,
    ) -> None:
        self.values[action] += math.log(1.5 - abs(next_observation[0] - observation[0]))


class LearnsWhenTested(Good):
    __slots__ = ()

    def greedy(self, observation: Any) -> Any:
        self.values[0] += 1.0
        return 2 if observation[1] >= 0.0 else 0


class SharesAList(Good):
    """What one run has seen, the next one knows."""

    __slots__ = ()

    seen: list[float] = []  # noqa: RUF012 (on purpose)

    def learn(
        self,
        observation: Any,
        action: int,
        reward: float,
        next_observation: Any,
        next_action: int,
        terminated: bool,
    ) -> None:
        self.seen.append(next_observation[0])
        self.values[action] = len(self.seen)


class DrawsFromNumpy(Good):
    __slots__ = ()

    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> Any:
        return int(np.random.random() * self.n_actions)  # noqa: NPY002 (on purpose)


class DrawsFromRandom(Plain):
    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> Any:
        return int(random.random() * self.n_actions)  # noqa: S311 (on purpose)


class DrawsInVain(Plain):
    """Its bits are right; those of an agent beside it would not be."""

    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> Any:
        np.random.random()  # noqa: NPY002 (on purpose)
        return int(rng.random() * self.n_actions)


class DrawsOtherwiseWhenMade(Plain):
    """Its generator is its own, and begins anywhere."""

    def __init__(self) -> None:
        super().__init__()
        self.values = np.random.default_rng().random(3)

    def learn(
        self,
        observation: Any,
        action: int,
        reward: float,
        next_observation: Any,
        next_action: int,
        terminated: bool,
    ) -> None:
        self.values[action] += 1.0


class SharesADictionary(DoesNotLearn):
    """What one agent has seen, the next one knows, until all is seen; no array shows it."""

    seen: dict[float, bool] = {}  # noqa: RUF012 (on purpose)

    def greedy(self, observation: Any) -> int:
        self.seen[round(float(observation[0]), 2)] = True
        return len(self.seen) % 2


class DrawsAnywhere(DoesNotLearn):
    """Its generator begins anywhere; no array shows it."""

    def __init__(self) -> None:
        self.rng = np.random.default_rng()

    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> int:
        return int(self.rng.integers(3))

    def greedy(self, observation: Any) -> int:
        return 1


class HoldsALock(Plain):
    def __init__(self, lock: Any = LOCK) -> None:
        with lock:
            super().__init__()


class KeepsWhatCannotBeSaved(Good):
    """Writes into an array that says it is constant: a checkpoint leaves it out."""

    __slots__ = ()

    @classmethod
    def create(cls, task: Any) -> Self:
        made = cls(np.zeros(task.n_actions), task.n_actions)
        made.values.flags.writeable = False
        return made

    def learn(
        self,
        observation: Any,
        action: int,
        reward: float,
        next_observation: Any,
        next_action: int,
        terminated: bool,
    ) -> None:
        self.values.flags.writeable = True
        self.values[action] += 1.0
        self.values.flags.writeable = False

    def greedy(self, observation: Any) -> Any:
        return 2 if self.values.sum() > 0.0 else 0


class DrawsNumbersByHand(Good):
    """A generator of one's own; machine integers overflow where Python's grow."""

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
        state = int(self.values[action]) + action
        self.values[action] = (state * 6364136223846793005 + 1442695040888963407) // 7 % 1000


class DividesByZero(Good):
    """The interpreter raises, machine code goes on with infinity."""

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
        zero = 1.0 if terminated else 0.0
        self.values[action] = 0.0 if 1.0 / zero > 0.0 else 1.0
