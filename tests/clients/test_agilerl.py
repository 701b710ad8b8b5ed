# /// script
# dependencies = ["agilerl>=2.58", "peft>=0.21"]
#
# [tool.clients]
# name = "AgileRL"
# package = "agilerl"
# cheap = false
# ///
"""AgileRL drives the cars: its vector of PettingZoo environments in processes, IPPO for several cars, also
when they end at different times, and DQN for the single car, in its vector and in ours.
"""

import subprocess
import sys
from contextlib import closing
from typing import Any

import gymnasium
import numpy as np
import pytest
import torch  # type: ignore[import-not-found, unused-ignore]  # its own environment
from agilerl.algorithms import DQN, IPPO  # type: ignore[import-not-found, unused-ignore]  # its own environment
from agilerl.components import ReplayBuffer  # type: ignore[import-not-found, unused-ignore]  # its own environment
from agilerl.training.train_multi_agent_on_policy import (  # type: ignore[import-not-found, unused-ignore]  # its own environment
    train_multi_agent_on_policy,
)
from agilerl.training.train_off_policy import train_off_policy  # type: ignore[import-not-found, unused-ignore]  # its own environment
from agilerl.utils.utils import make_multi_agent_vect_envs, make_vect_envs  # type: ignore[import-not-found, unused-ignore]  # its own environment
from agilerl.vector import PzDummyVecEnv  # type: ignore[import-not-found, unused-ignore]  # its own environment
from agilerl.wrappers.agent import AsyncAgentsWrapper  # type: ignore[import-not-found, unused-ignore]  # its own environment
from apart import Apart
from countdown import Countdown

from envs import mountain_car_v0
from envs.parked import Parked


class Recorded(IPPO):  # type: ignore[misc, unused-ignore]  # the base is untyped
    """Keeps what it learns from: states, actions, log probabilities, rewards, ends, ..."""

    def learn(self, experiences: Any) -> Any:
        self.learned = [dict(field) for field in experiences]
        return super().learn(experiences)


torch.set_num_threads(1)


def apart(**arguments: Any) -> Any:
    return Apart(mountain_car_v0.parallel_env(**arguments))


def parked(**arguments: Any) -> Any:
    return Parked(apart(**arguments))


def learner(env: Any, kind: Any = IPPO, steps: int = 32) -> Any:
    """IPPO for the agents of a vector; those of a name but for the number share a network."""
    return kind(
        observation_spaces=[env.single_observation_space(agent) for agent in env.agents],
        action_spaces=[env.single_action_space(agent) for agent in env.agents],
        agent_ids=list(env.agents),
        learn_step=steps,
        batch_size=16,
    )


def train(env: Any, agent: Any) -> float:
    """The return of an evaluation after two updates."""
    _, fitness = train_multi_agent_on_policy(
        env, "cars", "IPPO", [agent], max_steps=64, evo_steps=64, verbose=False
    )
    return float(fitness[0])


def weights(network: Any) -> list[Any]:
    return [one.detach().clone().tolist() for one in network.parameters()]


def test_copies_drive_as_without_agilerl_each_with_its_own_seed() -> None:
    """``make_multi_agent_vect_envs``: same bits as without AgileRL, a seed for each copy"""
    with closing(make_multi_agent_vect_envs(mountain_car_v0.parallel_env, 2, max_steps=5)) as env:
        ours = [mountain_car_v0.parallel_env(max_steps=5) for _ in range(2)]
        seen, _ = env.reset(seed=3)
        expected = [one.reset(seed=3 + number)[0] for number, one in enumerate(ours)]
        for step in range(5):
            for car in ("car_0", "car_1"):
                assert seen[car].tolist() == [one[car].tolist() for one in expected]
            seen, *_, truncated, _ = env.step({"car_0": np.array([2, 0]), "car_1": np.array([1, 2])})
            expected = [one.step({"car_0": a, "car_1": b})[0] for one, a, b in zip(ours, (2, 0), (1, 2))]
            assert all(truncated[car].tolist() == [step == 4] * 2 for car in truncated)
        assert seen["car_0"].tolist() == [one.reset()[0]["car_0"].tolist() for one in ours]


def test_car_that_has_ended_is_nan() -> None:
    """``make_multi_agent_vect_envs``: NaN for a car that has ended, until all have"""
    with closing(make_multi_agent_vect_envs(apart, 1, max_steps=3)) as env:
        env.reset(seed=3)
        told = [env.step({"car_0": np.array([2]), "car_1": np.array([2])}) for _ in range(4)]
    assert [bool(np.isnan(seen["car_0"]).all()) for seen, *_ in told] == [False, True, False, False]
    assert [rewards["car_0"].tolist() for _, rewards, *_ in told[::3]] == [[-1.0], [-1.0]]
    assert [bool(np.isnan(rewards["car_0"]).all()) for _, rewards, *_ in told] == [False, True, True, False]


def test_cars_train() -> None:
    """IPPO trains one network for cars that end together"""
    with closing(make_multi_agent_vect_envs(mountain_car_v0.parallel_env, 2, max_steps=8)) as env:
        agent = learner(env)
        before = weights(agent.actors["car"])
        assert train(env, agent) == -16
        assert list(agent.actors) == ["car"]
        assert weights(agent.actors["car"]) != before


def test_cars_that_end_apart_train() -> None:
    """IPPO trains on cars that end apart, when those that have ended are kept"""
    with closing(make_multi_agent_vect_envs(parked, 2, max_steps=8)) as env:
        agent = learner(env, Recorded)
        before = weights(agent.actors["car"])
        assert train(env, agent) == -9
        rewards, ended = (np.array([agent.learned[field][car] for car in env.agents]) for field in (3, 4))
    assert np.isfinite(rewards).all()
    assert (rewards[0] == ended[0] - 1).all()
    assert np.isfinite(weights(agent.actors["car"])[0]).all()
    assert weights(agent.actors["car"]) != before


@pytest.mark.theirs(
    "IPPO of AgileRL 2.58 samples from NaN, which its vector gives for an agent that has ended, and its "
    "AsyncAgentsWrapper mixes up lengths; keep agents that have ended, with envs.parked.Parked"
)
@pytest.mark.parametrize(
    ("wrap", "error"), [(lambda agent: agent, "nan"), (AsyncAgentsWrapper, "size")], ids=["IPPO", "wrapped"]
)
def test_ippo_stops_when_agents_end_apart(wrap: Any, error: str) -> None:
    """IPPO on agents that end apart, without and with ``AsyncAgentsWrapper``"""
    with closing(make_multi_agent_vect_envs(Countdown, 1)) as env, pytest.raises(RuntimeError, match=error):
        train(env, wrap(learner(env)))


@pytest.mark.theirs(
    "train_multi_agent_on_policy of AgileRL 2.58 forgets the ends at which all agents end together, so "
    "values leak from one episode into the one before; call learn from a loop of your own"
)
def test_ippo_is_not_told_where_episodes_end() -> None:
    """``train_multi_agent_on_policy``: the ends of episodes that IPPO learns from"""
    env = PzDummyVecEnv(Countdown(together=True))
    agent = learner(env, Recorded, steps=8)
    train(env, agent)
    assert not np.any(list(agent.learned[4].values()))


@pytest.mark.parametrize("ours", [False, True], ids=["make_vect_envs", "make_vec"])
def test_single_car_trains(ours: bool) -> None:
    """DQN trains on the single car: in ``make_vect_envs`` and in Gymnasium's ``make_vec``"""
    name = "envs:arena/MountainCar-v0"
    with closing(gymnasium.make_vec(name, 2) if ours else make_vect_envs(name, 2)) as env:
        agent = DQN(env.single_observation_space, env.single_action_space, batch_size=32, learn_step=4)
        before = weights(agent.actor)
        memory = ReplayBuffer(max_size=1000)
        _, fitness = train_off_policy(
            env, "car", "DQN", [agent], memory, max_steps=400, evo_steps=400, learning_delay=50, verbose=False
        )
    assert (len(memory), float(np.ravel(fitness)[0])) == (400, -200)
    assert weights(agent.actor) != before


@pytest.mark.theirs("AgileRL 2.58 cannot be imported without its optional peft; install that, too")
def test_import_needs_peft() -> None:
    """``import agilerl.algorithms`` with what AgileRL requires"""
    program = "import sys; sys.modules['peft'] = None; import agilerl.algorithms"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert "ModuleNotFoundError: No module named 'peft" in done.stderr
