"""Stands in for Stable-Baselines3 where the docs are executed: the same calls, no torch.

Not on the path of the tests; it is copied beside what is to import it.
"""

from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray


class PPO:
    """What it learns, in any time, is to thrust the way the car moves."""

    def __init__(self, policy: str, env: Any, seed: int | None = None, device: str = "auto") -> None:
        self.n_actions = int(env.action_space.n)

    def learn(self, total_timesteps: int) -> Self:
        return self

    def save(self, path: str) -> None:
        Path(path).write_text(str(self.n_actions))

    @classmethod
    def load(cls, path: str | Path, device: str = "auto") -> Self:
        model = cls.__new__(cls)
        model.n_actions = int(Path(path).read_text())
        return model

    def predict(
        self, observation: Any, state: Any = None, episode_start: Any = None, deterministic: bool = False
    ) -> tuple[NDArray[np.int64], Any]:
        if not deterministic:
            return np.array(np.random.randint(self.n_actions)), state  # noqa: NPY002 (as theirs does)
        if not isinstance(observation, np.ndarray) or observation.dtype != np.float32:
            raise TypeError(f"an environment shows float32 arrays, got {observation!r}")
        return np.where(observation[..., 1] >= 0.0, self.n_actions - 1, 0), state
