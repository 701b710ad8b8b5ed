# /// script
# dependencies = ["gymnasium[classic-control,other]>=1.0"]
#
# [tool.clients]
# name = "Gymnasium"
# package = "gymnasium"
# cheap = true
# ///
"""Gymnasium's checks, wrappers and vectors over the single car, and over the vector of cars."""

import os
import warnings
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium import wrappers
from gymnasium.utils.env_checker import check_env
from gymnasium.utils.performance import benchmark_step
from gymnasium.vector import AsyncVectorEnv, SyncVectorEnv
from gymnasium.wrappers import vector

os.environ.setdefault("SDL_VIDEODRIVER", "dummy")  # windows without a screen

CAR = "envs:arena/MountainCar-v0"


def episode(env: gymnasium.Env[Any, Any]) -> list[bytes]:
    """All that is observed when the driver pushes with the velocity."""
    seen = [env.reset(seed=1)[0]]
    ended = False
    while not ended:
        observation, _, terminated, truncated, _ = env.step(2 if seen[-1][1] >= 0 else 0)
        seen.append(observation)
        ended = terminated or truncated
    return [observation.tobytes() for observation in seen]


def test_check_env() -> None:
    """``check_env`` without a warning"""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(CAR, render_mode="rgb_array").unwrapped)


def test_drop_in() -> None:
    """The same bits as ``MountainCar-v0``"""
    assert episode(gymnasium.make(CAR)) == episode(gymnasium.make("MountainCar-v0"))


@pytest.mark.parametrize(
    "name", ["RecordEpisodeStatistics", "OrderEnforcing", "PassiveEnvChecker", "Autoreset"]
)
def test_wrappers_that_watch(name: str) -> None:
    """Wrappers that watch (statistics, order, checker, autoreset) change no observation"""
    wrapper = getattr(wrappers, name)
    assert episode(wrapper(gymnasium.make(CAR))) == episode(gymnasium.make(CAR))


def test_statistics() -> None:
    """``RecordEpisodeStatistics`` tells the length and the return"""
    env = wrappers.RecordEpisodeStatistics(gymnasium.make(CAR))
    steps = len(episode(env)) - 1
    assert list(env.length_queue) == [steps]
    assert list(env.return_queue) == [-steps]


@pytest.mark.parametrize(
    ("wrap", "shape"),
    [
        (lambda env: wrappers.FrameStackObservation(env, 4), (4, 2)),
        (wrappers.TimeAwareObservation, (3,)),
        (lambda env: wrappers.FlattenObservation(wrappers.FrameStackObservation(env, 3)), (6,)),
        (lambda env: wrappers.DelayObservation(env, 2), (2,)),
    ],
    ids=["stack", "time", "flatten", "delay"],
)
def test_wrappers_of_observations(wrap: Any, shape: tuple[int, ...]) -> None:
    """Frame stack, time, flatten and delay give observations in their space"""
    env = wrap(gymnasium.make(CAR))
    observation, _ = env.reset(seed=1)
    for _ in range(5):
        assert observation.shape == shape
        assert observation in env.observation_space
        observation, *_ = env.step(2)


def test_scaling() -> None:
    """``RescaleObservation`` and ``NormalizeObservation``"""
    scaled = wrappers.RescaleObservation(gymnasium.make(CAR), np.float32(-1), np.float32(1))
    plain = gymnasium.make(CAR)
    position = plain.reset(seed=1)[0][0]
    assert scaled.reset(seed=1)[0][0] == pytest.approx(2 * (position + 1.2) / 1.8 - 1, abs=1e-6)
    normal = wrappers.NormalizeObservation(gymnasium.make(CAR))
    seen = np.array([np.frombuffer(one, np.float32) for one in episode(normal)])
    assert np.abs(seen).max() < 20


def test_video(tmp_path: Path) -> None:
    """``RecordVideo`` writes an mp4"""
    env: Any = wrappers.RecordVideo(gymnasium.make(CAR, render_mode="rgb_array"), str(tmp_path))
    episode(env)
    env.close()
    assert [file.suffix for file in tmp_path.iterdir()] == [".mp4"]


@pytest.mark.parametrize("make", [SyncVectorEnv, AsyncVectorEnv])
def test_vectors_of_single_cars(make: Any) -> None:
    """``SyncVectorEnv`` and ``AsyncVectorEnv`` of single cars drive as our vector of cars"""
    theirs: Any = make([lambda: gymnasium.make(CAR)] * 4)
    ours = gymnasium.make_vec(CAR, 4)
    assert ours.reset(seed=1)[0].tobytes() == theirs.reset(seed=1)[0].tobytes()
    for step in range(250):
        actions = np.full(4, step // 40 % 3)
        for one, other in zip(ours.step(actions)[:4], theirs.step(actions)[:4], strict=True):
            assert one.tobytes() == other.tobytes()
    theirs.close()


def test_wrappers_of_vectors() -> None:
    """Wrappers of vectors over our vector of cars: statistics, scaling, normalising"""
    cars = vector.RecordEpisodeStatistics(gymnasium.make_vec(CAR, 8))
    cars.reset(seed=1)
    for _ in range(200):
        *_, info = cars.step(np.ones(8, np.int64))
    assert info["episode"]["l"].tolist() == [200] * 8
    scaled = vector.RescaleObservation(gymnasium.make_vec(CAR, 8), np.float32(-1), np.float32(1))
    assert np.abs(scaled.reset(seed=1)[0]).max() <= 1
    normal = vector.NormalizeObservation(gymnasium.make_vec(CAR, 8))
    normal.reset(seed=1)
    assert np.isfinite(normal.step(np.ones(8, np.int64))[0]).all()


def test_performance() -> None:
    """``benchmark_step``"""
    assert benchmark_step(gymnasium.make(CAR), target_duration=1) > 1000
