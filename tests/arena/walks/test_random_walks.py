"""Random walks on the hill: the paper's Algorithm 1, to the bit whatever runs it."""

import json
import math
import shutil
import subprocess
import sys
from typing import Any

import joblib
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from paths import ROOT

from arena import InterruptedWalk, RandomWalk, random_walk
from envs import Hill
from envs.foundation.streams import stream

SCRIPTS = ROOT / "scripts"
NEAR = Hill(goal_position=-0.35)
"""A hill with short walks."""


def algorithm_1(episodes: int, hill: Hill, seed: int, max_steps: int = 10**6) -> RandomWalk:
    """The paper's lines, one after the other."""
    lengths, reached = [], []
    least_x = most_x = least_v = most_v = 0.0
    for episode in range(episodes):
        rng, count, done = stream(seed, "walk", str(episode)), 0, False
        state = hill.reset(rng)
        while not done and count < max_steps:
            state, _, done = hill.step(state, int(rng.random() * 3))
            least_x, most_x = min(least_x, state[0]), max(most_x, state[0])
            least_v, most_v = min(least_v, state[1]), max(most_v, state[1])
            count += 1
        lengths.append(count)
        reached.append(done)
    bounds = (least_x, most_x), (least_v, most_v)
    return RandomWalk(hill, seed, max_steps, np.array(lengths), np.array(reached), *bounds)


def same(one: RandomWalk, other: RandomWalk) -> bool:
    return one.to_dict() == other.to_dict()


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("episodes", [1, 2, 3, 26, 60])
def test_walks_are_those_of_algorithm_1(episodes: int, compiled: bool) -> None:
    expected = algorithm_1(episodes, NEAR, seed=3)
    assert same(random_walk(episodes, NEAR, 3, n_jobs=1, compiled=compiled), expected)
    assert expected.lengths.max() > 100


@given(
    st.fixed_dictionaries(
        {
            "goal_position": st.floats(-0.39, 0.5),
            "friction": st.sampled_from([0.0, 30.0]),
            "min_position": st.sampled_from([-1.2, -0.7]),
            "integrator": st.sampled_from(["semi-implicit", "explicit"]),
            "dynamics": st.sampled_from(["simplified", "constrained"]),
        }
    ),
    st.integers(1, 6),
    st.integers(1, 300),
)
@settings(max_examples=40, deadline=None)
def test_walks_on_any_hill_are_those_of_algorithm_1(
    constants: dict[str, Any], episodes: int, max_steps: int
) -> None:
    hill = Hill(**constants)
    expected = algorithm_1(episodes, hill, 5, max_steps)
    assert same(random_walk(episodes, hill, 5, n_jobs=1, max_steps=max_steps), expected)


def test_the_bits_are_the_same_for_any_workers() -> None:
    alone = random_walk(130, NEAR, 1, n_jobs=1)
    assert same(random_walk(130, NEAR, 1, n_jobs=2), alone)
    with joblib.parallel_config(backend="threading"):
        assert same(random_walk(130, NEAR, 1, n_jobs=3), alone)
    assert not same(random_walk(130, NEAR, 2, n_jobs=1), alone)


def test_a_shorter_series_is_the_beginning_of_a_longer_one() -> None:
    longer = random_walk(60, NEAR, n_jobs=1)
    assert random_walk(31, NEAR, n_jobs=1).lengths.tolist() == longer.lengths[:31].tolist()


def test_a_car_without_engine_on_flat_ground_stays_until_the_limit() -> None:
    found = random_walk(30, Hill(thrust=0.0, gravity=0.0), n_jobs=1, max_steps=40)
    assert found.lengths.tolist() == [40] * 30
    assert not found.reached.any()
    assert found.velocity == (0.0, 0.0)
    assert -0.6 <= found.position[0] < -0.5
    assert found.position[1] == 0.0


def test_a_goal_at_the_limit_is_reached() -> None:
    # A velocity of 1/128 after the first step, whatever the action; the goal is three steps away.
    hill = Hill(
        thrust=0.0, gravity=1 / 1024, omega=math.pi, min_start=-1.0, max_start=-1.0, goal_position=-0.9
    )
    expected = algorithm_1(1, hill, 0)
    steps = int(expected.lengths[0])
    assert random_walk(1, hill, n_jobs=1, max_steps=steps).reached.all()
    given_up = random_walk(1, hill, n_jobs=1, max_steps=steps - 1)
    assert given_up.lengths.tolist() == [steps - 1]
    assert not given_up.reached.any()


def test_progress_is_told_and_what_was_finished_survives_an_interruption() -> None:
    told: list[tuple[int, int]] = []
    random_walk(60, NEAR, n_jobs=1, progress=lambda done, total: told.append((done, total)))
    assert told == [(25, 60), (50, 60), (60, 60)]

    def interrupt(done: int, _: int) -> None:
        if done == 50:
            raise KeyboardInterrupt

    with pytest.raises(InterruptedWalk, match=r"^interrupted after 50 of 60 episodes$") as stopped:
        random_walk(60, NEAR, n_jobs=1, progress=interrupt)
    assert same(stopped.value.walk, random_walk(50, NEAR, n_jobs=1))


def test_after_an_interruption_no_episode_is_missing_among_those_that_are_left() -> None:
    # Without an engine a car that starts near the bottom never climbs out. Of the first 75 episodes only the
    # 40th is such a one, so that the 26th to the 50th are finished long after the others.
    goal = -math.pi / 6 + 0.0005
    hill = Hill(thrust=0.0, min_start=-0.7, max_start=goal, goal_position=goal)

    def interrupt(done: int, _: int) -> None:
        if done == 50:
            raise KeyboardInterrupt

    with joblib.parallel_config(backend="threading"), pytest.raises(InterruptedWalk) as stopped:
        random_walk(75, hill, 15, n_jobs=2, max_steps=4_000_000, progress=interrupt)
    assert same(stopped.value.walk, random_walk(25, hill, 15, n_jobs=1, max_steps=4_000_000))


@pytest.mark.parametrize(
    ("error", "message", "arguments"),
    [
        (ValueError, "episodes must be at least 1, got 0", {"episodes": 0}),
        (TypeError, "episodes must be an integer, got 1.5", {"episodes": 1.5}),
        (TypeError, "hill must be a Hill, got 'steep'", {"hill": "steep"}),
        (ValueError, "seed must be at least 0, got -1", {"seed": -1}),
        (ValueError, "max_steps must be at least 1, got 0", {"max_steps": 0}),
        (ValueError, "n_jobs must not be 0: give a number of workers, or -1 for one a core", {"n_jobs": 0}),
        (TypeError, "n_jobs must be an integer, got None", {"n_jobs": None}),
    ],
)
def test_bad_arguments_are_refused(error: type[Exception], message: str, arguments: dict[str, Any]) -> None:
    with pytest.raises(error) as refused:
        random_walk(**arguments)
    assert str(refused.value) == message


@pytest.mark.statistical
def test_twenty_thousand_walks_are_42_300_steps_long_on_average() -> None:
    lengths = random_walk(20_000, seed=6).lengths
    assert abs(lengths.mean() - 42_300) <= 2 * lengths.std() / math.sqrt(len(lengths))


@pytest.mark.timing
@pytest.mark.skipif(not (shutil.which("gcc") or shutil.which("cc")), reason="needs a C compiler")
def test_the_walks_keep_up_with_a_loop_in_c() -> None:
    command = [sys.executable, str(SCRIPTS / "bench_walk.py"), "--json", "--episodes", "500", "--part", "2"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert json.loads(done.stdout)["C / ours"] >= 1 / 1.2
