# /// script
# dependencies = ["pettingzoo[classic,testing]>=1.27", "pygame>=2.6"]
#
# [tool.clients]
# name = "PettingZoo"
# package = "pettingzoo"
# cheap = true
# ///
"""PettingZoo's own test package over our cars, and its registry, wrappers and conversions."""

import os
import warnings
from typing import Any

import numpy as np
import pettingzoo
import pettingzoo.test
import pytest
from pettingzoo.utils import BaseParallelWrapper, OrderEnforcingWrapper, aec_to_parallel, parallel_to_aec

import envs  # noqa: F401 (registers the cars)
from envs import mountain_car_v0
from envs.mountain_car_v0 import env, parallel_env, raw_env
from envs.parked import Parked

os.environ.setdefault("SDL_VIDEODRIVER", "dummy")  # windows without a screen


@pytest.mark.parametrize("cars", [1, 2, 8])
def test_parallel_api(cars: int) -> None:
    """``parallel_api_test``"""
    pettingzoo.test.parallel_api_test(parallel_env(cars), num_cycles=1000)


def test_parked_cars() -> None:
    """``parallel_api_test`` and ``api_test`` of cars that stay until all have ended"""
    pettingzoo.test.parallel_api_test(Parked(parallel_env(3), "together"), num_cycles=1000)
    pettingzoo.test.api_test(parallel_to_aec(Parked(parallel_env(3), "together")), num_cycles=1000)


@pytest.mark.parametrize("make", [env, raw_env])
def test_api(make: Any) -> None:
    """``api_test`` of the turn-based environment"""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        pettingzoo.test.api_test(make(cars=3), num_cycles=1000)


def test_seeds() -> None:
    """``seed_test`` and ``parallel_seed_test``"""
    pettingzoo.test.seed_test(env)
    pettingzoo.test.parallel_seed_test(parallel_env)


def test_max_cycles() -> None:
    """``max_cycles_test``"""
    pettingzoo.test.max_cycles_test(mountain_car_v0)


def test_render() -> None:
    """``render_test``: human, rgb_array and ansi"""
    pettingzoo.test.render_test(env)


def test_state() -> None:
    """``state_test`` without a warning"""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        pettingzoo.test.state_test(env(), parallel_env(), num_cycles=100)


def test_save_observations(capsys: pytest.CaptureFixture[str]) -> None:
    """``test_save_obs``: it says that observations that are no images are not saved"""
    pettingzoo.test.test_save_obs(env())
    assert "did not save the observations:  Observations must be 0 to 255" in capsys.readouterr().out


@pytest.mark.theirs(
    "`bombardment_test` of 1.27 takes what `step` returns, which is None, for an observation, and so fails "
    "with every environment; the other tests cover what it is for"
)
def test_bombardment() -> None:
    """``bombardment_test``"""
    from pettingzoo.classic import rps_v2

    with pytest.raises(AssertionError, match="outside of its observation space"):
        pettingzoo.test.bombardment_test(rps_v2.env(), cycles=20)


def test_performance(capsys: pytest.CaptureFixture[str]) -> None:
    """``performance_benchmark``"""
    pettingzoo.test.performance_benchmark(env(cars=8))
    told = capsys.readouterr().out
    assert "turns per second" in told


def test_registry() -> None:
    """``pettingzoo.make`` of the registered names, parallel and turn-based"""
    cars = pettingzoo.make("parallel", "arena/mountain_car_v0", cars=["a", "b"])
    assert list(cars.reset(seed=1)[0]) == ["a", "b"]
    turns = pettingzoo.make("aec", "arena/mountain_car_v0", cars=3)
    turns.reset(seed=1)
    assert turns.num_agents == 3


def test_wrappers() -> None:
    """``BaseParallelWrapper`` and ``OrderEnforcingWrapper`` change nothing"""
    plain, wrapped = parallel_env(2), BaseParallelWrapper(parallel_env(2))
    for _ in range(2):
        assert repr(plain.reset(seed=1)) == repr(wrapped.reset(seed=1))
        assert repr(plain.step({"car_0": 2, "car_1": 0})) == repr(wrapped.step({"car_0": 2, "car_1": 0}))
    turns = OrderEnforcingWrapper(raw_env())
    with pytest.raises(Exception, match="reset"):
        turns.step(0)


def test_there_and_back() -> None:
    """``aec_to_parallel`` of the turn-based environment drives as the parallel one"""
    back, cars = aec_to_parallel(env(max_steps=30)), parallel_env(max_steps=30)
    assert repr(back.reset(seed=1)[0]) == repr(cars.reset(seed=1)[0])
    while cars.agents:
        actions = dict.fromkeys(cars.agents, 2)
        answers: Any = zip(back.step(actions)[:4], cars.step(actions)[:4], strict=True)
        for one, other in answers:
            assert {car: np.asarray(value).tolist() for car, value in one.items()} == {
                car: np.asarray(value).tolist() for car, value in other.items()
            }
    assert not back.agents
