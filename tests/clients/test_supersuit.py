# /// script
# dependencies = ["supersuit>=3.11"]
#
# [tool.clients]
# name = "SuperSuit"
# package = "supersuit"
# cheap = true
# ///
"""SuperSuit's wrappers and vectors over our cars. Where it goes wrong, two agents that just count show it."""

from typing import Any

import gymnasium
import numpy as np
import pytest
import supersuit  # type: ignore[import-not-found, unused-ignore]  # its own environment
from countdown import Countdown

from envs.mountain_car_v0 import parallel_env

EARLY = {"start": {"car_0": (0.45, 0.06)}}
"""With thrust to the right this car is there after one step."""


def same_limit(cars: int = 3, **arguments: Any) -> parallel_env:
    """Cars that end together, since none can reach the goal in 20 steps."""
    return parallel_env(cars, max_steps=20, **arguments)


def test_vector_of_cars_that_end_together() -> None:
    """``pettingzoo_env_to_vec_env_v1`` of cars that end together drives as the cars themselves"""
    vector, cars = supersuit.pettingzoo_env_to_vec_env_v1(same_limit()), same_limit()
    observed, _ = vector.reset(seed=1)
    wanted: Any = cars.reset(seed=1)[0]
    for _ in range(19):
        np.testing.assert_array_equal(observed, list(wanted.values()))
        observed, *_ = vector.step(np.array([2, 0, 1]))
        wanted = cars.step({"car_0": 2, "car_1": 0, "car_2": 1})[0]
    *_, truncations, infos = vector.step(np.array([2, 0, 1]))
    wanted = cars.step({"car_0": 2, "car_1": 0, "car_2": 1})[0]
    assert truncations.all()
    for info, last in zip(infos, wanted.values(), strict=True):
        np.testing.assert_array_equal(info["terminal_observation"], last)


def test_vector_without_black_death() -> None:
    """``pettingzoo_env_to_vec_env_v1`` says so when cars end at different times"""
    vector = supersuit.pettingzoo_env_to_vec_env_v1(same_limit())
    vector.reset(options=EARLY)
    with pytest.raises(AssertionError, match="varying numbers of active agents"):
        vector.step(np.array([2, 2, 2]))


def test_black_death() -> None:
    """``black_death_v3``: cars that have ended stay, with zeros for observation and reward"""
    vector = supersuit.pettingzoo_env_to_vec_env_v1(supersuit.black_death_v3(same_limit()))
    vector.reset(seed=1, options=EARLY)
    _, rewards, *_ = vector.step(np.array([2, 1, 1]))
    assert rewards.tolist() == [-1, -1, -1]
    for _ in range(19):
        observed, rewards, *_ = vector.step(np.array([2, 1, 1]))
        assert rewards.tolist() == [0, -1, -1]
        assert not observed[0].any()
        assert observed[1:, 0].all()


@pytest.mark.theirs(
    "with `black_death_v3` (3.11) an episode ends a step late, with reward 0 and a zero observation, and as "
    "terminated and truncated at once, because it waits for a step in which nobody is left; use a vector of "
    "single cars instead, or bootstrap nothing there"
)
def test_end_with_black_death() -> None:
    """``black_death_v3``: the end of the episode"""
    agents = supersuit.black_death_v3(Countdown())
    agents.reset(seed=1)
    for _ in range(3):
        *_, terminations, truncations, _ = agents.step({"a_0": 0, "a_1": 0})
    assert not any((terminations | truncations).values())  # though all had terminated by now
    observed, rewards, terminations, truncations, _ = agents.step({"a_0": 0, "a_1": 0})
    assert set(rewards.values()) == {0.0}
    assert not np.any(list(observed.values()))
    assert all(terminations.values())
    assert all(truncations.values())  # nobody was


def test_copies() -> None:
    """``concat_vec_envs_v1`` in one process: ``reset(seed)`` gives each copy starts of its own"""
    copies = supersuit.concat_vec_envs_v1(supersuit.pettingzoo_env_to_vec_env_v1(same_limit()), 4)
    starts = copies.reset(seed=1)[0][:, 0]
    assert len(set(starts)) == 12
    assert copies.reset(seed=1)[0][:, 0].tolist() == starts.tolist()
    for _ in range(20):
        copies.step(np.ones(12, np.int64))
    assert len(set(copies.step(np.ones(12, np.int64))[0][:, 0])) == 12


@pytest.mark.theirs(
    "`concat_vec_envs_v1` (3.11) with several processes gives copies in different processes the same seed; "
    "take as many processes as copies"
)
def test_copies_in_processes() -> None:
    """``concat_vec_envs_v1`` with fewer processes than copies: ``reset(seed)``"""
    vector = supersuit.pettingzoo_env_to_vec_env_v1(Countdown())
    copies = supersuit.concat_vec_envs_v1(vector, 4, num_cpus=2)
    draws = copies.reset(seed=1)[0][::2, 1]
    copies.close()
    assert len(set(draws)) == 3


def test_copy_in_a_process_each() -> None:
    """``concat_vec_envs_v1`` with a process a copy: starts of its own, the same as in one process"""
    vector = supersuit.pettingzoo_env_to_vec_env_v1(same_limit())
    apart = supersuit.concat_vec_envs_v1(vector, 2, num_cpus=2)
    together = supersuit.concat_vec_envs_v1(vector, 2)
    np.testing.assert_array_equal(apart.reset(seed=1)[0], together.reset(seed=1)[0])
    actions = np.array([0, 1, 2, 2, 1, 0])
    for _ in range(20):
        for one, other in zip(apart.step(actions)[:4], together.step(actions)[:4], strict=True):
            np.testing.assert_array_equal(one, other)
    apart.close()


def test_frame_stack() -> None:
    """``frame_stack_v1``: the last four observations"""
    cars, stacked = same_limit(1), supersuit.frame_stack_v1(same_limit(1), 4)
    seen = [cars.reset(seed=1)[0]["car_0"]]
    stacked.reset(seed=1)
    for _ in range(5):
        seen.append(cars.step({"car_0": 2})[0]["car_0"])
        observed = stacked.step({"car_0": 2})[0]["car_0"]
    assert observed.tolist() == np.concatenate(seen[-4:]).tolist()
    assert observed in stacked.observation_space("car_0")


def test_normalise() -> None:
    """``dtype_v0`` and ``normalize_obs_v0``: float32 from -1 to 1"""
    cars = supersuit.normalize_obs_v0(supersuit.dtype_v0(same_limit(), np.float32), -1, 1)
    observed = cars.reset(options={"start": {"car_0": (-0.3, 0.07), "car_1": (-1.2, 0.0)}})[0]
    assert observed["car_0"].tolist() == [0.0, 1.0]
    assert observed["car_1"].tolist() == [-1.0, 0.0]
    assert observed["car_0"].dtype == np.float32


def test_frame_skip() -> None:
    """``frame_skip_v0``: an action lasts three steps"""
    cars, skipping = same_limit(), supersuit.frame_skip_v0(same_limit(), 3)
    cars.reset(seed=1)
    skipping.reset(seed=1)
    actions = dict.fromkeys(cars.agents, 2)
    observed, rewards, *_ = skipping.step(actions)
    wanted = [cars.step(actions) for _ in range(3)][-1][0]
    assert {car: one.tolist() for car, one in observed.items()} == {
        car: one.tolist() for car, one in wanted.items()
    }
    assert set(rewards.values()) == {-3.0}


@pytest.mark.parametrize(
    "wrap",
    [
        lambda cars: supersuit.sticky_actions_v0(cars, 0.25),
        lambda cars: supersuit.delay_observations_v0(cars, 2),
        lambda cars: supersuit.max_observation_v0(cars, 2),
        lambda cars: supersuit.clip_reward_v0(cars, -0.5, 0.0),
        lambda cars: supersuit.agent_indicator_v0(supersuit.normalize_obs_v0(cars, -1, 1)),
        supersuit.flatten_v0,
        supersuit.pad_observations_v0,
        supersuit.pad_action_space_v0,
    ],
)
def test_other_wrappers(wrap: Any) -> None:
    """Sticky actions, delay, maximum, clipping, indicator (normalised), flatten, padding drive to the end"""
    cars = wrap(same_limit())
    observed = cars.reset(seed=1)[0]
    steps = 0
    while cars.agents:
        assert all(observed[car] in cars.observation_space(car) for car in cars.agents)
        observed = cars.step(dict.fromkeys(cars.agents, 1))[0]
        steps += 1
    assert steps == 20


@pytest.mark.theirs(
    "`agent_indicator_v0` (3.11) marks an agent with the greatest bound of its space, and promises the "
    "least; normalise first, then they are one"
)
def test_indicator() -> None:
    """``agent_indicator_v0`` of observations whose bounds differ"""
    agents = supersuit.agent_indicator_v0(Countdown())
    observed = agents.reset(seed=1)[0]["a_0"]
    assert observed[2:].tolist() == [3.0, 0.0]
    assert agents.observation_space("a_0").high[2:].tolist() == [1.0, 1.0]


def test_vector_of_single_cars() -> None:
    """``gym_vec_env_v0`` of the single car drives as our vector of cars"""
    theirs = supersuit.gym_vec_env_v0(gymnasium.make("envs:arena/MountainCar-v0"), 3)
    ours = gymnasium.make_vec("envs:arena/MountainCar-v0", 3)
    np.testing.assert_array_equal(theirs.reset(seed=1)[0], ours.reset(seed=1)[0])
    for _ in range(210):
        np.testing.assert_array_equal(theirs.step(np.array([2, 0, 1]))[0], ours.step(np.array([2, 0, 1]))[0])
