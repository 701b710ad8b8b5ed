"""One car and vectors of cars for Gymnasium: beside Gymnasium's own, to the bit."""

import pickle
import subprocess
import sys
import warnings
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode, SyncVectorEnv

from envs import Hill
from envs.rendering import picture
from envs.single_car_v0 import SingleCarEnv
from envs.vector_car_v0 import VectorCarEnv

ID = "envs:arena/MountainCar-v0"
SEEDS = range(5)


def spun(seed: int, steps: int, count: int | None = None) -> Any:
    """Actions of blocks of some length, so that cars get somewhere."""
    rng = np.random.default_rng(seed)
    shape = (steps // 20 + 1,) if count is None else (steps // 20 + 1, count)
    return np.repeat(rng.integers(3, size=shape), 20, axis=0)[:steps]


# One car


@pytest.mark.parametrize("seed", SEEDS)
def test_it_is_gymnasium_s_mountain_car_to_the_bit(seed: int) -> None:
    ours, theirs = gymnasium.make(ID), gymnasium.make("MountainCar-v0")
    assert ours.observation_space == theirs.observation_space
    assert ours.action_space == theirs.action_space
    assert ours.spec is not None
    assert theirs.spec is not None
    assert ours.spec.max_episode_steps == theirs.spec.max_episode_steps
    assert ours.spec.reward_threshold == theirs.spec.reward_threshold
    ends = 0
    for options in (None, {"low": -0.9, "high": -0.8}, None):
        first, second = (
            env.reset(seed=seed if options is None else None, options=options) for env in (ours, theirs)
        )
        assert first[0].tobytes() == second[0].tobytes()
        swing = 1
        for _ in range(200):
            swing = 2 if second[0][1] >= 0 else 0
            one, other = (env.step(swing) for env in (ours, theirs))
            assert one[0].tobytes() == other[0].tobytes()
            assert one[0].dtype == other[0].dtype
            assert one[1:4] == other[1:4]
            second = (other[0], {})
            if one[2] or one[3]:
                ends += one[2]
                break
    assert ends == 3


def test_it_passes_gymnasium_s_check(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")  # it opens a window, too
    for hill in (Hill(), Hill(omega=2.0, integrator="explicit", goal_position=0.4)):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            check_env(SingleCarEnv(hill), skip_render_check=True)
    check_env(gymnasium.make(ID, render_mode="rgb_array").unwrapped)


def test_any_hill_any_start() -> None:
    hill = Hill(thrust=0.5)
    car = gymnasium.make(ID, hill=hill)
    observation, _ = car.reset(seed=1, options={"start": (-0.3, 0.01)})
    assert observation.tolist() == [np.float32(-0.3), np.float32(0.01)]
    after = car.step(2)[0]
    assert after.tolist() == [np.float32(value) for value in hill.step((-0.3, 0.01), 2)[0]]


def test_time_runs_out_after_two_hundred_steps() -> None:
    car = gymnasium.make(ID)
    car.reset(seed=1)
    ends = [car.step(1)[2:4] for _ in range(200)]
    assert ends[:-1] == [(False, False)] * 199
    assert ends[-1] == (False, True)


def test_it_renders() -> None:
    car = SingleCarEnv(render_mode="rgb_array")
    car.reset(options={"start": (-0.5, 0.0)})
    assert np.array_equal(np.asarray(car.render()), picture(Hill(), {"car": (-0.5, 0.0)}, 0))
    told = SingleCarEnv(render_mode="ansi")
    told.reset(options={"start": (-0.5, 0.0)})
    assert str(told.render()).startswith("step 0\ncar  position -0.5000")
    with pytest.warns(UserWarning, match="render is called without a render_mode"):
        SingleCarEnv().render()


def test_a_copy_goes_on_in_the_same_episode() -> None:
    car = SingleCarEnv()
    car.reset(seed=4)
    car.step(2)
    copied = pickle.loads(pickle.dumps(car))  # noqa: S301
    assert copied.step(0)[0].tobytes() == car.step(0)[0].tobytes()
    assert copied.reset()[0].tobytes() == car.reset()[0].tobytes()  # the stream goes on, too


@pytest.mark.parametrize(
    ("error", "options", "message"),
    [
        (ValueError, {"start": (0.6, 0.0)}, r"start position must be in \[-1.2, 0.5\], got 0.6"),
        (ValueError, {"start": (-0.5, 1.0)}, r"start velocity must be in \[-0.07, 0.07\], got 1.0"),
        (ValueError, {"start": -0.5}, r"start must be \(position, velocity\), got -0.5"),
        (ValueError, {"low": -2.0}, r"low must be in \[-1.2, 0.5\], got -2.0"),
        (ValueError, {"low": -0.4, "high": -0.5}, r"high must be in \[-0.4, 0.5\], got -0.5"),
        (TypeError, {"low": "left"}, "low must be a number, got 'left'"),
    ],
)
def test_bad_options_are_refused_in_one_sentence(
    error: type[Exception], options: dict[str, Any], message: str
) -> None:
    with pytest.raises(error, match=f"^{message}"):
        SingleCarEnv().reset(options=options)


def test_bad_arguments_and_actions_are_refused_in_one_sentence() -> None:
    with pytest.raises(TypeError, match="hill must be a Hill, got 3"):
        SingleCarEnv(hill=3)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="render_mode must be one of"):
        SingleCarEnv(render_mode="film")
    car = SingleCarEnv()
    with pytest.raises(ValueError, match="reset must be called before step"):
        car.step(1)
    car.reset(seed=1)
    with pytest.raises(ValueError, match="action must be less than 3, got 3"):
        car.step(3)


# Vectors of cars


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
@pytest.mark.parametrize("seed", [0, [5, None, 7, 9, 11]])
def test_it_is_gymnasium_s_sync_vector_of_single_cars_to_the_bit(mode: AutoresetMode, seed: Any) -> None:
    ours = VectorCarEnv(5, max_episode_steps=125, autoreset_mode=mode)
    makers = [lambda: gymnasium.make(ID, max_episode_steps=125)] * 5
    theirs = SyncVectorEnv(makers, autoreset_mode=mode)
    start = ours.reset(seed=[1, 2, 3, 4, 5])[0], theirs.reset(seed=[1, 2, 3, 4, 5])[0]
    assert start[0].tobytes() == start[1].tobytes()
    start = ours.reset(seed=seed)[0], theirs.reset(seed=seed)[0]
    assert start[0].tobytes() == start[1].tobytes()
    ends = np.zeros(2, int)
    seen = start[0]
    for step in range(900):
        actions = np.where(seen[:, 1] >= 0, 2, 0) if step % 300 < 200 else spun(step, 1, 5)[0]
        one: Any = ours.step(actions)
        other: Any = theirs.step(actions)
        for mine, wanted in zip(one[:4], other[:4], strict=True):
            assert mine.tobytes() == wanted.tobytes()
            assert mine.dtype == wanted.dtype
        assert one[4].keys() == other[4].keys()
        for car in np.flatnonzero(other[4].get("_final_obs", np.zeros(5, bool))):
            assert one[4]["final_obs"][car].tobytes() == other[4]["final_obs"][car].tobytes()
            assert one[4]["_final_obs"][car]
        seen = other[0]
        ends += [one[2].sum(), one[3].sum()]
    assert (ends > 3).all()  # some at the goal, some by time


def test_without_autoreset_the_caller_resets_those_that_have_ended() -> None:
    cars = VectorCarEnv(3, max_episode_steps=5, autoreset_mode="Disabled")
    cars.reset(seed=1)
    cars.reset(options={"start": (0.49, 0.06), "reset_mask": np.array([False, True, False])})
    before = cars.step(np.array([2, 2, 2]))
    assert before[2].tolist() == [False, True, False]
    with pytest.raises(ValueError, match=r"^cars that have ended must be reset, got a step of \[1\]"):
        cars.step(np.array([0, 0, 0]))
    after = cars.reset(options={"reset_mask": np.array([False, True, False])})[0]
    assert after[[0, 2]].tobytes() == before[0][[0, 2]].tobytes()
    assert cars.single_observation_space.contains(after[1])
    assert not cars.step(np.array([0, 0, 0]))[2].any()


def test_gymnasium_makes_it() -> None:
    cars = gymnasium.make_vec(ID, num_envs=4, hill=Hill(thrust=0.5), autoreset_mode="SameStep")
    assert isinstance(cars.unwrapped, VectorCarEnv)
    assert cars.metadata["autoreset_mode"] is AutoresetMode.SAME_STEP
    assert cars.unwrapped.max_episode_steps == 200
    observations, _ = cars.reset(seed=1)
    assert cars.observation_space.contains(observations)
    assert cars.observation_space.contains(cars.step(cars.action_space.sample())[0])
    cars.close()


def test_all_cars_are_in_one_picture() -> None:
    cars = VectorCarEnv(2, render_mode="rgb_array")
    cars.reset(options={"start": (-0.5, 0.0)})
    frames = cars.render()
    assert frames is not None
    assert np.array_equal(frames[0], picture(Hill(), {"car 0": (-0.5, 0.0), "car 1": (-0.5, 0.0)}, 0))


def test_a_copy_of_a_vector_goes_on_the_same() -> None:
    cars = VectorCarEnv(2)
    cars.reset(seed=1)
    cars.step(np.array([0, 2]))
    copied = pickle.loads(pickle.dumps(cars))  # noqa: S301
    assert copied.step(np.array([1, 2]))[0].tobytes() == cars.step(np.array([1, 2]))[0].tobytes()


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("num_envs", 0, "num_envs must be at least 1, got 0"),
        ("max_episode_steps", 0, "max_episode_steps must be at least 1, got 0"),
        ("autoreset_mode", "later", "autoreset_mode must be one of .*, got 'later'"),
        ("render_mode", "human", "render_mode must be .*rgb_array.*, got 'human'"),
    ],
)
def test_bad_arguments_of_a_vector_are_refused(name: str, value: Any, message: str) -> None:
    with pytest.raises(ValueError, match=f"^{message}"):
        VectorCarEnv(**{name: value})


def test_bad_actions_and_masks_of_a_vector_are_refused() -> None:
    cars = VectorCarEnv(2)
    with pytest.raises(ValueError, match="reset must be called before step"):
        cars.step(np.array([1, 1]))
    cars.reset(seed=1)
    for actions in ([1], [1, 3], [-1, 0], [1.0, 2.0]):
        with pytest.raises(ValueError, match=r"^actions must be "):
            cars.step(np.array(actions))
    for mask in ([True, False], np.array([1, 0]), np.array([False, False])):
        with pytest.raises(ValueError, match=r"^reset_mask must be a bool array"):
            cars.reset(options={"reset_mask": mask})
    with pytest.raises(ValueError, match=r"^seed must be a number or 2 of them"):
        cars.reset(seed=[1, 2, 3])


# Names


@pytest.mark.parametrize("order", ["envs, gymnasium, pettingzoo", "gymnasium, pettingzoo, envs"])
def test_the_names_are_known_in_whatever_order_is_imported(order: str) -> None:
    pytest.importorskip("pettingzoo", "1.27", reason="PettingZoo has names since 1.27")
    code = (
        f"import {order}\n"
        "print(gymnasium.make('arena/MountainCar-v0').unwrapped.__class__.__name__)\n"
        "print(type(pettingzoo.make('parallel', 'arena/mountain_car_v0', cars=3)).__module__)\n"
        "print(pettingzoo.make('aec', 'arena/mountain_car_v0', cars=3).possible_agents)\n"
    )
    done = subprocess.run(
        [sys.executable, "-W", "error::UserWarning", "-c", code],
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    assert done.stdout.splitlines() == [
        "SingleCarEnv",
        "envs.mountain_car_v0",
        "['car_0', 'car_1', 'car_2']",
    ]


def test_to_import_the_hill_imports_neither_package() -> None:
    code = "import sys, envs; print({'gymnasium', 'pettingzoo', 'numba', 'PIL'} & set(sys.modules))"
    command = [sys.executable, "-c", code]
    told = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60).stdout
    assert told == "set()\n"
