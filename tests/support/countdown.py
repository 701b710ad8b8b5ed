"""The smallest environment whose agents end at different times: what clients do with it is not our fault."""

from typing import Any

import numpy as np
from gymnasium import spaces
from pettingzoo import ParallelEnv


class Countdown(ParallelEnv[str, Any, int]):  # type: ignore[misc]  # the base is untyped
    """Agent ``a_0`` terminates after one step, ``a_1`` after three; each step costs 1.

    They observe how many steps there were, at most 3, and what the seed has drawn, less than 1.

    Args:
        together: both after three steps.
    """

    metadata = {"name": "countdown", "is_parallelizable": True}  # noqa: RUF012 (declared so by the base)
    possible_agents = ["a_0", "a_1"]  # noqa: RUF012 (likewise)
    render_mode = None

    def __init__(self, together: bool = False) -> None:
        self.left = {"a_0": 3 if together else 1, "a_1": 3}

    def observation_space(self, agent: str) -> Any:
        return spaces.Box(np.zeros(2, np.float32), np.array([3, 1], np.float32))

    def action_space(self, agent: str) -> Any:
        return spaces.Discrete(2)

    def reset(self, seed: int | None = None, options: Any = None) -> Any:
        self.agents, self.steps = list(self.possible_agents), 0
        self.draw = np.random.default_rng(seed).random()
        return self.seen(), self.told({})

    def step(self, actions: Any) -> Any:
        self.steps += 1
        ended = {agent: self.steps == self.left[agent] for agent in self.agents}
        answers = self.seen(), self.told(-1.0), ended, self.told(False), self.told({})
        self.agents = [agent for agent in self.agents if not ended[agent]]
        return answers

    def seen(self) -> dict[str, Any]:
        return {agent: np.array([self.steps, self.draw], np.float32) for agent in self.agents}

    def told(self, what: Any) -> dict[str, Any]:
        return dict.fromkeys(self.agents, what)
