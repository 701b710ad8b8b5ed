"""The PettingZoo driver: many cars in one parallel environment, agents called as plain Python.

It runs any agent. To the bit the results of the compiled driver.
"""

import time
import traceback
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from arena.execution.checkpoint import checkpoint_of
from arena.execution.loops import episode_hook, learner_and_actor
from arena.tournament.conditions import Conditions, Run
from arena.tournament.outcome import Outcome
from envs.foundation.checks import integer
from envs.foundation.errors import InvalidValueError

NAME = "pettingzoo"
_NO_THRUST = 1


def drive(conditions: Conditions, runs: Iterable[Run]) -> list[Outcome]:
    """Train and evaluate the cars of ``runs``, all at the same time.

    A car whose agent raises is parked, and is told as failed; the others drive on.
    """
    began = time.perf_counter()
    cars = {run.identity: _Car(conditions, run) for run in runs}
    together: dict[int, dict[str, _Car]] = {}
    for name, car in cars.items():
        together.setdefault(car.done, {})[name] = car
    for group in together.values():  # of cars that are at the same episode
        _train(conditions, group)
    _evaluate(conditions, cars)
    seconds = (time.perf_counter() - began) / len(cars)
    return [car.outcome(seconds) for car in cars.values()]


class _Car:
    """One car: its agent, its next action, and what it has driven."""

    def __init__(self, conditions: Conditions, run: Run) -> None:
        self.run = run
        self.error = ""
        self.action = _NO_THRUST
        self.n_actions = conditions.hill.n_actions
        self.rng = run.stream(conditions.seed, "act")
        self.start_states = conditions.start_states(run.replicate)
        self.lengths = np.zeros(conditions.training.episodes, np.int64)
        self.test_lengths = np.zeros(conditions.evaluation.episodes, np.int64)
        self.test_reached = np.zeros(conditions.evaluation.episodes, np.bool_)
        self.done = 0
        self.attempt(self.equip, conditions)

    def equip(self, conditions: Conditions) -> None:
        self.agent = self.run.entrant.create(conditions.hill, self.run.stream(conditions.seed, "create"))
        self.hook = episode_hook(self.agent)
        self.learn_and_act = learner_and_actor(self.agent, self._act)
        self.start_rng = self.run.stream(conditions.seed, "start")
        self.checkpoint = checkpoint_of(
            conditions, self.run, self.agent, self.start_rng, self.rng, self.lengths
        )
        self.done = self.checkpoint.restore()

    def attempt(self, call: Callable[..., None], *arguments: Any) -> None:
        """Do what may fail with the agent, if nothing has failed before."""
        if not self.error:
            try:
                call(*arguments)
            except KeyboardInterrupt:
                raise
            except BaseException:  # sys.exit, too
                self.error = traceback.format_exc()
                self.action = _NO_THRUST

    def save(self, episode: int) -> None:
        self.checkpoint.save(episode)

    def begin_episode(self, observation: Any, progress: float) -> None:
        self.hook.begin_episode()
        self.observation = observation
        self.progress = progress
        self.action = self._act(observation)

    def learn(self, episode: int, reward: float, observation: Any, terminated: bool, over: bool) -> None:
        transition = self.observation, self.action, reward, observation
        self.action = self.learn_and_act(transition, terminated, over)
        self.observation = observation
        self.lengths[episode] += 1

    def choose(self, observation: Any) -> None:
        self.action = self._checked(self.agent.greedy(observation))

    def outcome(self, seconds: float) -> Outcome:
        self.attempt(self.finish, seconds)
        return Outcome.failure(self.run, NAME, self.error, seconds) if self.error else self.finished

    def finish(self, seconds: float) -> None:
        lengths = (self.lengths, self.test_lengths, self.test_reached)
        self.finished = Outcome.finished(self.run, NAME, self.agent, *lengths, seconds)

    def _act(self, observation: Any) -> int:
        return self._checked(self.agent.act(observation, self.progress, self.rng))

    def _checked(self, action: Any) -> int:
        number = integer("action", action, 0)
        if number >= self.n_actions:
            raise InvalidValueError(f"action must be less than {self.n_actions}, got {number}")
        return number


def _train(conditions: Conditions, cars: Mapping[str, _Car]) -> None:
    from envs import mountain_car_v0

    training = conditions.training
    env = mountain_car_v0.parallel_env(list(cars), conditions.hill, training.max_steps)
    saved = time.monotonic()
    for episode in range(next(iter(cars.values())).done, training.episodes):
        if time.monotonic() - saved >= conditions.checkpoint_seconds:
            saved = time.monotonic()
            for car in cars.values():
                car.attempt(car.save, episode)
        start = {name: conditions.hill.reset(car.start_rng) for name, car in cars.items() if not car.error}
        observations, _ = env.reset(options={"start": start})
        for name, car in cars.items():
            car.attempt(car.begin_episode, observations[name], episode / training.episodes)
        while _driving(env.agents, cars):
            live = env.agents
            observations, rewards, terminated, truncated, _ = env.step({n: cars[n].action for n in live})
            for name in live:
                car, over = cars[name], terminated[name] or truncated[name]
                car.attempt(car.learn, episode, rewards[name], observations[name], terminated[name], over)


def _evaluate(conditions: Conditions, cars: Mapping[str, _Car]) -> None:
    from envs import mountain_car_v0

    evaluation = conditions.evaluation
    env = mountain_car_v0.parallel_env(list(cars), conditions.hill, evaluation.max_steps)
    for episode in range(evaluation.episodes):
        start = {name: tuple(car.start_states[episode]) for name, car in cars.items()}
        observations, _ = env.reset(options={"start": start})
        while _driving(env.agents, cars):
            live = env.agents
            for name in live:
                cars[name].attempt(cars[name].choose, observations[name])
            observations, _, terminated, _, _ = env.step({name: cars[name].action for name in live})
            for name in live:
                cars[name].test_lengths[episode] += 1
                cars[name].test_reached[episode] = terminated[name]


def _driving(live: Iterable[str], cars: Mapping[str, _Car]) -> bool:
    """Whether a car is on its way whose agent has not failed."""
    return any(not cars[name].error for name in live)
