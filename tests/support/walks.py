"""Random steps for agents to learn from, and agents of two cells whose updates can be computed by hand."""

from typing import Any, NamedTuple

import numpy as np

from agents import HarmonicRate
from agents.contract import learns_with_next_action

A, B = (0.5,), (1.5,)  # observations in cells 0 and 1
Step = tuple[Any, int, float, Any, int, bool]  # what ``teach`` takes


class Line(NamedTuple):
    """A task with one dimension and two cells."""

    low: tuple[float, ...] = (0.0,)
    high: tuple[float, ...] = (2.0,)
    n_actions: int = 3


class Square(NamedTuple):
    """A task with two dimensions."""

    low: tuple[float, ...] = (0.0, 0.0)
    high: tuple[float, ...] = (1.0, 1.0)
    n_actions: int = 3


def make(cls: type[Any], **parameters: Any) -> Any:
    """An agent that values the actions 1, 5, 3 in B; with step size 1/4 and discount 1/2 unless told."""
    given = {"bins": 2, "discount": 0.5, "step_size": HarmonicRate(1, 4, 0), **parameters}
    agent = cls.create(Line(), **{name: value for name, value in given.items() if value is not None})
    agent.values[1] = [1.0, 5.0, 3.0]
    return agent


def table(*changed: float) -> list[list[float]]:
    """The values in A and B, where only those of A have changed."""
    return [list(changed), [1.0, 5.0, 3.0]]


def episodes(seed: int, count: int = 8, limit: int = 40) -> list[list[Step]]:
    """Episodes on the square; about half reach the goal, the others a time limit."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(count):
        steps: list[Step] = []
        here, action = rng.random(2), int(rng.integers(3))
        length, reaches = int(rng.integers(1, limit)), bool(rng.integers(2))
        for number in range(length):
            there, next_action = rng.random(2), int(rng.integers(3))
            end = reaches and number == length - 1
            steps.append((tuple(here), action, float(rng.normal()), tuple(there), next_action, end))
            here, action = there, next_action
        found.append(steps)
    return found


def teach(agent: Any, *step: Any) -> None:
    """Let it learn from a step; an agent that does not ask for the next action is not told it."""
    *transition, next_action, terminated = step
    agent.learn(*transition, *([next_action] if learns_with_next_action(agent) else []), terminated)


def learn_all(agent: Any, walks: list[list[Step]]) -> Any:
    """The agent after it has learned from these episodes, and has heard the next one begin."""
    for walk in walks:
        agent.begin_episode()
        for step in walk:
            teach(agent, *step)
    agent.begin_episode()
    return agent
