# /// script
# dependencies = ["torchrl>=0.14"]
#
# [tool.clients]
# name = "TorchRL"
# package = "torchrl"
# cheap = false
# ///
"""TorchRL drives the cars: its wrappers for PettingZoo and Gymnasium, cars that end at different times and
their mask, seeds, vectors, a collector, and a loss over the cars that live.
"""

from typing import Any

import gymnasium
import pettingzoo
import pytest
import torch  # type: ignore[import-not-found, unused-ignore]  # its own environment
from countdown import Countdown
from torchrl.collectors import Collector  # type: ignore[import-not-found, unused-ignore]  # its own environment
from torchrl.data import Categorical  # type: ignore[import-not-found, unused-ignore]  # its own environment
from torchrl.envs import (  # type: ignore[import-not-found, unused-ignore]  # its own environment
    DoubleToFloat,
    GymEnv,
    GymWrapper,
    PettingZooWrapper,
    SerialEnv,
    TransformedEnv,
    check_env_specs,
)
from torchrl.modules import MLP, QValueActor  # type: ignore[import-not-found, unused-ignore]  # its own environment
from torchrl.objectives import DQNLoss  # type: ignore[import-not-found, unused-ignore]  # its own environment

from envs import mountain_car_v0

START = {"car_0": (0.45, 0.05), "car_1": (-0.5, 0.0)}  # car_0 reaches the goal in a step or two


def cars(**arguments: Any) -> Any:
    """Two cars as TorchRL has them; the rollout goes on until all have ended."""
    return PettingZooWrapper(
        mountain_car_v0.parallel_env(max_steps=40), use_mask=True, done_on_any=False, **arguments
    )


@pytest.mark.parametrize("make", [mountain_car_v0.parallel_env, mountain_car_v0.env])
def test_specs_of_several_cars_are_right(make: Any) -> None:
    """``PettingZooWrapper(use_mask=True)``: ``check_env_specs`` of parallel and AEC cars"""
    check_env_specs(PettingZooWrapper(make(cars=3, max_steps=40), use_mask=True))


def test_rollout_is_as_without_torchrl_and_its_mask_says_who_lives() -> None:
    """A rollout in which cars end apart: same bits as without TorchRL, mask of who lives"""
    env, ours = cars(), mountain_car_v0.parallel_env(max_steps=40)
    data = env.rollout(1000, auto_reset=False, tensordict=env.reset(seed=1, options={"start": START}))
    observations, _ = ours.reset(seed=1, options={"start": START})
    for step, now in enumerate(data):
        assert now["car", "mask"].tolist() == [car in ours.agents for car in ours.possible_agents]
        for car, seen in observations.items():
            number = ours.possible_agents.index(car)
            if car in ours.agents:
                assert now["car", "observation"][number].tolist() == seen.tolist()
        actions = dict(zip(ours.possible_agents, now["car", "action"].tolist()))
        observations, *_ = ours.step({car: actions[car] for car in ours.agents})
        assert bool(now["next", "done"]) == (not ours.agents) == (step == 39)
    assert data["next", "car", "reward"].sum(0).squeeze().tolist() == (-data["car", "mask"].sum(0)).tolist()
    assert data["car", "mask"].sum(0).tolist()[0] < 5


def test_rollout_ends_with_the_first_car_unless_told_otherwise() -> None:
    """``done_on_any``: by default a rollout of parallel cars ends with the first of them"""
    env = PettingZooWrapper(mountain_car_v0.parallel_env(), use_mask=True)
    data = env.rollout(1000, auto_reset=False, tensordict=env.reset(options={"start": START}))
    assert len(data) < 5
    assert data[-1]["next", "car", "done"].squeeze().tolist() == [True, False]


@pytest.mark.theirs(
    "TorchRL 0.14 gives an AEC agent that has ended an action that is not None, and so stops when one ends "
    "before the others; wrap the parallel environment"
)
def test_aec_rollout_stops_when_agents_end_apart() -> None:
    """``PettingZooWrapper`` of an AEC environment whose agents end apart"""
    env = PettingZooWrapper(pettingzoo.utils.parallel_to_aec(Countdown()), use_mask=True)
    with pytest.raises(AssertionError):
        env.rollout(10)


@pytest.mark.theirs(
    "TorchRL 0.14 begins the episode of the seed in ``set_seed`` and drops it: the first rollout is the "
    "second episode; ``reset(seed=...)`` begins the first"
)
def test_set_seed_drops_the_first_episode() -> None:
    """``set_seed`` and the first rollout after it"""
    env, gym = GymEnv("CartPole-v1"), gymnasium.make("CartPole-v1")
    env.set_seed(7)
    first, second = gym.reset(seed=7)[0].tolist(), gym.reset()[0].tolist()
    assert env.reset()["observation"].tolist() == second
    assert env.reset(seed=7)["observation"].tolist() == first


def test_workers_drive_different_episodes() -> None:
    """Workers of a ``SerialEnv`` drive different episodes, with and without ``set_seed``"""
    env = SerialEnv(2, cars)
    for seed in (None, 7):
        if seed is not None:
            env.set_seed(seed)
        assert len(env.reset()["car", "observation"][..., 0].unique()) == 4


def test_single_car_drives_as_gymnasiums() -> None:
    """``GymEnv`` and ``GymWrapper`` of the single car: specs, and Gymnasium's own episodes"""
    name = "envs:arena/MountainCar-v0"
    for env in (GymEnv(name), GymWrapper(gymnasium.make(name))):
        check_env_specs(env)
        data = env.rollout(300, auto_reset=False, tensordict=env.reset(seed=5))
        gym = gymnasium.make("MountainCar-v0")
        gym.reset(seed=5)
        seen = [gym.step(int(action.argmax()))[0].tolist() for action in data["action"]]
        assert data["next", "observation"].tolist() == seen
        assert data["next", "truncated"].squeeze().tolist() == [False] * 199 + [True]


@pytest.mark.parametrize("mode", ["SameStep", "Disabled"])
def test_vector_drives_different_episodes(mode: str) -> None:
    """``GymWrapper`` of ``make_vec(autoreset_mode=...)``: ``SameStep`` and ``Disabled``"""
    env = GymWrapper(gymnasium.make_vec("envs:arena/MountainCar-v0", 4, autoreset_mode=mode))
    check_env_specs(env)
    data = env.rollout(450, break_when_any_done=False)
    assert data["next", "truncated"].squeeze(-1).nonzero().tolist() == [
        [c, s] for c in range(4) for s in (199, 399)
    ]
    assert len(data["observation"][:, 0, 0].unique()) == len(data["observation"][:, 200, 0].unique()) == 4


def test_cars_that_live_train_a_shared_network() -> None:
    """A collector and a DQN loss, masked, train one network for all cars"""
    env = TransformedEnv(cars(), DoubleToFloat(in_keys=[("car", "observation")], in_keys_inv=[]))
    network = MLP(in_features=2, out_features=3, num_cells=[32])
    loss = DQNLoss(QValueActor(network, spec=Categorical(3)), delay_value=False, action_space="categorical")
    optimizer = torch.optim.Adam(network.parameters(), 1e-3)
    before = [weights.detach().clone() for weights in network.parameters()]
    for data in Collector(env, None, frames_per_batch=100, total_frames=300):
        batch = data["car"].clone()
        batch["next"] = data["next", "car"]
        batch = batch[batch["mask"]]
        assert (batch["next", "reward"] == -1).all()
        optimizer.zero_grad()
        loss(batch)["loss"].backward()
        optimizer.step()
    assert not any(torch.equal(one, other) for one, other in zip(before, network.parameters()))
