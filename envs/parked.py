"""Cars that have ended stay, for clients that want the same agents in every step."""

from typing import Any

from pettingzoo import ParallelEnv
from pettingzoo.utils import BaseParallelWrapper

from envs.foundation.checks import choice

__all__ = ["Parked"]

FLAGS = ("kept", "together")


class Parked(BaseParallelWrapper):  # type: ignore[misc]  # the base is untyped
    """A car that has ended stays where it is, for no reward, until all have ended.

    It goes on observing what it saw last, and its actions are ignored. ``agents`` are all of them until
    the episode is over.

    Args:
        env: a parallel environment.
        flags: when an end is told. ``"kept"``: in the step in which the car ends, and in all that follow;
            what a client learns from these is that nothing more is to be got there. ``"together"``: not
            before all have ended, and then all are truncated if any was, else terminated; for clients
            that take the first end for the end of the episode.

    Raises:
        ValueError: when ``flags`` is none of these.
    """

    def __init__(self, env: ParallelEnv[str, Any, Any], flags: str = "kept") -> None:
        super().__init__(env)
        self.flags = choice("flags", flags, FLAGS)
        self.agents: list[str] = []

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
        """As of the environment."""
        observations, infos = self.env.reset(seed=seed, options=options)
        self.agents = list(observations)
        self._seen = {car: observation.copy() for car, observation in observations.items()}
        self._terminated = dict.fromkeys(self.agents, False)
        self._truncated = dict.fromkeys(self.agents, False)
        return observations, infos

    def step(self, actions: dict[str, Any]) -> tuple[dict[str, Any], ...]:
        """Step those that go on; answers for all."""
        shown = list(self.agents)
        driving = {car: actions[car] for car in self.env.agents if car in actions}  # it tells who is missing
        observations, rewards, terminated, truncated, infos = self.env.step(driving)
        self._seen |= observations
        self._terminated |= terminated
        self._truncated |= truncated
        over = not self.env.agents
        if over:
            self.agents = []
        flags = self._terminated, self._truncated
        if self.flags == "together":
            late = any(self._truncated.values())
            flags = dict.fromkeys(shown, over and not late), dict.fromkeys(shown, over and late)
        return (
            {car: self._seen[car].copy() for car in shown},
            {car: rewards.get(car, 0.0) for car in shown},
            *({car: flag[car] for car in shown} for flag in flags),
            {car: infos.get(car, {}) for car in shown},
        )
