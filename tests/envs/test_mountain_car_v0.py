import copy
import math
import pickle
import re
import warnings
from typing import Any

import numpy as np
import pytest
from gymnasium.utils import EzPickle

from envs import Hill, mountain_car_v0
from envs.mountain_car_v0 import Observation, env, parallel_env, raw_env

Trajectory = list[dict[str, bytes]]


@pytest.fixture(scope="module")
def pettingzoo_tests() -> Any:
    with warnings.catch_warnings():
        # PettingZoo's tests import one of its own games in the way that PettingZoo has deprecated.
        warnings.simplefilter("ignore", DeprecationWarning)
        import pettingzoo.test

    return pettingzoo.test


def exactly(observations: dict[str, Observation]) -> dict[str, bytes]:
    return {car: observation.tobytes() for car, observation in observations.items()}


def drive(cars: parallel_env, steps: int, seed: int | None = None, **options: Any) -> Trajectory:
    """What each car observes in an episode in which its actions depend on the step alone."""
    start = exactly(cars.reset(seed, options)[0])
    return [start] + [exactly(cars.step(dict.fromkeys(cars.agents, s // 7 % 3))[0]) for s in range(steps)]


# PettingZoo's own tests


@pytest.mark.parametrize("cars", [1, 2, 5])
def test_passes_the_parallel_api_test(pettingzoo_tests: Any, cars: int) -> None:
    pettingzoo_tests.parallel_api_test(parallel_env(cars), num_cycles=1000)


@pytest.mark.parametrize("make", [env, raw_env])
def test_passes_the_api_test(pettingzoo_tests: Any, make: Any) -> None:
    pettingzoo_tests.api_test(make(cars=3), num_cycles=1000)


def test_passes_the_seed_tests(pettingzoo_tests: Any) -> None:
    pettingzoo_tests.parallel_seed_test(parallel_env)
    pettingzoo_tests.seed_test(env)


def test_passes_the_max_cycles_test(pettingzoo_tests: Any) -> None:
    pettingzoo_tests.max_cycles_test(mountain_car_v0)


# Seeds


def test_seed_reproduces_this_and_the_following_episodes_which_differ() -> None:
    one, other = parallel_env(), parallel_env()
    drive(other, 3)  # what happened before the seed does not matter
    episodes = [drive(one, 50, 7), drive(one, 50), drive(one, 50)]
    assert [drive(other, 50, 7), drive(other, 50), drive(other, 50)] == episodes
    assert len({repr(episode) for episode in episodes}) == 3
    assert drive(one, 50, 8) not in episodes


def test_environments_without_a_seed_differ() -> None:
    assert drive(parallel_env(), 0) != drive(parallel_env(), 0)


def test_car_does_not_depend_on_which_others_there_are_nor_on_their_order() -> None:
    all_three, swapped, alone = (parallel_env(cars) for cars in (["a", "b", "c"], ["c", "b"], ["b"]))
    for seed in (7, None, None):
        expected = [seen["b"] for seen in drive(all_three, 50, seed)]
        for others in (swapped, alone):
            assert [seen["b"] for seen in drive(others, 50, seed)] == expected


def test_cars_start_together_only_if_asked_to() -> None:
    together, apart = parallel_env(3, same_start=True), parallel_env(3)
    for seed in (7, None):
        assert len(set(drive(together, 0, seed)[0].values())) == 1
        assert len(set(drive(apart, 0, seed)[0].values())) == 3
    assert drive(together, 0) != drive(together, 0)


# Endings


def test_end_is_told_as_termination_at_the_goal_else_as_truncation_never_as_both() -> None:
    def last_step(max_steps: int) -> tuple[int, dict[str, bool], dict[str, bool]]:
        cars = parallel_env(1, max_steps=max_steps)
        observations, _ = cars.reset(seed=1)
        steps = 0
        while cars.agents:
            action = 2 if observations["car_0"][1] >= 0.0 else 0
            observations, _, terminations, truncations, _ = cars.step({"car_0": action})
            steps += 1
        return steps, terminations, truncations

    needed, *_ = last_step(1000)
    assert needed < 1000
    assert last_step(needed + 1) == (needed, {"car_0": True}, {"car_0": False})
    assert last_step(needed) == (needed, {"car_0": True}, {"car_0": False})
    assert last_step(needed - 1) == (needed - 1, {"car_0": False}, {"car_0": True})


def test_cars_leave_as_they_end_in_order_and_the_last_are_truncated_together() -> None:
    cars = parallel_env(["tardy", "first", "never", "after"], max_steps=30)
    starts = {"tardy": (-0.5, 0.0), "first": (0.45, 0.07), "never": (-0.5, 0.0), "after": (0.0, 0.07)}
    cars.reset(options={"start": starts})
    told: dict[int, list[str]] = {}
    steps = 0
    while cars.agents:
        live = list(cars.agents)
        observations, rewards, terminations, truncations, infos = cars.step(dict.fromkeys(live, 2))
        steps += 1
        for answer in (observations, rewards, terminations, truncations, infos):
            assert list(answer) == live
        assert rewards == dict.fromkeys(live, -1.0)
        assert not any(truncations.values()) or steps == 30
        assert cars.agents == [car for car in live if not terminations[car] and not truncations[car]]
        told[steps] = [car for car in live if car not in cars.agents]
    assert [gone for gone in told.values() if gone] == [["first"], ["after"], ["tardy", "never"]]
    assert cars.possible_agents == list(starts)
    assert cars.step({}) == ({}, {}, {}, {}, {})
    assert list(cars.reset()[0]) == list(starts) == cars.agents
    assert not any(cars.step(dict.fromkeys(starts, 1))[3].values())  # the time begins anew


# Observations


def test_observations_are_the_exact_states_of_the_hill_in_their_space() -> None:
    hill = Hill(friction=5.0, integrator="explicit", min_position=-1.0)
    cars, rng = parallel_env(2, hill, 500), np.random.default_rng(1)
    observations, _ = cars.reset(seed=1)
    states = {car: (float(position), float(velocity)) for car, (position, velocity) in observations.items()}
    while cars.agents:
        actions: dict[str, Any] = {car: rng.integers(3) for car in cars.agents}  # any kind of integer
        observations, _, terminations, _, _ = cars.step(actions)
        for car, action in actions.items():
            states[car], _, reached = hill.step(states[car], int(action))
            assert observations[car].dtype == np.float64
            assert observations[car].tobytes() == np.array(states[car]).tobytes()
            assert cars.observation_space(car).contains(observations[car])
            assert terminations[car] == reached


def test_observations_are_nobody_elses() -> None:
    cars = parallel_env(same_start=True)
    untouched = drive(cars, 10, 7)
    kept, _ = cars.reset(seed=7)
    for step in range(10):
        kept["car_0"][:] = np.nan
        assert not np.isnan(kept["car_1"]).any()
        before = exactly(kept)
        observations, *_ = cars.step({"car_0": step // 7 % 3, "car_1": step // 7 % 3})
        assert exactly(observations) == untouched[step + 1]
        assert exactly(kept) == before
        kept = observations


def test_spaces_are_those_of_the_hill() -> None:
    cars = parallel_env(["a"], Hill(min_position=-1.0, max_velocity=0.05))
    space: Any = cars.observation_space("a")
    actions: Any = cars.action_space("a")
    assert (space.low.tolist(), space.high.tolist()) == ([-1.0, -0.07], [0.6, 0.05])
    assert (actions.n, actions.start) == (3, 0)


# Arguments


def test_cars_are_numbered_or_named() -> None:
    assert parallel_env(3).possible_agents == ["car_0", "car_1", "car_2"]
    assert parallel_env(name for name in ("x", "a")).possible_agents == ["x", "a"]


@pytest.mark.parametrize("same_start", [False, True])
def test_start_may_be_given_for_some_cars(same_start: bool) -> None:
    cars = parallel_env(same_start=same_start)
    drawn, _ = cars.reset(seed=7)
    observations, _ = cars.reset(seed=7, options={"start": {"car_1": (0.1, -0.02)}})
    assert observations["car_1"].tolist() == [0.1, -0.02]
    assert observations["car_0"].tolist() == drawn["car_0"].tolist()
    assert cars.step({"car_0": 1, "car_1": 2})[0]["car_1"].tolist() == [*Hill().step((0.1, -0.02), 2)[0]]


def test_car_with_a_given_start_draws_nothing() -> None:
    cars = parallel_env(1)
    first, second = drive(cars, 0, 7), drive(cars, 0)
    assert drive(cars, 0, 7, start={"car_0": (0.0, 0.0)}) != first
    assert [drive(cars, 0), drive(cars, 0)] == [first, second]


@pytest.mark.parametrize(
    ("start", "message"),
    [
        ({"car_9": (0.0, 0.0)}, "start must give cars of .*'car_0', 'car_1'.*car_9"),
        ([0.0, 0.0], "start must give cars"),
        ({"car_1": (-1.3, 0.0)}, "start position of car_1 must be in .*-1.3"),
        ({"car_1": (0.51, 0.0)}, "start position of car_1 must be in .*0.51"),
        ({"car_1": (math.nan, 0.0)}, "start position of car_1 must be in .*nan"),
        ({"car_1": (0.0, 0.08)}, "start velocity of car_1 must be in .*0.08"),
        ({"car_1": (0.0, None)}, "start velocity of car_1 must be a number, got None"),
    ],
)
def test_bad_start_is_refused_and_changes_nothing(start: Any, message: str) -> None:
    cars, untouched = parallel_env(), parallel_env()
    drive(cars, 5, 7), drive(untouched, 5, 7)
    with pytest.raises((TypeError, ValueError), match=message):
        cars.reset(seed=9, options={"start": start})
    assert drive(cars, 5) == drive(untouched, 5)


@pytest.mark.parametrize("bad", [3, -1, 0.5, None, "x", "missing"])
def test_bad_action_is_refused_by_the_cars_name_and_nothing_moves(bad: Any) -> None:
    cars = parallel_env(max_steps=2)
    observations, _ = cars.reset(seed=7)
    actions = {"car_0": 2, "car_1": bad}
    if bad == "missing":
        del actions["car_1"]
    with pytest.raises((TypeError, ValueError), match="car_1"):
        cars.step(actions)
    moved, _, _, truncations, _ = cars.step({"car_0": 2, "car_1": 0})
    for car, action in (("car_0", 2), ("car_1", 0)):
        position, velocity = observations[car].tolist()
        assert moved[car].tolist() == [*Hill().step((position, velocity), action)[0]]
    assert not any(truncations.values())  # the refused step did not count either


@pytest.mark.parametrize(
    ("error", "name", "bad"),
    [(ValueError, "cars", bad) for bad in (0, [], ["a", "a"], ["a", ""], ["a", 1])]
    + [(TypeError, "cars", bad) for bad in (1.5, True, "car_0", None)]
    + [(ValueError, "max_steps", 0), (TypeError, "max_steps", 1.5), (ValueError, "render_mode", "film")],
)
def test_bad_argument_is_refused_by_name_and_value(error: type[Exception], name: str, bad: Any) -> None:
    with pytest.raises(error, match=rf"^{name} must .*, got {re.escape(repr(bad))}$"):
        parallel_env(**{name: bad})


@pytest.mark.parametrize(("error", "seed"), [(ValueError, -1), (TypeError, 1.5), (TypeError, "7")])
def test_bad_seed_is_refused(error: type[Exception], seed: Any) -> None:
    with pytest.raises(error, match=f"seed must be .*{seed}"):
        parallel_env().reset(seed)


# Copies


def test_the_arguments_are_kept_as_pettingzoo_s_environments_keep_them() -> None:
    cars = parallel_env((name for name in "ab"), max_steps=7)  # names that can be gone through once
    assert isinstance(cars, EzPickle)
    again = pickle.loads(pickle.dumps(cars))  # noqa: S301
    assert drive(parallel_env(*again._ezpickle_args, **again._ezpickle_kwargs), 7, 1) == drive(cars, 7, 1)


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda cars: pickle.loads(pickle.dumps(cars))])  # noqa: S301
def test_copy_of_a_running_environment_goes_on_the_same(copied: Any) -> None:
    cars = parallel_env(["a", "b"], max_steps=20)
    drive(cars, 5, 7)
    other = copied(cars)
    assert other.agents == cars.agents
    actions = {"a": 2, "b": 0}
    assert exactly(other.step(actions)[0]) == exactly(cars.step(actions)[0])
    assert drive(other, 20) == drive(cars, 20)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: make_cars(hill=3), "hill must be a Hill, got 3"),
        (lambda: make_cars(same_start="no"), "same_start must be a bool, got 'no'"),
        (lambda: make_cars().reset(options={"start": {"car_0": 1}}), "start of car_0 must be .* got 1"),
        (
            lambda: make_cars().reset(options={"start": {"car_0": (1,)}}),
            r"start of car_0 must be .* got \(1,\)",
        ),
    ],
)
def test_each_message_names_what_was_wrong(make: Any, message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=message):
        make()


def make_cars(**arguments: Any) -> Any:
    return parallel_env(**arguments)


# Many cars in one loop


def test_many_cars_drive_as_each_would_alone() -> None:
    names = [f"car_{number}" for number in range(11)]
    together = parallel_env(names, max_steps=60)
    alone = {name: parallel_env([name], max_steps=60) for name in names}
    options = {"start": {"car_1": (0.4, 0.05), "car_5": (0.45, 0.06)}}  # two are there before the others
    for seed in (3, None):
        first = together.reset(seed, options)[0]
        for name, car in alone.items():
            mine = {"start": {name: options["start"][name]}} if name in options["start"] else {}
            assert car.reset(seed, mine)[0][name].tobytes() == first[name].tobytes()
        lengths: set[int] = set()
        while together.agents:
            actions = {car: np.int64((number + len(lengths)) % 3) for number, car in enumerate(names)}
            before = list(together.agents)
            answers = together.step({car: int(actions[car]) for car in together.agents})
            for name in before:
                single = alone[name].step({name: int(actions[name])})
                assert answers[0][name].tobytes() == single[0][name].tobytes()
                assert [part[name] for part in answers[1:4]] == [part[name] for part in single[1:4]]
                assert [type(part[name]) for part in answers[1:4]] == [float, bool, bool]
            lengths.add(len(together.agents))
        assert len(lengths) == 3


def test_observations_of_many_cars_are_arrays_of_their_own() -> None:
    cars = parallel_env(8, max_steps=5)
    first, _ = cars.reset(seed=1)
    after = cars.step(dict.fromkeys(cars.agents, 1))[0]
    kept = {car: observation.copy() for car, observation in after.items()}
    after["car_0"][:] = 7.0
    first["car_1"][:] = 7.0
    again = cars.step(dict.fromkeys(cars.agents, 1))[0]
    for car in cars.agents:
        assert again[car].tolist() == list(Hill().step(tuple(kept[car].tolist()), 1)[0])


def test_a_copy_of_many_cars_goes_on_the_same() -> None:
    cars = parallel_env(8)
    drive(cars, 5, 7)
    copied = pickle.loads(pickle.dumps(cars))  # noqa: S301
    actions = dict.fromkeys(cars.agents, 2)
    assert exactly(copied.step(actions)[0]) == exactly(cars.step(actions)[0])


class Potholes(Hill):
    """A hill whose step no compiler understands, and that breaks at one place."""

    __slots__ = ()

    def step(self, state: Any, action: int) -> Any:
        if state[0] > 0.3:
            raise ArithmeticError("a pothole")
        return Hill.step(self, *[state, action][:2])  # numba has no such lists


def test_hill_beyond_the_compiler_is_interpreted_and_goes_on_after_its_own_error() -> None:
    odd, plain = parallel_env(2, Potholes()), parallel_env(2)
    assert drive(odd, 20, 7) == drive(plain, 20, 7)
    odd.reset(options={"start": {"car_1": (0.31, 0.0)}})
    for _ in range(2):
        with pytest.raises(ArithmeticError, match="a pothole"):
            odd.step({"car_0": 1, "car_1": 1})
    assert drive(odd, 20, 7) == drive(plain, 20, 7)
