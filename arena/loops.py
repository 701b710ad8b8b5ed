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
        episodes: number N_E of episodes.
        max_steps: limit N_LE of an episode.
        starts: the stream that starts come from.
        rng: the stream of the agent's choices.
        lengths: filled with the steps of each episode, shape (episodes,).
    """
    for episode in range(episodes):
        progress = episode / episodes
        state = hill.reset(starts)
        observation = hill.observe(state)
        listener.begin_episode()
        action = agent.act(observation, progress, rng)
        steps = 0
        terminated = False
        while steps < max_steps and not terminated:
            state, reward, terminated = hill.step(state, action)
            next_observation = hill.observe(state)
            next_action = agent.act(next_observation, progress, rng)
            agent.learn(observation, action, reward, next_observation, next_action, terminated)
            observation = next_observation
            action = next_action
            steps += 1
        lengths[episode] = steps


def evaluate(
    hill: Any,
    agent: Any,
    starts: NDArray[np.float64],
    max_steps: int,
    lengths: Lengths,
    reached: NDArray[np.bool_],
) -> None:
    """Drive greedily from each start (paper, section 4.3).

    Args:
        hill: the model of the car.
        agent: what drives; it does not learn.
        starts: positions and velocities, shape (episodes, 2).
        max_steps: limit N_TS of an episode.
        lengths: filled with the steps of each episode, shape (episodes,).
        reached: filled with whether the goal was reached, shape (episodes,).
    """
    for episode in range(starts.shape[0]):
        state = (starts[episode, 0], starts[episode, 1])
        steps = 0
        terminated = False
        while steps < max_steps and not terminated:
            action = agent.greedy(hill.observe(state))
            state, _, terminated = hill.step(state, action)
            steps += 1
        lengths[episode] = steps
        reached[episode] = terminated
