"""Thousands of cars for Gymnasium, stepped by one compiled loop.

``gymnasium.make_vec("envs:arena/MountainCar-v0", num_envs=4096)`` does what
``gymnasium.vector.SyncVectorEnv`` does with as many single cars, to the bit, for the same seed and in each
autoreset mode.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from gymnasium import logger, spaces
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from envs.fleet import Flags, Fleet, Floats
from envs.foundation.checks import choice, instance, integer
from envs.foundation.errors import InvalidValueError
from envs.hill import Hill
from envs.rendering import FRAMES_PER_SECOND, Image, picture
from envs.starts import start_state

__all__ = ["VectorCarEnv"]

Observations = NDArray[np.float32]


class VectorCarEnv(VectorEnv[Observations, NDArray[np.int64], NDArray[Any]]):
    """Independent cars on one hill; each starts anew when it has ended.

    Args:
        num_envs: how many cars.
        hill: what they drive on.
        max_episode_steps: a car that has not reached the goal after so many steps is truncated.
        render_mode: None or ``"rgb_array"``: one picture with all cars.
        autoreset_mode: when a car that has ended starts anew: in the next step, which then ignores its
            action (``"NextStep"``); in the same step, with the last observation in
            ``info["final_obs"]`` (``"SameStep"``); or never (``"Disabled"``): the caller resets with
            ``options={"reset_mask": mask}``.

    Raises:
        TypeError, ValueError: when an argument breaks its rule.
    """

    def __init__(
        self,
        num_envs: int = 1,
        hill: Hill = Hill(),  # noqa: B008 (immutable)
        max_episode_steps: int = 200,
        render_mode: str | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
    ) -> None:
        self.num_envs = integer("num_envs", num_envs, 1)
        self.hill = instance("hill", hill, Hill)
        self.max_episode_steps = integer("max_episode_steps", max_episode_steps, 1)
        if render_mode is not None:
            choice("render_mode", render_mode, ("rgb_array",))
        self.render_mode = render_mode
        modes = {mode.value: mode for mode in AutoresetMode}
        name = autoreset_mode.value if isinstance(autoreset_mode, AutoresetMode) else autoreset_mode
        self.autoreset_mode = modes[choice("autoreset_mode", name, modes)]
        self.metadata = {
            "render_modes": ["rgb_array"],
            "render_fps": FRAMES_PER_SECOND,
            "autoreset_mode": self.autoreset_mode,
        }
        low, high = np.array(hill.low, np.float32), np.array(hill.high, np.float32)
        self.single_observation_space = spaces.Box(low, high, dtype=np.float32)
        self.single_action_space = spaces.Discrete(hill.n_actions)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._fleet = Fleet(hill, num_envs)
        self._steps = np.zeros(num_envs, np.int64)
        self._ended = np.zeros(num_envs, np.bool_)
        self._streams: list[np.random.Generator | None] = [None] * num_envs

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: Mapping[str, Any] | None = None,
    ) -> tuple[Observations, dict[str, Any]]:
        """Put cars at a start.

        Args:
            seed: of the first car, the next ones have the numbers after it; or one for each car. Without
                it the streams go on.
            options: as of the single car; ``reset_mask``, bool, shape (num_envs,), says which cars are
                meant, all if it is left out.

        Raises:
            TypeError, ValueError: when an argument breaks its rule.
        """
        rest = dict(options or {})
        mask = _checked_mask(rest.pop("reset_mask", None), self.num_envs)
        if seed is None or isinstance(seed, (int, np.integer)):
            seeds = [None if seed is None else int(seed) + car for car in range(self.num_envs)]
        elif len(seed) == self.num_envs:
            seeds = list(seed)
        else:
            raise InvalidValueError(f"seed must be a number or {self.num_envs} of them, got {seed!r}")
        for car in np.flatnonzero(mask):
            if seeds[car] is not None:
                self._streams[car] = seeding.np_random(seeds[car])[0]
            self._start(int(car), rest)
        return self._fleet.states.astype(np.float32), {}

    def step(self, actions: NDArray[np.int64]) -> tuple[Observations, Floats, Flags, Flags, dict[str, Any]]:
        """Drive each car one step.

        Args:
            actions: 0, 1 or 2 for each car, shape (num_envs,).

        Raises:
            TypeError, ValueError: when the actions are not such, before the first reset, or, with
                autoreset disabled, when a car that has ended was not reset.
        """
        chosen = _checked_actions(actions, self.num_envs, self.hill.n_actions)
        if np.isnan(self._fleet.states).any():
            raise InvalidValueError("reset must be called before step")
        anew = self._ended
        if self.autoreset_mode == AutoresetMode.DISABLED and anew.any():
            raise InvalidValueError(
                f"cars that have ended must be reset, got a step of {np.flatnonzero(anew)}"
            )
        rewards, terminated = self._drive(chosen, anew)
        self._steps += ~anew
        truncated = (self._steps >= self.max_episode_steps) & ~anew
        info: dict[str, Any] = {}
        for car in np.flatnonzero(anew):
            self._start(int(car), {})
        self._ended = terminated | truncated
        if self.autoreset_mode == AutoresetMode.SAME_STEP and self._ended.any():
            info = self._start_ended()
        return self._fleet.states.astype(np.float32), rewards, terminated, truncated, info

    def render(self) -> tuple[Image, ...] | None:
        """One picture with all cars, as a tuple of one."""
        if self.render_mode is None:
            logger.warn("render is called without a render_mode; give one to gymnasium.make_vec")
            return None
        cars = {f"car {car}": (x, v) for car, (x, v) in enumerate(self._fleet.states.tolist())}
        return (picture(self.hill, cars, int(self._steps.max())),)

    def _drive(self, actions: NDArray[np.int64], anew: Flags) -> tuple[Floats, Flags]:
        """One step of all but those that start anew: rewards and whether they are at the goal."""
        fleet, some = self._fleet, anew.any()
        if some or len(fleet.driving) < self.num_envs:
            fleet.select(np.flatnonzero(~anew))
        fleet.actions[:] = actions[~anew] if some else actions
        fleet.step()
        if not some:
            return fleet.rewards.copy(), fleet.terminated.copy()
        rewards, terminated = np.zeros(self.num_envs), np.zeros(self.num_envs, np.bool_)
        rewards[~anew], terminated[~anew] = fleet.rewards, fleet.terminated
        return rewards, terminated

    def _start_ended(self) -> dict[str, Any]:
        """Let the cars that have ended start anew; their last observations, as Gymnasium tells them."""
        final, ended = np.full(self.num_envs, None, object), self._ended.copy()
        for car in np.flatnonzero(ended):
            final[car] = self._fleet.states[car].astype(np.float32)
            self._start(int(car), {})
        return {"final_obs": final, "_final_obs": ended, "final_info": {}, "_final_info": ended.copy()}

    def _start(self, car: int, options: Mapping[str, Any]) -> None:
        stream = self._streams[car]
        if stream is None:
            stream = self._streams[car] = seeding.np_random()[0]
        self._fleet.states[car] = start_state(self.hill, stream, options)
        self._steps[car], self._ended[car] = 0, False


def _checked_mask(mask: Any, count: int) -> Flags:
    if mask is None:
        return np.ones(count, np.bool_)
    if not isinstance(mask, np.ndarray) or mask.dtype != np.bool_ or mask.shape != (count,) or not mask.any():
        raise InvalidValueError(
            f"reset_mask must be a bool array of shape ({count},) with a True, got {mask!r}"
        )
    return mask


def _checked_actions(actions: Any, count: int, n_actions: int) -> NDArray[np.int64]:
    chosen = np.asarray(actions)
    if chosen.shape != (count,) or chosen.dtype.kind not in "iu":
        raise InvalidValueError(f"actions must be integers of shape ({count},), got {actions!r}")
    if chosen.min() < 0 or chosen.max() >= n_actions:
        raise InvalidValueError(f"actions must be at least 0 and less than {n_actions}, got {actions!r}")
    return chosen.astype(np.int64, copy=False)
