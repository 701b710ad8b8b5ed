"""Policies from elsewhere race here, and agents from here drive elsewhere."""

import pickle
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from numpy.typing import NDArray

from agents import MomentumAgent, QLearning, Sarsa
from agents.baselines import XiaoAgent
from arena import Entrant, Evaluation, Policy, PolicyAgent, Results, Tournament, Training, load_plugin, run
from arena.execution.runner import preview
from arena.testing import check_agent
from envs import mountain_car_v0


class Model:
    """As one of Stable-Baselines3, which thrusts right where it is faster than a threshold, else left."""

    def __init__(self, threshold: float = 0.0) -> None:
        self.threshold = threshold

    def predict(
        self, observation: Any, state: Any = None, episode_start: Any = None, deterministic: bool = False
    ) -> tuple[NDArray[np.int64], Any]:
        assert isinstance(observation, np.ndarray)
        assert observation.dtype == np.float32
        if not deterministic:
            return np.array(np.random.randint(3)), state  # noqa: NPY002 (as theirs does)
        return np.where(observation[..., 1] >= self.threshold, 2, 0), state


def raising(observation: Any) -> int:
    raise RuntimeError("out of memory")


def raising_now_and_then(observation: Any) -> int:
    if observation[1] > 0.01:
        raise RuntimeError("too fast")
    return 2 if observation[1] >= 0.0 else 0


def beyond(observation: Any) -> int:
    return 3


class Alternating:
    """Remembers what it did."""

    last = 0

    def __call__(self, observation: Any) -> int:
        self.last = 2 - self.last
        return self.last


def tournament(*policies: Callable[..., Any], **parameters: Any) -> Tournament:
    entrants = (Entrant(f"model {n}", PolicyAgent.of(one), **parameters) for n, one in enumerate(policies))
    others = (Entrant("q-learning", QLearning, bins=(8, 9)), Entrant("momentum", MomentumAgent))
    return Tournament((*entrants, *others), training=Training(5, 200), evaluation=Evaluation(4), replicates=2)


def bits(results: Results) -> dict[tuple[str, int, str], bytes]:
    return {
        (one["entrant"], one["replicate"], name): array.tobytes()
        for one in results.runs
        for name, array in results.arrays(one["entrant"], one["replicate"]).items()
    }


def test_a_model_races_beside_others_on_any_number_of_workers() -> None:
    raced = tournament(Model().predict, lambda seen: 2 * int(seen[1] >= 0.0))
    here, there = (run(raced, n_jobs=jobs, driver="pettingzoo") for jobs in (1, 2))
    with here as one, there as two:
        assert bits(one) == bits(two)
        for replicate in (0, 1):
            expected = two.arrays("momentum", replicate)["test_lengths"]
            for name in ("model 0", "model 1"):  # they do what the momentum agent does
                assert np.array_equal(two.arrays(name, replicate)["test_lengths"], expected)
        frame = two.frame().set_index("entrant")
        assert len(set(frame["fingerprint"].dropna())) == 1


def test_runs_of_another_policy_are_not_those_of_this_one(tmp_path: Path) -> None:
    out, reports = tmp_path / "race.sqlite", list[tuple[int, int]]()
    run(tournament(Model().predict), out, n_jobs=1, driver="pettingzoo").close()
    same = tournament(Model(0.0).predict)  # another object
    run(same, out, n_jobs=1, driver="pettingzoo", progress=lambda *report: reports.append(report)).close()
    assert reports == [(6, 6)]
    plan = preview(tournament(Model(0.01).predict), out)
    assert plan.sentence == "keeps 4 runs, puts 2 aside, runs 2: 2 of 'model 0', whose parameters changed"


def test_a_fingerprint_that_is_given_lets_no_other_policy_race() -> None:
    known = PolicyAgent.of(Model().predict)().fingerprint()
    assert tournament(Model().predict, fingerprint=known).entrants[0].parameters == {"fingerprint": known}
    with pytest.raises(ValueError, match=f"entrant 'model 0': fingerprint must be .* got '{known}'"):
        run(tournament(Model(0.01).predict, fingerprint=known), n_jobs=1)


@pytest.mark.parametrize(
    ("policy", "reason"),
    [
        (raising, "RuntimeError: out of memory"),
        (raising_now_and_then, "RuntimeError: too fast"),
        (beyond, "ValueError: action must be less than 3, got 3"),
    ],
)
def test_a_policy_that_fails_fails_alone(policy: Callable[..., Any], reason: str) -> None:
    with run(tournament(policy), n_jobs=1, driver="pettingzoo") as results:
        told = {one["entrant"]: one.get("error", "") for one in results.runs}
    assert told.pop("model 0").strip().endswith(reason)
    assert told == {"q-learning": "", "momentum": ""}


@pytest.mark.parametrize(
    ("policy", "problem"),
    [
        (Model(), "policy must be callable, such as model.predict, got <.*Model object"),
        (lambda seen: np.array([0, 2]), r"policy must return one action, an integer, got array\(\[0, 2\]\)"),
        (lambda seen: 1.0, "policy must return one action, an integer, got 1.0"),
        (lambda seen: None, "policy must return one action, an integer, got None"),
        (lambda seen: (2, "h"), "policy must go by the observation alone, got one with a state: 'h'"),
        (lambda seen: np.random.randint(3), "policy must do the same at the same place, got one with chance"),  # noqa: NPY002
        (Alternating(), "policy must do the same at the same place, got one with chance or a memory"),
    ],
)
def test_what_is_no_policy_is_told_at_once(policy: Any, problem: str) -> None:
    with pytest.raises((TypeError, ValueError), match=problem):
        PolicyAgent.of(policy)


def test_without_a_policy_it_cannot_race() -> None:
    with pytest.raises(TypeError, match=r"entrant 'none': policy must be callable, .* got None"):
        run(Tournament((Entrant("none", PolicyAgent),)), n_jobs=1)


@pytest.mark.parametrize("action", [2, np.int8(2), np.array(2), np.array([2]), (np.array(2), None)])
def test_an_action_is_an_integer_of_any_kind(action: Any) -> None:
    assert PolicyAgent.of(lambda seen: action)().greedy((-0.5, 0.0)) == 2


def test_a_policy_may_be_a_method_of_a_plugin(tmp_path: Path) -> None:
    file = tmp_path / "swing.py"
    file.write_text(
        "from arena import PolicyAgent\n\n\nclass Swing(PolicyAgent):\n    gain = 2\n\n"
        "    def policy(self, observation):\n        return self.gain * int(observation[1] >= 0.0)\n"
    )
    swing = load_plugin(file)["swing"]
    check_agent(swing)
    raced = Tournament((Entrant("swing", swing),), training=Training(2, 200), evaluation=Evaluation(4))
    with run(raced, n_jobs=2) as results:
        assert results.trained("swing", 1).policy((0.0, 0.01)) == 2
        assert results.runs[0]["parameters"] == {
            "fingerprint": PolicyAgent.of(Model().predict)().fingerprint()
        }


LIMIT = 300


@pytest.fixture(scope="module")
def results() -> Iterator[Results]:
    entrants = (
        Entrant("sarsa", Sarsa, bins=(8, 9)),
        Entrant("xiao", XiaoAgent),
        Entrant("momentum", MomentumAgent),
    )
    raced = Tournament(entrants, training=Training(100, 1000), evaluation=Evaluation(6, LIMIT), replicates=1)
    with run(raced, driver="pettingzoo", n_jobs=1) as found:
        yield found


@pytest.mark.parametrize("entrant", ["sarsa", "xiao", "momentum"])
def test_elsewhere_it_takes_the_steps_that_it_took_in_the_test(results: Results, entrant: str) -> None:
    trained = results.trained(entrant)
    policy = pickle.loads(pickle.dumps(trained.policy))  # noqa: S301 (our own)
    steps, starts = trained.test_lengths.tolist(), trained.starts.tolist()
    assert min(steps) < LIMIT
    assert [alone(policy, start) for start in starts] == steps
    assert in_a_vector(policy, starts) == steps
    assert in_parallel(policy, starts) == steps


def alone(policy: Policy, start: float) -> int:
    """Steps in Gymnasium's own environment."""
    env = gymnasium.make("MountainCar-v0", max_episode_steps=LIMIT)
    observation, _ = env.reset(options={"low": start, "high": start})
    steps, ended = 0, False
    while not ended:
        action = policy(observation)
        assert type(action) is int
        observation, _, terminated, truncated, _ = env.step(action)
        steps, ended = steps + 1, terminated or truncated
    env.close()
    return steps


def in_a_vector(policy: Policy, starts: list[float]) -> list[int]:
    env = gymnasium.make_vec("envs:arena/MountainCar-v0", num_envs=len(starts), max_episode_steps=LIMIT)
    env.reset(seed=0)
    for car, start in enumerate(starts):
        only = np.arange(len(starts)) == car
        observations, _ = env.reset(options={"start": (start, 0.0), "reset_mask": only})
    steps, driving = np.zeros(len(starts), np.int64), np.ones(len(starts), np.bool_)
    while driving.any():
        actions, state = policy.predict(observations)
        assert actions.shape == (len(starts),)
        assert actions.dtype == np.int64
        assert state is None
        observations, _, terminated, truncated, _ = env.step(actions)
        steps += driving
        driving &= ~(terminated | truncated)
    env.close()
    return steps.tolist()


def in_parallel(policy: Policy, starts: list[float]) -> list[int]:
    env = mountain_car_v0.parallel_env(len(starts), max_steps=LIMIT)
    at = {f"car_{car}": (start, 0.0) for car, start in enumerate(starts)}
    observations, _ = env.reset(seed=0, options={"start": at})
    steps = dict.fromkeys(at, 0)
    while env.agents:
        steps |= {car: steps[car] + 1 for car in env.agents}
        observations, *_ = env.step(policy({car: observations[car] for car in env.agents}))
    return list(steps.values())


def test_it_predicts_as_models_of_stable_baselines3_do(results: Results) -> None:
    policy = results.trained("momentum").policy
    action, state = policy.predict(
        np.array([-0.5, 0.01], np.float32), state="h", episode_start=np.array([True])
    )
    assert action.dtype == np.int64
    assert action.shape == ()
    assert (int(action), state) == (2, "h")
    assert policy.predict(np.zeros((0, 2)), deterministic=False)[0].shape == (0,)
    assert PolicyAgent.of(policy.predict)().greedy((-0.5, -0.01)) == 0  # and so it races here
    for wrong in (0.0, [0.0, 0.0, 0.0], [[0.0], [0.0]], np.zeros((1, 2, 2))):
        with pytest.raises(
            ValueError, match=r"observation must be of shape \(2,\) or \(cars, 2\), got shape"
        ):
            policy(wrong)
