"""Mountain Car for PettingZoo: several independent cars, each alone on an identical hill.

| | |
|---|---|
| Agents | ``car_0``, ``car_1``, ... or the names given |
| Actions | ``Discrete(3)``: thrust left, none, right |
| Observations | ``Box`` of float64: the exact position and velocity |
| Rewards | -1 for every step |
| Ending | each car on its own: terminated at the goal, truncated after ``max_steps``, never both |
"""

from collections.abc import Iterable, Mapping
from itertools import compress
from typing import Any, ClassVar

import numpy as np
from gymnasium import spaces
from gymnasium.utils import EzPickle
from numpy.typing import NDArray
from pettingzoo import AECEnv, ParallelEnv
from pettingzoo.utils import AssertOutOfBoundsWrapper, parallel_to_aec

from envs.fleet import Fleet
from envs.foundation.checks import choice, instance, integer
from envs.foundation.errors import InvalidTypeError, InvalidValueError
from envs.foundation.streams import stream
from envs.hill import Hill, State
from envs.rendering import FRAMES_PER_SECOND, RENDER_MODES, Rendered
from envs.starts import checked_state

__all__ = ["env", "parallel_env", "raw_env"]

Observation = NDArray[np.float64]
_PLAIN = frozenset({int, np.int64})  # what actions usually are, and need no slower look


def env(**arguments: Any) -> AECEnv[str, Observation, int | None]:
    """The turn-based (AEC) environment with PettingZoo's usual checks; arguments of ``parallel_env``."""
    return AssertOutOfBoundsWrapper(raw_env(**arguments))


def raw_env(**arguments: Any) -> AECEnv[str, Observation, int | None]:
    """The turn-based (AEC) environment; arguments of ``parallel_env``."""
    return parallel_to_aec(parallel_env(**arguments))


class parallel_env(Rendered, ParallelEnv[str, Observation, int], EzPickle):  # type: ignore[misc]  # the base is untyped
    """Several cars that drive at the same time and do not touch each other.

    Args:
        cars: how many, or their names.
        hill: the hill that each of them drives on.
        max_steps: a car that has not reached the goal after so many steps is truncated.
        same_start: whether all cars of an episode start at one position.
        render_mode: None, ``"ansi"`` (text), ``"rgb_array"`` (pictures) or ``"human"`` (a window, which
            follows every step; needs pygame).
        max_cycles: PettingZoo's usual name for ``max_steps``; overrides it.

    Each car's starts come from a random stream of its own, which belongs to its name: a car's
    trajectory does not depend on which others there are.

    Raises:
        TypeError, ValueError: when an argument breaks its rule.
    """

    metadata: ClassVar[dict[str, Any]] = {
        "name": "mountain_car_v0",
        "render_modes": list(RENDER_MODES),
        "render_fps": FRAMES_PER_SECOND,
        "is_parallelizable": True,
    }

    def __init__(
        self,
        cars: int | Iterable[str] = 2,
        hill: Hill = Hill(),  # noqa: B008 (immutable)
        max_steps: int = 200,
        same_start: bool = False,
        render_mode: str | None = None,
        *,
        max_cycles: int | None = None,
    ) -> None:
        if render_mode is not None:
            choice("render_mode", render_mode, RENDER_MODES)
        self.possible_agents = names = _names(cars)
        # The arguments are kept, as in all of PettingZoo's environments; pickled is the episode as well.
        EzPickle.__init__(self, names, hill, max_steps, same_start, render_mode, max_cycles=max_cycles)
        self.agents: list[str] = []
        self.hill = instance("hill", hill, Hill)
        self.max_steps = integer("max_steps", max_steps if max_cycles is None else max_cycles, 1)
        self.same_start = instance("same_start", same_start, bool)
        self.render_mode = render_mode
        low, high = np.array(hill.low), np.array(hill.high)
        self.observation_spaces = {
            car: spaces.Box(low, high, dtype=np.float64) for car in self.possible_agents
        }
        self.action_spaces = {car: spaces.Discrete(hill.n_actions) for car in self.possible_agents}
        self._fleet = Fleet(hill, len(self.possible_agents))
        self._streams: dict[str, np.random.Generator] = {}
        self._steps = 0
        self.state_space = spaces.Box(
            np.tile(low, len(self.possible_agents)),
            np.tile(high, len(self.possible_agents)),
            dtype=np.float64,
        )

    def observation_space(self, agent: str) -> spaces.Space[Observation]:
        """The box of the car's position and velocity."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> spaces.Space[Any]:
        """0, 1, 2: thrust left, none, right."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observation], dict[str, dict[str, Any]]]:
        """Put all cars at a start.

        Args:
            seed: restarts the random streams; without it they go on (and begin unpredictably).
            options: ``{"start": {car: (position, velocity)}}`` puts these cars where you say;
                they draw nothing from their stream. Other options are ignored.
        """
        given = _starts(self.hill, (options or {}).get("start", {}), self.possible_agents)
        if seed is not None or not self._streams:
            self._reseed(seed)
        self.agents = list(self.possible_agents)
        self._steps = 0
        together = self.hill.reset(self._streams[""]) if self.same_start else None
        starts = [given.get(car, together) or self.hill.reset(self._streams[car]) for car in self.agents]
        self._fleet.states[:] = starts
        self._fleet.select(range(len(starts)))
        self._update_window()
        observations = {
            car: np.array(self.hill.observe(start)) for car, start in zip(self.agents, starts, strict=True)
        }
        return observations, {car: {} for car in self.agents}

    def step(
        self, actions: Mapping[str, int]
    ) -> tuple[
        dict[str, Observation],
        dict[str, float],
        dict[str, bool],
        dict[str, bool],
        dict[str, dict[str, Any]],
    ]:
        """Drive every live car one step; the cars that end leave ``agents``.

        Args:
            actions: one for each live car.

        Raises:
            TypeError, ValueError: when a live car has no action, or one that is not 0, 1 or 2.
        """
        cars, fleet = self.agents, self._fleet
        chosen, n_actions = fleet.actions, self.hill.n_actions
        for place, car in enumerate(cars):
            action: Any = actions.get(car)
            plain = type(action) in _PLAIN and 0 <= action < n_actions
            chosen[place] = action if plain else _action(actions, car, n_actions)
        there = fleet.step()
        self._steps += 1
        observations = dict(zip(cars, fleet.observations.copy()))  # a row each
        rewards = dict(zip(cars, fleet.rewards.tolist()))
        infos: dict[str, dict[str, Any]] = {car: {} for car in cars}
        late = self._steps >= self.max_steps
        if there or late:
            terminations = dict(zip(cars, fleet.terminated.tolist()))
            truncations = {car: late and not terminations[car] for car in cars}
            goes_on = ~fleet.terminated & (not late)
            self.agents = list(compress(cars, goes_on))
            fleet.select(fleet.driving[goes_on])
        else:
            terminations, truncations = dict.fromkeys(cars, False), dict.fromkeys(cars, False)
        self._update_window()
        return observations, rewards, terminations, truncations, infos

    def state(self) -> Observation:
        """Position and velocity of each of ``possible_agents`` in turn; shape (2 * cars,).

        Those of a car that has ended are its last ones.

        Raises:
            ValueError: before the first reset.
        """
        if not self._streams:
            raise InvalidValueError("state is there after the first reset, not before")
        return self._fleet.states.ravel().copy()

    def _rendered_state(self) -> tuple[dict[str, State], int]:
        """The cars that there are after a reset, the ended ones included."""
        states = [(position, velocity) for position, velocity in self._fleet.states.tolist()]
        return dict(zip(self.possible_agents, states if self._streams else [])), self._steps

    def _reseed(self, seed: int | None) -> None:
        master = np.random.SeedSequence(None if seed is None else integer("seed", seed, 0))
        self._streams = {car: stream(master, "start", car) for car in ["", *self.possible_agents]}
        self.np_random = stream(master, "wrapper")  # SuperSuit's frame skipping draws from it


def _names(cars: int | Iterable[str]) -> list[str]:
    if isinstance(cars, str):
        raise InvalidTypeError(f"cars must be a number or a list of names, got {cars!r}")
    if not isinstance(cars, Iterable):
        return [f"car_{number}" for number in range(integer("cars", cars, 1))]
    names = list(cars)
    if not names or not all(isinstance(name, str) and name for name in names):
        raise InvalidValueError(f"cars must be one or more names that are not empty, got {names!r}")
    if len(set(names)) < len(names):
        raise InvalidValueError(f"cars must have names that differ, got {names!r}")
    return names


def _starts(hill: Hill, starts: Any, cars: list[str]) -> dict[str, State]:
    if not isinstance(starts, Mapping) or not starts.keys() <= set(cars):
        raise InvalidValueError(f"start must give cars of {cars}, got {starts!r}")
    return {car: checked_state(hill, state, f" of {car}") for car, state in starts.items()}


def _action(actions: Mapping[str, int], car: str, n_actions: int) -> int:
    if car not in actions:
        raise InvalidValueError(f"actions must have one for each live car, got none for {car!r}")
    action = integer(f"action of {car!r}", actions[car], 0)
    if action >= n_actions:
        raise InvalidValueError(f"action of {car!r} must be less than {n_actions}, got {action}")
    return action
