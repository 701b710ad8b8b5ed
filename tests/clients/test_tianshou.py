# /// script
# dependencies = ["tianshou>=2.0"]
#
# [tool.clients]
# name = "Tianshou"
# package = "tianshou"
# cheap = false
# ///
"""Tianshou drives the cars: its wrapper for PettingZoo's AEC environments with an algorithm for each car,
also when they end at different times, and DQN for the single car in its vectors of environments.
"""

from contextlib import closing
from typing import Any

import gymnasium
import numpy as np
import pytest
import torch  # type: ignore[import-not-found, unused-ignore]  # its own environment
from apart import Apart
from countdown import Countdown
from pettingzoo.utils import parallel_to_aec
from tianshou.algorithm import DQN  # type: ignore[import-not-found, unused-ignore]  # its own environment
from tianshou.algorithm.modelfree.dqn import DiscreteQLearningPolicy  # type: ignore[import-not-found, unused-ignore]  # its own environment
from tianshou.algorithm.multiagent.marl import MultiAgentOffPolicyAlgorithm  # type: ignore[import-not-found, unused-ignore]  # its own environment
from tianshou.algorithm.optim import AdamOptimizerFactory  # type: ignore[import-not-found, unused-ignore]  # its own environment
from tianshou.data import Collector, VectorReplayBuffer  # type: ignore[import-not-found, unused-ignore]  # its own environment
from tianshou.env import DummyVectorEnv, PettingZooEnv, SubprocVectorEnv  # type: ignore[import-not-found, unused-ignore]  # its own environment
from tianshou.trainer import OffPolicyTrainerParams  # type: ignore[import-not-found, unused-ignore]  # its own environment
from tianshou.utils.net.common import Net  # type: ignore[import-not-found, unused-ignore]  # its own environment

from envs import mountain_car_v0
from envs.parked import Parked

torch.set_num_threads(1)


def dqn(env: Any, **settings: Any) -> Any:
    net = Net(state_shape=env.observation_space.shape, action_shape=env.action_space.n, hidden_sizes=[16])
    policy = DiscreteQLearningPolicy(model=net, action_space=env.action_space, eps_training=0.5)
    return DQN(policy=policy, optim=AdamOptimizerFactory(lr=1e-3), **settings)


def each(env: Any, steps: int) -> Any:
    """A DQN for each agent; a reward comes after as many turns as there are agents."""
    return MultiAgentOffPolicyAlgorithm(
        algorithms=[dqn(env, n_step_return_horizon=steps) for _ in env.agents], env=env
    )


def train(algorithm: Any, collector: Any) -> None:
    algorithm.run_training(
        OffPolicyTrainerParams(
            training_collector=collector,
            max_epochs=1,
            epoch_num_steps=400,
            collection_step_num_env_steps=100,
            update_step_num_gradient_steps_per_sample=0.1,
            batch_size=32,
            test_step_num_episodes=0,
            test_in_training=False,
            show_progress=False,
            verbose=False,
        )
    )


def weights(algorithm: Any) -> list[Any]:
    return [one.detach().clone().tolist() for one in algorithm.parameters()]


def targets(algorithm: Any, buffer: Any) -> dict[str, Any]:
    """What each agent's network is to say of its transitions, when all say 0 so far."""
    for one in algorithm.parameters():
        one.data.zero_()
    batch, indices = buffer.sample(0)
    made = algorithm._preprocess_batch(batch, buffer, indices)
    return {agent: made[agent].returns.flatten().tolist() for agent in made.get_keys()}


def test_cars_drive_as_without_tianshou() -> None:
    """``PettingZooEnv``: same bits as without Tianshou, turn by turn"""
    env, ours = PettingZooEnv(mountain_car_v0.env(max_steps=5)), mountain_car_v0.parallel_env(max_steps=5)
    told, _ = env.reset(seed=3)
    seen, _ = ours.reset(seed=3)
    for step in range(5):
        for car in ("car_0", "car_1"):
            assert (told["agent_id"], told["obs"].tolist(), told["mask"]) == (
                car,
                seen[car].tolist(),
                [True] * 3,
            )
            told, rewards, terminated, truncated, _ = env.step(2)
        seen, *_ = ours.step({"car_0": 2, "car_1": 2})
        assert (list(rewards), terminated, truncated) == ([-1.0, -1.0], False, step == 4)


def test_cars_train() -> None:
    """``MultiAgentOffPolicyAlgorithm``: DQN for each car, ``n_step_return_horizon`` = cars"""
    envs = DummyVectorEnv([lambda: PettingZooEnv(mountain_car_v0.env(max_steps=20))] * 2)
    algorithm, buffer = each(PettingZooEnv(mountain_car_v0.env()), steps=2), VectorReplayBuffer(1000, 2)
    collector = Collector(algorithm, envs, buffer, exploration_noise=True)
    collector.reset()
    assert collector.collect(n_episode=4).returns.tolist() == [[-20, -20]] * 4
    before = weights(algorithm)
    train(algorithm, collector)
    after = weights(algorithm)
    assert all(one != other for one, other in zip(before, after))
    told = targets(algorithm, buffer)
    assert np.allclose(told["car_0"], -0.99)
    assert np.allclose(told["car_1"], -1.0)


def test_cars_that_end_apart_drive_to_their_ends() -> None:
    """A collector of cars that end apart, when those that have ended are kept"""

    def make() -> Any:
        return PettingZooEnv(
            parallel_to_aec(Parked(Apart(mountain_car_v0.parallel_env(max_steps=20)), "together"))
        )

    algorithm, buffer = each(make(), steps=2), VectorReplayBuffer(1000, 2)
    collector = Collector(algorithm, DummyVectorEnv([make] * 2), buffer, exploration_noise=True)
    collector.reset()
    told = collector.collect(n_episode=4)
    assert (told.returns.tolist(), told.lens.tolist()) == ([[-1, -20]] * 4, [40] * 4)
    assert not buffer.terminated.any()


@pytest.mark.parametrize("vector", [DummyVectorEnv, SubprocVectorEnv])
def test_single_car_trains(vector: Any) -> None:
    """DQN trains on the single car: in ``DummyVectorEnv`` and in ``SubprocVectorEnv``"""
    name = "envs:arena/MountainCar-v0"
    with closing(vector([lambda: gymnasium.make(name)] * 2)) as envs:
        algorithm, buffer = dqn(gymnasium.make(name)), VectorReplayBuffer(1000, 2)
        collector = Collector(algorithm, envs, buffer, exploration_noise=True)
        before = weights(algorithm)
        train(algorithm, collector)
        assert all(one != other for one, other in zip(before, weights(algorithm)))
        assert (len(buffer), buffer.rew.sum(), buffer.truncated.sum()) == (400, -400, 2)
        starts = [envs.reset()[0][:, 0].tolist() for _ in range(2)]
    assert len({*starts[0], *starts[1]}) == 4


@pytest.mark.theirs(
    "Tianshou 2.0 takes the end of the first agent for the end of the episode: the others' are cut short, "
    "and marked as terminated if it was; keep agents that have ended, with envs.parked.Parked"
)
def test_episode_ends_with_the_first_agent() -> None:
    """``PettingZooEnv`` of agents that end apart"""
    env = PettingZooEnv(parallel_to_aec(Countdown()))
    collector = Collector(each(env, steps=2), DummyVectorEnv([lambda: env]), exploration_noise=True)
    collector.reset()
    assert collector.collect(n_episode=2).returns.tolist() == [[-1, -1], [-1, -1]]


@pytest.mark.theirs(
    "Tianshou 2.0 stores the reward of all agents with the turn of the last one, so the others learn "
    "from 0; give n_step_return_horizon the number of agents, which no on-policy algorithm has"
)
def test_rewards_go_to_the_last_agent() -> None:
    """``MultiAgentOffPolicyAlgorithm`` of agents that act at the same time: rewards"""
    env, buffer = PettingZooEnv(parallel_to_aec(Countdown(together=True))), VectorReplayBuffer(100, 1)
    collector = Collector(each(env, steps=1), DummyVectorEnv([lambda: env]), buffer, exploration_noise=True)
    collector.reset()
    collector.collect(n_episode=2)
    assert targets(each(env, steps=1), buffer) == {"a_0": [0.0] * 6, "a_1": [-1.0] * 6}


@pytest.mark.theirs(
    "Tianshou 2.0 gives all environments of a vector the same seed in reset(seed=...), and so the same "
    "episodes; seed(...) gives each its own"
)
def test_reset_gives_all_the_same_seed() -> None:
    """``reset(seed=...)`` of a vector of environments"""
    envs = DummyVectorEnv([lambda: gymnasium.make("CartPole-v1")] * 2)
    one, other = envs.reset(seed=7)[0].tolist()
    assert one == other
    envs.seed(7)
    one, other = envs.reset()[0].tolist()
    assert one != other
