"""Linear agents on a line of four cells, random walks, and the book's boxes with long vectors."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

Floats = NDArray[np.float64]


Step = tuple[Any, int, float, Any, int, bool]  # the arguments of ``learn``


class Line(NamedTuple):
    """A task with one dimension; with four bins the cells are 0, 1, 2, 3."""

    low: tuple[float, ...] = (0.0,)
    high: tuple[float, ...] = (4.0,)
    n_actions: int = 3


class Square(NamedTuple):
    low: tuple[float, ...] = (0.0, 0.0)
    high: tuple[float, ...] = (4.0, 4.0)
    n_actions: int = 3


def make(cls: type[Any], **parameters: Any) -> Any:
    """An agent on the line's four cells with step size 1/2 and discount 1/2 unless told."""
    return cls.create(Line(), **{"bins": 4, "step_size": 0.5, "discount": 0.5, **parameters})


def step(cell: int, action: int, reward: float, next_cell: int, next_action: int, end: bool = False) -> Step:
    return (cell + 0.5,), action, reward, (next_cell + 0.5,), next_action, end


def weights(entries: dict[tuple[int, int], float], shape: tuple[int, int] = (4, 3)) -> list[list[float]]:
    table = np.zeros(shape)
    for key, value in entries.items():
        table[key] = value
    return table.tolist()


def walks(seed: int, dimensions: int, episodes: int = 12) -> Iterator[list[Step]]:
    """Episodes of random steps between 0 and 4, three of four to a goal, the others to a time limit."""
    rng = np.random.default_rng(seed)
    for _ in range(episodes):
        at, action = rng.uniform(0, 4, dimensions), int(rng.integers(3))
        goes_on, walk = True, []
        while goes_on:
            goes_on, to = rng.random() < 0.95, np.clip(at + rng.normal(0, 0.7, dimensions), 0, 4)
            next_action = int(rng.integers(3))
            end = not goes_on and rng.random() < 0.75
            walk.append((tuple(at), action, float(rng.normal()), tuple(to), next_action, end))
            at, action = to, next_action
        yield walk


def learned(agent: Any, seed: int) -> Floats:
    for walk in walks(seed, len(agent.features.low)):
        agent.begin_episode()
        for one in walk:
            agent.learn(*one)
    agent.begin_episode()
    return agent.weights.copy()  # type: ignore[no-any-return]


def vector(agent: Any, observation: Any, action: int) -> Floats:
    """The features of an action: as many as there are weights, 1 where active."""
    x, active = np.zeros_like(agent.weights), np.zeros(agent.features.active, np.int64)
    agent.features.fill(observation, active)
    x[active, action] = 1.0
    return np.ravel(x)


def book_n_step(agent: Any, seed: int, n: int) -> Floats:
    """Box of 10.2; a walk that meets a time limit is learned to its end as if its last value were known."""
    w, gamma = np.zeros(agent.weights.size), agent.discount
    for walk in walks(seed, len(agent.features.low)):
        x = [vector(agent, *one[:2]) for one in walk] + [vector(agent, *walk[-1][3:5])]
        rewards, end = [one[2] for one in walk], walk[-1][5]
        for t in range(len(walk)):
            last = min(t + n, len(walk))
            target = sum(gamma ** (i - t) * rewards[i] for i in range(t, last))
            if not (end and last == len(walk)):
                target += gamma ** (last - t) * (w @ x[last])
            w += agent.step_size * (target - w @ x[t]) * x[t]
    return w.reshape(agent.weights.shape)


def book_traces(agent: Any, seed: int, traces: str, decay: float, *, watkins: bool = False) -> Floats:
    """Boxes of 12.7 (of the first edition's 7.6 for Watkins)."""
    w, gamma, alpha = np.zeros(agent.weights.size), agent.discount, agent.step_size
    for walk in walks(seed, len(agent.features.low)):
        z, old = np.zeros_like(w), 0.0
        for observation, action, reward, next_observation, next_action, end in walk:
            x = vector(agent, observation, action)
            q = [float(w @ vector(agent, next_observation, a)) for a in range(3)]
            following = 0.0 if end else max(q) if watkins else q[next_action]
            delta = reward + gamma * following - w @ x
            if traces == "dutch":
                z = gamma * decay * z + (1 - alpha * gamma * decay * (z @ x)) * x
                value = w @ x
                w += alpha * (delta + value - old) * z - alpha * (value - old) * x
                old = following
                continue
            if traces == "clearing":
                z[np.sum([vector(agent, observation, a) for a in range(3)], axis=0) > 0] = 0.0
            z = z + x if traces == "accumulating" else np.where(x > 0, 1.0, z)
            w += alpha * delta * z
            z = z * (gamma * decay if not watkins or q[next_action] == max(q) else 0.0)
    return w.reshape(agent.weights.shape)


TASKS: list[tuple[Any, dict[str, Any]]] = [
    (Line(), {"tilings": 3, "tiles": 4}),
    (Line(), {"bins": 5}),
    (Square(), {"tilings": 4, "tiles": (2, 3)}),
]


on_tasks = pytest.mark.parametrize(("task", "parameters"), TASKS, ids=["line", "grid", "square"])


rates: dict[str, Any] = {"discount": 0.9, "step_size": 0.3}
