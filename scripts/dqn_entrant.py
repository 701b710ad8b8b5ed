"""Deep reinforcement learning beside Q-learning: the DQN of Stable-Baselines3 as an entrant.

    pip install stable-baselines3
    python scripts/dqn_entrant.py --episodes 600 --replicates 2

prints how both drive. The class is an ordinary plugin, interpreted; ``--plugin scripts/dqn_entrant.py``
brings it as ``sb3-dqn`` into any tournament. Only the network, the optimizer and the replay buffer are
theirs, the loop is the arena's.
"""

import argparse
import logging
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Self

import gymnasium
import numpy as np
import torch  # type: ignore[import-not-found, unused-ignore]  # optional
from stable_baselines3 import DQN  # type: ignore[import-not-found, unused-ignore]  # optional
from stable_baselines3.common.logger import Logger  # type: ignore[import-not-found, unused-ignore]  # optional
from stable_baselines3.common.utils import polyak_update  # type: ignore[import-not-found, unused-ignore]  # optional

from agents import QLearning
from agents.parameters import Count, NonNegative, Positive, Probability
from arena import Entrant, Evaluation, Tournament, Training, run


class SB3DQN:
    """Mnih et al. 2015, with the hyperparameters that RL Baselines3 Zoo has for MountainCar-v0.

    Only the observations are scaled, which the Zoo leaves as they are. The weights are attributes, arrays
    that share their memory with the network: so they are kept in the results.
    """

    low: Any
    high: Any
    reach: float
    n_actions: int
    explore_until: float
    epsilon: float
    learning_starts: int
    train_every: int
    target_every: int
    training: dict[str, int]
    steps: int
    chance: tuple[Any, Any]
    model: Any

    @classmethod
    def create(
        cls,
        task: Any,
        *,
        learning_rate: Positive = 4e-3,
        discount: Probability = 0.98,
        width: Count = 256,
        buffer_size: Count = 10_000,
        batch_size: Count = 128,
        learning_starts: Count = 1000,
        train_every: Count = 16,
        gradient_steps: Count = 8,
        target_every: Count = 600,
        explore_until: Probability = 0.2,
        epsilon: Probability = 0.07,
        reach: NonNegative = 1.0,
        rng: np.random.Generator,
    ) -> Self:
        """The agent with a network of random weights.

        Args:
            task: the hill.
            learning_rate: of Adam.
            discount: gamma.
            width: of each of the two hidden layers.
            buffer_size: transitions that are remembered.
            batch_size: transitions of a gradient step.
            learning_starts: steps before the first gradient step.
            train_every: steps between two trainings.
            gradient_steps: of each training.
            target_every: steps until the target network takes over the weights.
            explore_until: share of the training in which the random actions become fewer.
            epsilon: share of random actions from then on.
            reach: observations are scaled to [-reach, reach]; 0 leaves them as they are.
            rng: draws the seed of everything.
        """
        torch.set_num_threads(1)  # a worker has one core
        torch.use_deterministic_algorithms(mode=True)
        made = cls()
        made.low, made.high, made.reach = np.array(task.low), np.array(task.high), reach
        made.n_actions, made.explore_until, made.epsilon = task.n_actions, explore_until, epsilon
        made.learning_starts, made.train_every, made.target_every = learning_starts, train_every, target_every
        made.training = {"gradient_steps": gradient_steps, "batch_size": batch_size}
        made.steps = 0
        seed = int(rng.integers(2**31))
        made.chance = (
            np.random.RandomState(seed).get_state(),
            torch.Generator().manual_seed(seed).get_state(),
        )
        with made.own_chance():
            made.model = DQN(
                "MlpPolicy",
                _Spaces(task, reach),
                learning_rate=learning_rate,
                gamma=discount,
                buffer_size=buffer_size,
                policy_kwargs={"net_arch": [width, width]},
                device="cpu",
            )
        made.model.set_logger(Logger(None, []))
        for name, weights in made.model.q_net.named_parameters():
            setattr(made, name.replace(".", "_"), weights.detach().numpy())
        return made

    @contextmanager
    def own_chance(self) -> Iterator[None]:
        """Stable-Baselines3 draws from the global random numbers: lend it this agent's meanwhile."""
        before = np.random.get_state(), torch.get_rng_state()  # noqa: NPY002
        _set_chance(self.chance)
        try:
            yield
        finally:
            self.chance = np.random.get_state(), torch.get_rng_state()  # noqa: NPY002
            _set_chance(before)

    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> int:
        """Epsilon-greedy; epsilon falls from 1 in a straight line."""
        share = min(progress / self.explore_until, 1.0) if self.explore_until else 1.0
        if rng.random() < 1.0 + share * (self.epsilon - 1.0):
            return int(rng.random() * self.n_actions)
        return self.greedy(observation)

    def learn(
        self,
        observation: Any,
        action: int,
        reward: float,
        next_observation: Any,
        terminated: bool,
    ) -> None:
        """Remember the transition; now and then take gradient steps on some that are remembered."""
        here, there = self.scaled(observation), self.scaled(next_observation)
        ended = np.array([terminated])
        self.model.replay_buffer.add(here, there, np.array([[action]]), np.array([reward]), ended, [{}])
        self.steps += 1
        if self.steps % self.target_every == 0:
            polyak_update(self.model.q_net.parameters(), self.model.q_net_target.parameters(), 1.0)
        if self.steps >= self.learning_starts and self.steps % self.train_every == 0:
            with self.own_chance():
                self.model.train(**self.training)

    def greedy(self, observation: Any) -> int:
        """The action that the network values most."""
        with torch.no_grad():
            return int(self.model.q_net(torch.from_numpy(self.scaled(observation))).argmax())

    def scaled(self, observation: Any) -> np.ndarray[Any, np.dtype[np.float32]]:
        """The observation as the network sees it, a row."""
        if self.reach:
            observation = self.reach * (2.0 * (observation - self.low) / (self.high - self.low) - 1.0)
        return np.asarray(observation, np.float32)[np.newaxis]


class _Spaces(gymnasium.Env[Any, Any]):
    """What Stable-Baselines3 wants to know of an environment; it is never stepped."""

    def __init__(self, task: Any, reach: float) -> None:
        low, high = np.array(task.low, np.float32), np.array(task.high, np.float32)
        if reach:
            low, high = np.full_like(low, -reach), np.full_like(high, reach)
        self.observation_space = gymnasium.spaces.Box(low, high)
        self.action_space = gymnasium.spaces.Discrete(task.n_actions)


def _set_chance(states: tuple[Any, Any]) -> None:
    np.random.set_state(states[0])  # noqa: NPY002
    torch.set_rng_state(states[1])


def main() -> None:
    """Parse, run, print."""
    logging.basicConfig(format="%(message)s")
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--episodes", type=int, default=600, help="of training")
    parser.add_argument("--max-steps", type=int, default=200, help="of an episode of training")
    parser.add_argument("--replicates", type=int, default=2)
    parser.add_argument("--out", help="results file; continued if it is there")
    parser.add_argument("--jobs", type=int, default=-1)
    arguments = parser.parse_args()

    tournament = Tournament(
        (Entrant("sb3-dqn", SB3DQN), Entrant("q-learning", QLearning, bins=(20, 20))),
        training=Training(arguments.episodes, arguments.max_steps),
        evaluation=Evaluation(episodes=100),
        replicates=arguments.replicates,
        name="dqn",
    )
    with run(tournament, out=arguments.out, n_jobs=arguments.jobs) as results:
        frame = results.frame()
        for one in results.runs:
            print(one.get("error", ""), end="")
    scores = ["accuracy", "mean_length", "iterations", "seconds"]
    print(frame[["entrant", "replicate", "driver", *scores]].round(1).to_string(index=False))


if __name__ == "__main__":
    main()
