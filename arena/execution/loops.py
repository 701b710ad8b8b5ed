"""The two loops of the arena, training and evaluation, of one car.

Plain Python: the compiled driver turns them into machine code together with the hill and the agent.
The PettingZoo driver runs the same steps for many cars at once.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Lengths = NDArray[np.int64]


class Deaf(NamedTuple):
    """Stands in for an agent that does not ask when an episode begins."""

    ears: int = 0

    def begin_episode(self) -> None:
        """Nothing."""


def listener(agent: Any) -> Any:
    """The agent itself if it has the optional method ``begin_episode``, else one that ignores it."""
    return agent if hasattr(agent, "begin_episode") else Deaf()


def train(
    hill: Any,
    agent: Any,
    listener: Any,
    n_actions: int,
    first: int,
    last: int,
    episodes: int,
    max_steps: int,
    starts: np.random.Generator,
    rng: np.random.Generator,
    lengths: Lengths,
) -> None:
    """Let ``agent`` learn (paper, section 4.3).

    Args:
        hill: the model of the car.
        agent: what drives and learns; changed in place.
        listener: what hears when an episode begins, see ``listener``.
        n_actions: the actions are 0, 1, ..., n_actions - 1.
        first: the episode to begin with.
        last: the episode to end before.
        episodes: number N_E of all episodes.
        max_steps: limit N_LE of an episode.
        starts: the stream that starts come from.
        rng: the stream of the agent's choices.
        lengths: filled with the steps of each episode, shape (episodes,).

    Raises:
        ValueError: when the agent chooses an action that there is not.
    """
    for episode in range(first, last):
        progress = episode / episodes
        state = hill.reset(starts)
        observation = hill.observe(state)
        listener.begin_episode()
        action = checked(agent.act(observation, progress, rng), n_actions)
        steps = 0
        terminated = False
        while steps < max_steps and not terminated:
            state, reward, terminated = hill.step(state, action)
            next_observation = hill.observe(state)
            next_action = checked(agent.act(next_observation, progress, rng), n_actions)
            agent.learn(observation, action, reward, next_observation, next_action, terminated)
            observation = next_observation
            action = next_action
            steps += 1
        lengths[episode] = steps


def evaluate(
    hill: Any,
    agent: Any,
    n_actions: int,
    starts: NDArray[np.float64],
    max_steps: int,
    lengths: Lengths,
    reached: NDArray[np.bool_],
) -> None:
    """Drive greedily from each start (paper, section 4.3).

    Args:
        hill: the model of the car.
        agent: what drives; it does not learn.
        n_actions: the actions are 0, 1, ..., n_actions - 1.
        starts: positions and velocities, shape (episodes, 2).
        max_steps: limit N_TS of an episode.
        lengths: filled with the steps of each episode, shape (episodes,).
        reached: filled with whether the goal was reached, shape (episodes,).

    Raises:
        ValueError: when the agent chooses an action that there is not.
    """
    for episode in range(starts.shape[0]):
        state = (starts[episode, 0], starts[episode, 1])
        steps = 0
        terminated = False
        while steps < max_steps and not terminated:
            action = checked(agent.greedy(hill.observe(state)), n_actions)
            state, _, terminated = hill.step(state, action)
            steps += 1
        lengths[episode] = steps
        reached[episode] = terminated


def checked(action: int, n_actions: int) -> int:
    """``action`` if there is such a one; else an agent's table would be read beyond its end.

    Raises:
        ValueError: when there is not.
    """
    if action < 0 or action >= n_actions:
        raise ValueError("action must be one of the hill's")
    return action
