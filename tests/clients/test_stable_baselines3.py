# /// script
# dependencies = ["stable-baselines3>=2.9", "supersuit>=3.11", "pettingzoo[classic]>=1.27"]
#
# [tool.clients]
# name = "Stable-Baselines3"
# package = "stable-baselines3"
# cheap = false
# ///
"""Stable-Baselines3 learns on the single car, and through SuperSuit on the cars of PettingZoo.

PPO learns the real Mountain Car; the rest is on a hill with a near goal and a strong car: it takes seconds.
"""

from typing import Any

import numpy as np
import pytest
import supersuit  # type: ignore[import-not-found, unused-ignore]  # its own environment
import torch  # type: ignore[import-not-found, unused-ignore]  # its own environment
from pettingzoo.classic import rps_v2
from stable_baselines3 import DQN, PPO  # type: ignore[import-not-found, unused-ignore]  # its own environment
from stable_baselines3.common.env_checker import (  # type: ignore[import-not-found, unused-ignore]  # likewise
    check_env,
)
from stable_baselines3.common.env_util import (  # type: ignore[import-not-found, unused-ignore]  # likewise
    make_vec_env,
)
from stable_baselines3.common.evaluation import (  # type: ignore[import-not-found, unused-ignore]  # likewise
    evaluate_policy,
)
from stable_baselines3.common.utils import (  # type: ignore[import-not-found, unused-ignore]  # likewise
    set_random_seed,
)
from stable_baselines3.common.vec_env import (  # type: ignore[import-not-found, unused-ignore]  # likewise
    SubprocVecEnv,
    VecNormalize,
)

from agents import MomentumAgent
from arena import Entrant, Evaluation, Policy, PolicyAgent, Tournament, Training, run
from envs import Hill
from envs.mountain_car_v0 import parallel_env
from envs.parked import Parked
from envs.single_car_v0 import SingleCarEnv

CAR = "envs:arena/MountainCar-v0"
NEAR = Hill(thrust=2.0, goal_position=-0.1)
ON_POLICY = {"n_steps": 16, "batch_size": 256, "n_epochs": 4, "gae_lambda": 0.98, "learning_rate": 1e-3}
OFF_POLICY = {
    "learning_rate": 2e-3,
    "batch_size": 128,
    "gamma": 0.98,
    "learning_starts": 1000,
    "target_update_interval": 300,
    "train_freq": 4,
    "gradient_steps": 4,
    "exploration_fraction": 0.8,
    "exploration_final_eps": 0.1,
}
SMALL = {"policy_kwargs": {"net_arch": [32, 32]}}

torch.set_num_threads(1)


def single_cars(count: int, seed: int, **arguments: Any) -> Any:
    return make_vec_env(CAR, count, seed=seed, env_kwargs={"hill": NEAR}, **arguments)


def many_cars(count: int, hill: Hill) -> Any:
    """PettingZoo's cars as Stable-Baselines3's vector: those that have ended stay until all have."""
    cars = Parked(supersuit.dtype_v0(parallel_env(count, hill), np.float32))
    vector = supersuit.pettingzoo_env_to_vec_env_v1(cars)
    return supersuit.concat_vec_envs_v1(vector, 1, base_class="stable_baselines3")


def steps_of(policy: Any, hill: Hill) -> float:
    """Mean steps of eight cars, from starts of their own, driven in PettingZoo's environment."""
    cars = parallel_env(8, hill)
    observations: dict[str, Any] = cars.reset(seed=3)[0]
    steps = 0
    while cars.agents:
        steps += len(cars.agents)
        seen = np.array(list(observations.values()), np.float32)
        chosen = dict(zip(observations, policy(seen), strict=True))
        observations = cars.step({car: int(chosen[car]) for car in cars.agents})[0]
    return steps / 8


def test_check_env() -> None:
    """``check_env`` of the single car without a warning"""
    check_env(SingleCarEnv(), warn=True)


def test_random_actions_take_long() -> None:
    """Actions at random never or hardly arrive: what follows was learned"""
    rng = np.random.default_rng(1)
    assert steps_of(lambda seen: rng.integers(3, size=len(seen)), Hill()) == 200
    assert steps_of(lambda seen: rng.integers(3, size=len(seen)), NEAR) > 150


def test_ppo_on_the_single_car() -> None:
    """``PPO`` with ``VecNormalize`` learns the real Mountain Car: less than 150 of 200 steps"""
    cars = VecNormalize(make_vec_env(CAR, 16, seed=1))
    model = PPO("MlpPolicy", cars, seed=1, **ON_POLICY, **SMALL).learn(75_000)
    cars.training = cars.norm_reward = False
    assert evaluate_policy(model, cars, n_eval_episodes=32)[0] > -150


def test_dqn_on_the_single_car() -> None:
    """``DQN`` learns on one single car, on an easier hill"""
    model = DQN("MlpPolicy", single_cars(1, seed=1), seed=1, **OFF_POLICY, **SMALL).learn(8000)
    assert evaluate_policy(model, single_cars(4, seed=2), n_eval_episodes=20)[0] > -40


def test_ppo_on_cars_of_pettingzoo() -> None:
    """``PPO`` learns the real Mountain Car through SuperSuit, on 16 cars that end at different times"""
    set_random_seed(1)
    cars = VecNormalize(many_cars(16, Hill()))
    model = PPO("MlpPolicy", cars, **ON_POLICY, **SMALL).learn(75_000)
    assert steps_of(lambda seen: model.predict(cars.normalize_obs(seen), deterministic=True)[0], Hill()) < 150


def test_dqn_on_cars_of_pettingzoo() -> None:
    """``DQN`` learns through SuperSuit on four cars that end at different times, on an easier hill"""
    set_random_seed(1)
    model = DQN("MlpPolicy", many_cars(4, NEAR), **OFF_POLICY, **SMALL).learn(16_000)
    assert steps_of(lambda seen: model.predict(seen, deterministic=True)[0], NEAR) < 40


def test_vectors_in_processes() -> None:
    """``SubprocVecEnv`` of single cars: each its own seed, the same as in one process"""
    apart, together = single_cars(3, 1, vec_env_cls=SubprocVecEnv), single_cars(3, 1)
    starts = together.reset()
    assert len(np.unique(starts[:, 0])) == 3
    np.testing.assert_array_equal(apart.reset(), starts)
    for _ in range(210):
        np.testing.assert_array_equal(
            apart.step(np.array([2, 0, 1]))[0], together.step(np.array([2, 0, 1]))[0]
        )
    apart.close()


@pytest.mark.theirs(
    "a model on SuperSuit's vector takes no `seed`, since that has no method of this name (SuperSuit 3.11); "
    "reset the cars with a seed before they are wrapped, and call set_random_seed"
)
def test_seed_through_supersuit() -> None:
    """``PPO(..., seed=1)`` through SuperSuit"""
    vector = supersuit.pettingzoo_env_to_vec_env_v1(rps_v2.parallel_env())
    vector = supersuit.concat_vec_envs_v1(vector, 1, base_class="stable_baselines3")
    with pytest.raises(AttributeError, match="no attribute 'seed'"):
        PPO("MlpPolicy", vector, seed=1)


def test_remedy_for_the_seed() -> None:
    """Cars that were reset with a seed before they were wrapped: training to the bit the same"""

    def weights() -> list[bytes]:
        set_random_seed(1)
        cars = parallel_env(2, NEAR)
        cars.reset(seed=1)
        vector = supersuit.pettingzoo_env_to_vec_env_v1(Parked(cars))
        vector = supersuit.concat_vec_envs_v1(vector, 1, base_class="stable_baselines3")
        model = PPO("MlpPolicy", vector, n_steps=32, batch_size=64, **SMALL).learn(256)
        return [parameter.detach().numpy().tobytes() for parameter in model.policy.parameters()]

    assert weights() == weights()


def test_models_race_here() -> None:
    """``predict`` of ``PPO`` and ``DQN`` models as entrants, in processes: the same steps as there"""
    models = {
        "ppo": PPO("MlpPolicy", single_cars(8, seed=1), seed=1, **ON_POLICY, **SMALL).learn(2000),
        "dqn": DQN("MlpPolicy", single_cars(1, seed=1), seed=1, buffer_size=2000, **SMALL).learn(2000),
    }
    entrants = tuple(Entrant(name, PolicyAgent.of(model.predict)) for name, model in models.items())
    raced = Tournament(entrants, NEAR, Training(1, 50), Evaluation(4, 200), replicates=1)
    with run(raced, n_jobs=2) as results:
        starts = raced.conditions.start_states(0)
        for name, model in models.items():
            steps = [steps_from(tuple(start), model) for start in starts]
            assert results.arrays(name)["test_lengths"].tolist() == steps


def steps_from(start: tuple[float, float], model: Any) -> int:
    car = SingleCarEnv(NEAR)
    observation, _ = car.reset(options={"start": start})
    steps, terminated = 0, False
    while not terminated and steps < 200:
        observation, _, terminated, _, _ = car.step(model.predict(observation, deterministic=True)[0])
        steps += 1
    return steps


@pytest.mark.parametrize("count", [1, 5])
def test_our_agents_are_evaluated_there(count: int) -> None:
    """``evaluate_policy`` drives an agent of ours in Gymnasium's ``MountainCar-v0``, alone and in vectors"""
    cars = make_vec_env("MountainCar-v0", count, seed=0)
    mean, _ = evaluate_policy(Policy(MomentumAgent.create(Hill())), cars, n_eval_episodes=20)
    assert mean == pytest.approx(-119.4, abs=3)
