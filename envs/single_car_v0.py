"""One car for Gymnasium: drop-in for its ``MountainCar-v0``, on any hill.

``gymnasium.make("envs:arena/MountainCar-v0")`` has the same observations, rewards, endings and starts for a
seed as ``gymnasium.make("MountainCar-v0")``, to the bit, and the same limit of 200 steps.
"""

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from envs.foundation.checks import choice, instance, integer
from envs.foundation.errors import InvalidValueError
from envs.hill import Hill, State
from envs.rendering import FRAMES_PER_SECOND, RENDER_MODES, Rendered
from envs.starts import start_state

__all__ = ["SingleCarEnv"]

Observation = NDArray[np.float32]


class SingleCarEnv(Rendered, gymnasium.Env[Observation, np.int64]):
    """A car that is to reach the goal.

    | | |
    |---|---|
    | Actions | ``Discrete(3)``: thrust left, none, right |
    | Observations | ``Box`` of float32: position and velocity, rounded; the car itself is exact |
    | Rewards | -1 for every step |
    | Ending | terminated at the goal; ``gymnasium.make`` truncates after 200 steps |

    Args:
        hill: what it drives on.
        render_mode: None, ``"human"``, ``"rgb_array"`` or ``"ansi"``.

    Raises:
        TypeError, ValueError: when an argument breaks its rule.
    """

    metadata = {  # noqa: RUF012 (declared so by the base)
        "render_modes": list(RENDER_MODES),
        "render_fps": FRAMES_PER_SECOND,
    }

    def __init__(self, hill: Hill = Hill(), render_mode: str | None = None) -> None:  # noqa: B008 (immutable)
        self.hill = instance("hill", hill, Hill)
        if render_mode is not None:
            choice("render_mode", render_mode, RENDER_MODES)
        self.render_mode = render_mode
        self.observation_space = spaces.Box(
            np.array(hill.low, np.float32), np.array(hill.high, np.float32), dtype=np.float32
        )
        self.action_space = spaces.Discrete(hill.n_actions)
        self._state: State | None = None
        self._steps = 0

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Put the car at a start.

        Args:
            seed: restarts the random stream; without it the stream goes on.
            options: ``{"start": (position, velocity)}`` puts the car there; ``{"low": ..., "high": ...}``
                draws its position between them, as in Gymnasium's environment.

        Raises:
            TypeError, ValueError: when an option breaks its rule.
        """
        super().reset(seed=seed)
        self._state = start_state(self.hill, self.np_random, options)
        self._steps = 0
        self._update_window()
        return np.array(self._state, np.float32), {}

    def step(self, action: np.int64 | int) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Drive one step.

        Raises:
            TypeError, ValueError: when the action is not 0, 1 or 2, or before the first reset.
        """
        if self._state is None:
            raise InvalidValueError("reset must be called before step")
        chosen = integer("action", action, 0)
        if chosen >= self.hill.n_actions:
            raise InvalidValueError(f"action must be less than {self.hill.n_actions}, got {action}")
        self._state, reward, terminated = self.hill.step(self._state, chosen)
        self._steps += 1
        self._update_window()
        return np.array(self._state, np.float32), reward, terminated, False, {}

    def _rendered_state(self) -> tuple[dict[str, State], int]:
        """The car, if there was a reset."""
        return ({} if self._state is None else {"car": self._state}), self._steps
