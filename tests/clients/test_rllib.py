# /// script
# dependencies = ["ray[rllib]>=2.60", "torch>=2.15"]
#
# [tool.clients]
# name = "RLlib"
# package = "ray"
# cheap = false
# ///
"""RLlib drives the cars: its wrappers for PettingZoo's parallel and AEC environments, one policy for all cars
or one for each, cars that end at different times, and the single car by its name in Gymnasium.
"""

from collections.abc import Callable, Iterator
from typing import Any

import gymnasium
import pettingzoo
import pytest
import ray  # type: ignore[import-not-found, unused-ignore]  # its own environment
from apart import Apart
from pettingzoo.utils import parallel_to_aec
from ray.rllib.algorithms.ppo import PPOConfig  # type: ignore[import-not-found, unused-ignore]  # its own environment
from ray.rllib.env.multi_agent_episode import MultiAgentEpisode  # type: ignore[import-not-found, unused-ignore]  # its own environment
from ray.rllib.env.single_agent_env_runner import SingleAgentEnvRunner  # type: ignore[import-not-found, unused-ignore]  # its own environment
from ray.rllib.env.wrappers.pettingzoo_env import (  # type: ignore[import-not-found, unused-ignore]  # its own environment
    ParallelPettingZooEnv,
    PettingZooEnv,
)
from ray.tune.registry import register_env  # type: ignore[import-not-found, unused-ignore]  # its own environment

from envs import mountain_car_v0

SHARED = {"policies": {"driver"}, "policy_mapping_fn": lambda car, *_, **__: "driver"}
EACH = {"policies": {"car_0", "car_1"}, "policy_mapping_fn": lambda car, *_, **__: car}


class Cars(ParallelPettingZooEnv):  # type: ignore[misc, unused-ignore]  # the base is untyped
    """The remedy: ``__all__`` alone says truncated, so RLlib does not take it for terminated."""

    def step(self, action_dict: Any) -> Any:
        observations, rewards, terminated, truncated, infos = super().step(action_dict)
        over = not self.par_env.agents
        late = over and any(truncated.values())
        return observations, rewards, terminated | {"__all__": over and not late}, {"__all__": late}, infos


@pytest.fixture(scope="module", autouse=True)
def local_ray(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    folder = str(tmp_path_factory.mktemp("r"))
    ray.init(num_cpus=1, include_dashboard=False, log_to_driver=False, _temp_dir=folder)
    yield
    ray.shutdown()


@pytest.fixture
def ppo(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., Any]]:
    """Builds PPO in this process."""
    monkeypatch.setattr(
        "ray.tune.trainable.trainable.DEFAULT_STORAGE_PATH", str(tmp_path)
    )  # not ~/ray_results
    made = []

    def build(env: Any, **policies: Any) -> Any:
        if not isinstance(env, str):
            register_env("cars", lambda _: env())
        config = (
            PPOConfig()
            .environment(env if isinstance(env, str) else "cars")
            .env_runners(num_env_runners=0, num_envs_per_env_runner=2)
            .learners(num_learners=0)
            .training(train_batch_size_per_learner=100, minibatch_size=50, num_epochs=1)
            .debugging(seed=5)
        )
        if policies:
            config.multi_agent(**policies)
        made.append(config.build_algo())
        return made[-1]

    yield build
    for algorithm in made:
        algorithm.stop()


def weights(algorithm: Any) -> dict[str, list[Any]]:
    """A copy of the weights of each policy."""
    return {
        policy: [array.tolist() for array in arrays.values()]
        for policy, arrays in algorithm.get_weights().items()
    }


@pytest.mark.parametrize("policies", [SHARED, EACH], ids=["shared", "each"])
def test_parallel_cars_train(ppo: Any, policies: Any) -> None:
    """``ParallelPettingZooEnv``: PPO trains a shared policy, and one for each car"""
    algorithm = ppo(lambda: ParallelPettingZooEnv(mountain_car_v0.parallel_env(max_steps=25)), **policies)
    before = weights(algorithm)
    told = algorithm.train()["env_runners"]
    assert dict(told["agent_episode_returns_mean"]) == {"car_0": -25, "car_1": -25}
    after = weights(algorithm)
    assert set(after) == policies["policies"]
    assert all(after[policy] != before[policy] for policy in after)


def test_aec_cars_train(ppo: Any) -> None:
    """``PettingZooEnv`` (AEC): PPO trains a shared policy"""
    algorithm = ppo(lambda: PettingZooEnv(mountain_car_v0.env(max_steps=20)), **SHARED)
    before = weights(algorithm)
    told = algorithm.train()["env_runners"]
    assert dict(told["agent_episode_returns_mean"]) == {"car_0": -20, "car_1": -20}
    assert weights(algorithm) != before


def test_single_car_trains(ppo: Any) -> None:
    """``environment("envs:arena/MountainCar-v0")``: PPO trains on the single car"""
    algorithm = ppo("envs:arena/MountainCar-v0")
    before = weights(algorithm)
    returns = [algorithm.train()["env_runners"].get("episode_return_mean") for _ in range(4)]
    assert returns[-1] == -200
    assert weights(algorithm) != before


def test_two_copies_drive_as_without_rllib_each_with_its_own_seed(ppo: Any) -> None:
    """Two copies of the environment: two seeds, same bits as without RLlib"""
    algorithm = ppo(lambda: ParallelPettingZooEnv(mountain_car_v0.parallel_env(max_steps=25)), **SHARED)
    expected = []
    for seed, episode in zip((5, 6), algorithm.env_runner.sample(num_episodes=2)):
        driven = {
            car: (one.get_observations(), one.get_actions()) for car, one in episode.agent_episodes.items()
        }
        ours = mountain_car_v0.parallel_env(max_steps=25)
        seen, _ = ours.reset(seed=seed)
        for step in range(26):
            assert {car: observations[step].tolist() for car, (observations, _) in driven.items()} == {
                car: observation.tolist() for car, observation in seen.items()
            }
            if ours.agents:
                seen, *_ = ours.step({car: actions[step] for car, (_, actions) in driven.items()})
        expected.append(driven)
    assert len(expected) == 2


@pytest.mark.parametrize("max_steps", [1, 25], ids=["in one step", "apart"])
def test_cars_that_end_apart_get_their_own_flags(ppo: Any, max_steps: int) -> None:
    """Cars that end apart, ``__all__`` set by a short subclass: returns, lengths, flags"""
    algorithm = ppo(lambda: Cars(Apart(mountain_car_v0.parallel_env(max_steps=max_steps))), **SHARED)
    for episode in algorithm.env_runner.sample(num_episodes=2):
        first, last = (episode.agent_episodes[car] for car in ("car_0", "car_1"))
        assert (len(first), first.get_return(), first.is_terminated) == (1, -1, True)
        assert (len(last), last.get_return()) == (max_steps, -max_steps)
        assert (last.is_terminated, last.is_truncated) == (False, True)
    before = weights(algorithm)
    algorithm.train()
    assert weights(algorithm) != before


@pytest.mark.theirs(
    "RLlib 2.60 marks an agent that was truncated as terminated, too, once all agents have ended, so nothing "
    "is bootstrapped at a time limit; say truncated with __all__ alone, as the class Cars of this file does"
)
def test_truncated_agents_are_marked_as_terminated() -> None:
    """An episode in which all agents are truncated"""
    flags = {"a": True, "__all__": True}
    spaces = {
        "observation_space": {"a": gymnasium.spaces.Discrete(2)},
        "action_space": {"a": gymnasium.spaces.Discrete(2)},
    }
    episode = MultiAgentEpisode(**spaces)
    episode.add_env_reset(observations={"a": 0}, infos={})
    nothing = dict.fromkeys(flags, False)
    episode.add_env_step({"a": 0}, {"a": 1}, {"a": 0.0}, {}, terminateds=nothing, truncateds=flags)
    assert episode.is_terminated
    assert episode.agent_episodes["a"].is_terminated


@pytest.mark.theirs(
    "RLlib 2.60 says no __all__ when in one step one agent terminates and another is truncated: then the AEC "
    "wrapper stops with a KeyError, the parallel one takes one more, empty step; use the parallel one"
)
@pytest.mark.parametrize("aec", [False, True], ids=["parallel", "AEC"])
def test_nothing_is_over_when_agents_end_in_different_ways(aec: bool) -> None:
    """``__all__`` of both wrappers when all agents end in one step, in different ways"""
    env = PettingZooEnv(parallel_to_aec(OneStep())) if aec else ParallelPettingZooEnv(OneStep())
    env.reset()
    for actions in ({"a": 0}, {"b": 0}) if aec else ({"a": 0, "b": 0},):
        *_, terminated, truncated, _ = env.step(actions)
    assert (terminated, truncated) == (
        {"a": True, "b": False, "__all__": False},
        {"a": False, "b": True, "__all__": False},
    )
    if aec:
        with pytest.raises(KeyError):
            env.step({})


@pytest.mark.theirs(
    "RLlib 2.60 seeds copy i of worker w with seed + w + i, so copies of different workers drive the same "
    "episodes; let reset add 1000 * worker_index, of the settings that the environment is made with"
)
def test_copies_of_different_workers_share_seeds() -> None:
    """Several copies of the environment in several workers: their seeds"""
    config = PPOConfig().environment("CartPole-v1").env_runners(num_envs_per_env_runner=2).debugging(seed=5)
    seeds = []
    for worker in (1, 2):
        runner = SingleAgentEnvRunner(config=config, worker_index=worker)
        runner.sample(num_timesteps=2, random_actions=True)
        seeds.append(runner.env.unwrapped.np_random_seed)
        runner.stop()
    assert seeds == [(6, 7), (7, 8)]


class OneStep(pettingzoo.ParallelEnv):  # type: ignore[misc, type-arg, unused-ignore]  # the base is untyped
    """The smallest environment in which one agent terminates in the step in which the other is truncated."""

    metadata = {"name": "one_step", "is_parallelizable": True}  # noqa: RUF012 (declared so by the base)
    possible_agents = ["a", "b"]  # noqa: RUF012
    render_mode = None

    def observation_space(self, agent: str) -> Any:
        return gymnasium.spaces.Discrete(2)

    def action_space(self, agent: str) -> Any:
        return gymnasium.spaces.Discrete(2)

    def reset(self, seed: int | None = None, options: Any = None) -> Any:
        self.agents = ["a", "b"]
        return {"a": 0, "b": 0}, {"a": {}, "b": {}}

    def step(self, actions: Any) -> Any:
        self.agents = []
        flags = {"a": True, "b": False}, {"a": False, "b": True}
        return {"a": 1, "b": 1}, {"a": -1.0, "b": -1.0}, *flags, {"a": {}, "b": {}}
