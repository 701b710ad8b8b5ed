"""A driver that swings: a package's agent, for tests/test_plugin_package.py."""

from typing import Annotated, Any, NamedTuple, Self

import numpy as np
from annotated_types import Interval
from numpy.typing import NDArray


class Pendulum(NamedTuple):
    """Pushes the way the car moves, mostly; counts what it does."""

    counts: NDArray[np.int64]
    whim: float

    @classmethod
    def create(cls, task: Any, *, whim: Annotated[float, Interval(ge=0, le=1)] = 0.1) -> Self:
        """The agent; ``whim`` is the share of random actions."""
        return cls(np.zeros(task.n_actions, np.int64), whim)

    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> int:
        """Any action on a whim, else the greedy one."""
        if rng.random() < self.whim:
            return int(rng.random() * len(self.counts))
        return self.greedy(observation)

    def learn(
        self,
        observation: Any,
        action: int,
        reward: float,
        next_observation: Any,
        next_action: int,
        terminated: bool,
    ) -> None:
        """Count."""
        self.counts[action] += 1

    def greedy(self, observation: Any) -> int:
        """Right for a velocity of at least 0, else left."""
        return 2 if observation[1] >= 0.0 else 0


class Mute:
    """Lacks ``greedy``, so that it is refused."""

    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> int:
        """Nothing."""
        return 1

    def learn(
        self,
        observation: Any,
        action: int,
        reward: float,
        next_observation: Any,
        next_action: int,
        terminated: bool,
    ) -> None:
        """Nothing."""
