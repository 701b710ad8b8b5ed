import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import pytest
from bits import bits_of
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from agents import Grid, HarmonicRate, LinearDecay, Sarsa
from agents.algorithms.linear import epsilon_greedy_of
from agents.algorithms.sarsa_lambda import SarsaLambda
from agents.algorithms.semi_gradient_sarsa import SemiGradientSarsa
from agents.algorithms.true_online_sarsa import TrueOnlineSarsa
from agents.algorithms.watkins_q_lambda import WatkinsQLambda
from agents.discretization import TileCoding
from agents.learning.traces import NEGLIGIBLE
from arena import Entrant, Evaluation, Tournament, Training, run
from arena.execution.loops import TrainingLoop, episode_hook, train
from envs import Hill
from envs.compilation import cache_directory, compile_loop
from envs.compilation.reachable import ReachableCode

Floats = NDArray[np.float64]
Step = tuple[Any, int, float, Any, int, bool]  # the arguments of ``learn``
CLASSES = [SemiGradientSarsa, SarsaLambda, TrueOnlineSarsa, WatkinsQLambda]
SETTINGS: list[tuple[type[Any], dict[str, Any]]] = [
    (SemiGradientSarsa, {}),
    (SemiGradientSarsa, {"n": 3, "discount": 0.9, "tilings": 3, "tiles": (2, 4)}),
    (SarsaLambda, {}),
    (SarsaLambda, {"traces": "accumulating", "trace_decay": 0.5, "step_size": 0.2}),
    (SarsaLambda, {"clear_others": True, "epsilon": LinearDecay(0.5, 0.1)}),
    (TrueOnlineSarsa, {}),
    (TrueOnlineSarsa, {"bins": (5, 6), "step_size": 1.2, "epsilon": LinearDecay(0.5, 0.1)}),
    (WatkinsQLambda, {"epsilon": LinearDecay(0.3, 0.1)}),
    (WatkinsQLambda, {"traces": "accumulating", "trace_decay": 0.6, "step_size": 0.2, "bins": 6}),
]
NAMES = [f"{cls.__name__} {number}" for number, (cls, _) in enumerate(SETTINGS)]


class Line(NamedTuple):
    """A task with one dimension; with four bins the cells are 0, 1, 2, 3."""

    low: tuple[float, ...] = (0.0,)
    high: tuple[float, ...] = (4.0,)
    n_actions: int = 3


def make(cls: type[Any], **parameters: Any) -> Any:
    """An agent on the line's four cells with step size 1/2 and discount 1/2 unless told."""
    return cls.create(Line(), **{"bins": 4, "step_size": 0.5, "discount": 0.5, **parameters})


def step(cell: int, action: int, reward: float, next_cell: int, next_action: int, end: bool = False) -> Step:
    return (cell + 0.5,), action, reward, (next_cell + 0.5,), next_action, end


def weights(entries: dict[tuple[int, int], float], shape: tuple[int, int] = (4, 3)) -> list[list[float]]:
    table = np.zeros(shape)
    for key, value in entries.items():
        table[key] = value
    return table.tolist()


# What the linear agents share. Two tilings with tiles of length 2 on the line: where x = 1, features 0 and
# 4 are active; where x = 3, features 1 and 5 (see test_tile_coding).


@pytest.mark.parametrize("cls", CLASSES)
def test_error_is_shared_by_the_active_tiles(cls: type[Any]) -> None:
    agent = make(cls, bins=None, tilings=2, tiles=2)
    agent.weights[1, 1], agent.weights[5, 1] = 2.0, 4.0
    agent.begin_episode()
    agent.learn((1.0,), 2, -1.0, (3.0,), 1, False)
    # The value moves by half of the error -1 + 0.5 * (2 + 4) - 0 = 2, each of two weights by a quarter.
    assert agent.weights.tolist() == weights({(0, 2): 0.5, (4, 2): 0.5, (1, 1): 2.0, (5, 1): 4.0}, (6, 3))


@pytest.mark.parametrize("cls", CLASSES)
def test_nothing_follows_the_goal(cls: type[Any]) -> None:
    agent = make(cls)
    agent.weights[1] = [8.0, 8.0, 8.0]
    agent.begin_episode()
    agent.learn(*step(0, 1, -1.0, 1, 0, end=True))
    assert agent.weights.tolist() == weights({(0, 1): -0.5, (1, 0): 8.0, (1, 1): 8.0, (1, 2): 8.0})


@pytest.mark.parametrize("cls", CLASSES)
def test_defaults_are_the_books(cls: type[Any]) -> None:
    agent = cls.create(Hill(max_position=0.5))
    assert agent.features == TileCoding([-1.2, -0.07], [0.5, 0.07], 8, 8)
    assert agent.weights.tolist() == np.zeros((648, 3)).tolist()
    assert (agent.step_size, agent.discount, agent.epsilon) == (0.5 / 8, 1.0, LinearDecay(0.0, 0.0))
    assert cls.create(Hill(), epsilon=0.25).epsilon == LinearDecay(0.25, 0.25)
    assert cls.create(Hill(), bins=(4, 5)).features == Grid.over(Hill(), (4, 5))


@pytest.mark.parametrize("cls", CLASSES)
@pytest.mark.parametrize(
    ("parameter", "bad"),
    [("tilings", 0), *(("tiles", bad) for bad in (0, (8, 8, 8))), *(("bins", bad) for bad in (0, (3,)))]
    + [("step_size", bad) for bad in (0.0, math.inf)]
    + [("discount", 1.1), *(("epsilon", bad) for bad in (-0.1, "0"))],
)
def test_bad_parameter_is_refused_by_name(cls: type[Any], parameter: str, bad: Any) -> None:
    with pytest.raises((TypeError, ValueError), match=f"^{parameter} must "):
        cls.create(Hill(), **{parameter: bad})


@pytest.mark.parametrize(
    ("cls", "parameter", "bad"),
    [(SemiGradientSarsa, "n", 0), (SemiGradientSarsa, "n", 1.0), (SarsaLambda, "clear_others", 1)]
    + [(cls, "trace_decay", 1.01) for cls in CLASSES[1:]]
    + [(cls, "traces", "dutch") for cls in (SarsaLambda, WatkinsQLambda)],
)
def test_bad_parameter_of_its_own_is_refused_by_name(cls: type[Any], parameter: str, bad: Any) -> None:
    with pytest.raises((TypeError, ValueError), match=f"^{parameter} must "):
        cls.create(Hill(), **{parameter: bad})


# The behaviour


@pytest.mark.parametrize(
    ("values", "epsilon", "expected"),
    [
        ([0.0, 0.0, 0.0], 0.0, [1 / 3, 1 / 3, 1 / 3]),
        ([1.0, 0.0, 1.0], 0.0, [1 / 2, 0, 1 / 2]),
        ([0.0, 1.0, 1.0], 0.5, [1 / 6, 5 / 12, 5 / 12]),
        ([0.0, 1.0, 2.0], 0.3, [0.1, 0.1, 0.8]),
    ],
)
def test_behaviour_breaks_ties_at_random(values: list[float], epsilon: float, expected: list[float]) -> None:
    agent, rng = make(SarsaLambda, epsilon=LinearDecay(epsilon, 0.0)), np.random.default_rng(1)
    agent.weights[1] = values
    found = np.bincount([agent.act((1.5,), 0.0, rng) for _ in range(20_000)], minlength=3) / 20_000
    for frequency, p in zip(found, expected):
        assert abs(frequency - p) <= 4 * math.sqrt(p * (1 - p) / 20_000)
    late = {agent.act((1.5,), 1.0, rng) for _ in range(100)}
    assert late == {a for a in range(3) if values[a] == max(values)}


@pytest.mark.parametrize(
    ("values", "best"), [([1, 1, 1], 0), ([0, 1, 1], 1), ([-3, -2, -1], 2), ([2, 1, 2], 0)]
)
@pytest.mark.parametrize("cls", CLASSES)
def test_greedy_takes_the_lowest_of_the_best(cls: type[Any], values: list[float], best: int) -> None:
    agent = make(cls)
    agent.weights[2] = values
    before = agent.weights.copy()
    assert {agent.greedy((2.5,)) for _ in range(20)} == {best}
    assert np.array_equal(agent.weights, before)


@pytest.mark.parametrize(("values", "shares"), [([0], [1]), ([0, 0, 1, 1], [0, 0, 1 / 2, 1 / 2])])
def test_ties_are_counted_anew_for_each_greater_value(values: list[float], shares: list[float]) -> None:
    table, active, rng = np.array([values], float), np.zeros(1, np.int64), np.random.default_rng(1)
    chosen = [epsilon_greedy_of(table, active, 0.0, rng) for _ in range(10_000)]
    assert np.bincount(chosen, minlength=len(values)) / 10_000 == pytest.approx(shares, abs=0.02)


# Semi-gradient Sarsa by hand


def test_two_step_sarsa_learns_one_step_late_from_two_rewards_and_the_value_after_them() -> None:
    agent = make(SemiGradientSarsa, n=2)
    agent.weights[2, 1] = 16.0
    agent.begin_episode()
    agent.learn(*step(0, 0, -1.0, 1, 2))
    assert agent.weights.tolist() == weights({(2, 1): 16.0})
    agent.learn(*step(1, 2, -2.0, 2, 1))
    first = 0.5 * (-1.0 + 0.5 * -2.0 + 0.25 * 16.0)
    assert agent.weights.tolist() == weights({(0, 0): first, (2, 1): 16.0})
    agent.learn(*step(2, 1, -4.0, 3, 0, end=True))
    second, third = 0.5 * (-2.0 + 0.5 * -4.0), 16.0 + 0.5 * (-4.0 - 16.0)
    assert agent.weights.tolist() == weights({(0, 0): first, (1, 2): second, (2, 1): third})


def test_steps_that_wait_at_a_time_limit_are_learned_when_the_next_episode_begins() -> None:
    agent = make(SemiGradientSarsa, n=3)
    agent.weights[2, 1] = 16.0
    agent.begin_episode()
    agent.learn(*step(0, 0, -1.0, 1, 2))
    agent.learn(*step(1, 2, -2.0, 2, 1))
    assert agent.weights.tolist() == weights({(2, 1): 16.0})
    agent.begin_episode()
    first, second = 0.5 * (-1.0 + 0.5 * -2.0 + 0.25 * 16.0), 0.5 * (-2.0 + 0.5 * 16.0)
    assert agent.weights.tolist() == weights({(0, 0): first, (1, 2): second, (2, 1): 16.0})
    agent.begin_episode()  # nothing is left
    assert agent.weights.tolist() == weights({(0, 0): first, (1, 2): second, (2, 1): 16.0})


# Traces by hand, with step size 1/2, discount 1/2 and lambda 1/2: a trace falls to a quarter in a step.


@pytest.mark.parametrize(
    ("traces", "clear_others", "there", "other"),
    [
        # The trace of cell 0, action 0 is 1 + 1/16 or 1, that of action 1 there is 1/4 or removed.
        ("accumulating", False, 1.0625, 0.25),
        ("replacing", False, 1.0, 0.25),
        ("replacing", True, 1.0, 0.0),
    ],
)
def test_sarsa_lambda_moves_weights_by_their_traces(
    traces: str, clear_others: bool, there: float, other: float
) -> None:
    agent = make(SarsaLambda, trace_decay=0.5, traces=traces, clear_others=clear_others)
    agent.begin_episode()
    for visit in (step(0, 0, 0.0, 0, 1), step(0, 1, 0.0, 0, 0), step(0, 0, 8.0, 1, 0)):
        agent.learn(*visit)
    assert agent.weights.tolist() == weights({(0, 0): 4.0 * there, (0, 1): 4.0 * other})


@pytest.mark.parametrize("cls", CLASSES[1:])
def test_no_trace_outlives_its_episode(cls: type[Any]) -> None:
    agent = make(cls)
    for end in (False, True):
        agent.begin_episode()
        agent.learn(*step(0, 0, 0.0, 1, 0, end))
        agent.begin_episode()
        agent.learn(*step(2, 0, 8.0, 3, 0, True))
        assert agent.weights[0].tolist() == [0.0, 0.0, 0.0]
    assert agent.weights[2, 0] == 4.0 + 0.5 * (8.0 - 4.0)


def test_true_online_sarsa_by_hand() -> None:
    agent = make(TrueOnlineSarsa, trace_decay=0.5)
    agent.begin_episode()
    agent.learn(*step(0, 0, 8.0, 0, 0))
    # z = 1, and Q = Q' = Q_old = 0
    assert agent.weights.tolist() == weights({(0, 0): 0.5 * 8.0})
    agent.learn(*step(0, 0, 2.0, 1, 0))
    # z = 1/4 + 1 - 0.5 * 1/4 = 9/8; Q = 4, Q' = 0 and Q_old = 0, so the error is 2 - 4 = -2
    assert agent.weights.tolist() == weights(
        {(0, 0): 4.0 + 0.5 * (-2.0 + 4.0 - 0.0) * 9 / 8 - 0.5 * (4.0 - 0.0)}
    )


@pytest.mark.parametrize(
    ("next_action", "kept"),
    [
        (1, 0.25),  # greedy
        (2, 0.25),  # as good as the best
        (0, 0.0),  # explores: the traces are cut
    ],
)
@pytest.mark.parametrize("traces", ["accumulating", "replacing"])
def test_watkins_cuts_the_traces_after_an_action_that_explores(
    traces: str, next_action: int, kept: float
) -> None:
    agent = make(WatkinsQLambda, trace_decay=0.5, traces=traces)
    agent.weights[1] = [2.0, 4.0, 4.0]
    agent.begin_episode()
    agent.learn(*step(0, 0, -2.0, 1, next_action))  # -2 + 0.5 * 4, the best value, is no error at all
    assert agent.weights[0].tolist() == [0.0, 0.0, 0.0]
    value = agent.weights[1, next_action]
    agent.learn(*step(1, next_action, value + 8.0, 2, 0))  # an error of 8
    assert agent.weights[1, next_action] == value + 4.0
    assert agent.weights[0].tolist() == [4.0 * kept, 0.0, 0.0]


def test_watkins_judges_the_next_action_before_the_update() -> None:
    agent = make(WatkinsQLambda, trace_decay=0.5)
    agent.weights[0] = [4.0, 2.0, 0.0]
    agent.begin_episode()
    # Action 0 is the best when it is chosen; the update itself makes action 1 better.
    agent.learn(*step(0, 0, -8.0, 0, 0))
    assert agent.weights[0].tolist() == [4.0 + 0.5 * (-8.0 + 2.0 - 4.0), 2.0, 0.0]
    assert agent.memory.length[0] == 1


def test_negligible_trace_is_dropped_and_no_other() -> None:
    agent = make(SarsaLambda, trace_decay=0.5)
    steps = math.ceil(math.log(NEGLIGIBLE) / math.log(0.25))
    agent.begin_episode()
    agent.learn(*step(0, 0, 0.0, 1, 0))
    for _ in range(steps - 2):
        agent.learn(*step(1, 0, 0.0, 1, 0))
    assert agent.memory.length[0] == 2
    agent.learn(*step(1, 0, 0.0, 1, 0))
    assert agent.memory.length[0] == 1
    assert agent.memory.positions.tolist() == [-1, -1, -1, 0] + [-1] * 8


# Against the book's boxes, written with vectors as long as the weights


def walks(seed: int, dimensions: int, episodes: int = 12) -> Iterator[list[Step]]:
    """Episodes of random steps between 0 and 4, three of four to a goal, the others to a time limit."""
    rng = np.random.default_rng(seed)
    for _ in range(episodes):
        at, action = rng.uniform(0, 4, dimensions), int(rng.integers(3))
        goes_on, walk = True, []
        while goes_on:
            goes_on, to = rng.random() < 0.95, np.clip(at + rng.normal(0, 0.7, dimensions), 0, 4)
            next_action = int(rng.integers(3))
            end = not goes_on and rng.random() < 0.75
            walk.append((tuple(at), action, float(rng.normal()), tuple(to), next_action, end))
            at, action = to, next_action
        yield walk


class Square(NamedTuple):
    low: tuple[float, ...] = (0.0, 0.0)
    high: tuple[float, ...] = (4.0, 4.0)
    n_actions: int = 3


def learned(agent: Any, seed: int) -> Floats:
    for walk in walks(seed, len(agent.features.low)):
        agent.begin_episode()
        for one in walk:
            agent.learn(*one)
    agent.begin_episode()
    return agent.weights.copy()  # type: ignore[no-any-return]


def vector(agent: Any, observation: Any, action: int) -> Floats:
    """The features of an action: as many as there are weights, 1 where active."""
    x, active = np.zeros_like(agent.weights), np.zeros(agent.features.active, np.int64)
    agent.features.fill(observation, active)
    x[active, action] = 1.0
    return np.ravel(x)


def book_n_step(agent: Any, seed: int, n: int) -> Floats:
    """Box of 10.2; a walk that meets a time limit is learned to its end as if its last value were known."""
    w, gamma = np.zeros(agent.weights.size), agent.discount
    for walk in walks(seed, len(agent.features.low)):
        x = [vector(agent, *one[:2]) for one in walk] + [vector(agent, *walk[-1][3:5])]
        rewards, end = [one[2] for one in walk], walk[-1][5]
        for t in range(len(walk)):
            last = min(t + n, len(walk))
            target = sum(gamma ** (i - t) * rewards[i] for i in range(t, last))
            if not (end and last == len(walk)):
                target += gamma ** (last - t) * (w @ x[last])
            w += agent.step_size * (target - w @ x[t]) * x[t]
    return w.reshape(agent.weights.shape)


def book_traces(agent: Any, seed: int, traces: str, decay: float, *, watkins: bool = False) -> Floats:
    """Boxes of 12.7 (of the first edition's 7.6 for Watkins)."""
    w, gamma, alpha = np.zeros(agent.weights.size), agent.discount, agent.step_size
    for walk in walks(seed, len(agent.features.low)):
        z, old = np.zeros_like(w), 0.0
        for observation, action, reward, next_observation, next_action, end in walk:
            x = vector(agent, observation, action)
            q = [float(w @ vector(agent, next_observation, a)) for a in range(3)]
            following = 0.0 if end else max(q) if watkins else q[next_action]
            delta = reward + gamma * following - w @ x
            if traces == "dutch":
                z = gamma * decay * z + (1 - alpha * gamma * decay * (z @ x)) * x
                value = w @ x
                w += alpha * (delta + value - old) * z - alpha * (value - old) * x
                old = following
                continue
            if traces == "clearing":
                z[np.sum([vector(agent, observation, a) for a in range(3)], axis=0) > 0] = 0.0
            z = z + x if traces == "accumulating" else np.where(x > 0, 1.0, z)
            w += alpha * delta * z
            z = z * (gamma * decay if not watkins or q[next_action] == max(q) else 0.0)
    return w.reshape(agent.weights.shape)


TASKS: list[tuple[Any, dict[str, Any]]] = [
    (Line(), {"tilings": 3, "tiles": 4}),
    (Line(), {"bins": 5}),
    (Square(), {"tilings": 4, "tiles": (2, 3)}),
]
on_tasks = pytest.mark.parametrize(("task", "parameters"), TASKS, ids=["line", "grid", "square"])
rates: dict[str, Any] = {"discount": 0.9, "step_size": 0.3}


@on_tasks
@pytest.mark.parametrize("n", [1, 2, 3, 5, 1000])
def test_n_step_sarsa_is_the_books(task: Any, parameters: dict[str, Any], n: int) -> None:
    agent = SemiGradientSarsa.create(task, n=n, **rates, **parameters)
    assert learned(agent, 1) == pytest.approx(book_n_step(agent, 1, n), rel=1e-9, abs=1e-12)


@on_tasks
@pytest.mark.parametrize("decay", [0.0, 0.5, 0.95, 1.0])
@pytest.mark.parametrize("traces", ["accumulating", "replacing", "clearing", "dutch"])
def test_sarsa_lambda_is_the_books(task: Any, parameters: dict[str, Any], traces: Any, decay: float) -> None:
    given: dict[str, Any] = {**rates, **parameters, "trace_decay": decay}
    if traces == "dutch":  # with a large step size some traces are negative
        agent: Any = TrueOnlineSarsa.create(task, **{**given, "step_size": 1.5})
    elif traces == "clearing":
        agent = SarsaLambda.create(task, traces="replacing", clear_others=True, **given)
    else:
        agent = SarsaLambda.create(task, traces=traces, **given)
    assert learned(agent, 2) == pytest.approx(book_traces(agent, 2, traces, decay), rel=1e-6, abs=1e-7)


@on_tasks
@pytest.mark.parametrize("decay", [0.5, 1.0])
@pytest.mark.parametrize("traces", ["accumulating", "replacing"])
def test_watkins_is_the_books(task: Any, parameters: dict[str, Any], traces: Any, decay: float) -> None:
    agent = WatkinsQLambda.create(task, traces=traces, trace_decay=decay, **rates, **parameters)
    expected = book_traces(agent, 3, traces, decay, watkins=True)
    assert learned(agent, 3) == pytest.approx(expected, rel=1e-6, abs=1e-7)


@pytest.mark.parametrize("cls", [SarsaLambda, TrueOnlineSarsa])
@on_tasks
def test_lambda_zero_is_one_step_sarsa(cls: Any, task: Any, parameters: dict[str, Any]) -> None:
    one_step = learned(SemiGradientSarsa.create(task, **rates, **parameters), 4)
    assert np.count_nonzero(one_step) > 10
    found = learned(cls.create(task, trace_decay=0.0, **rates, **parameters), 4)
    if cls is SarsaLambda:
        assert np.array_equal(found, one_step)
    else:  # the same up to rounding
        assert found == pytest.approx(one_step, rel=1e-12, abs=1e-14)


def test_one_step_on_a_grid_is_tabular_sarsa_to_the_bit() -> None:
    tabular = Sarsa.create(Square(), bins=(3, 4), discount=0.9, step_size=HarmonicRate(0.25, 1.0, 0.0))
    for walk in walks(5, 2):
        for one in walk:
            tabular.learn(*one)
    linear = SemiGradientSarsa.create(Square(), bins=(3, 4), discount=0.9, step_size=0.25)
    assert np.array_equal(learned(linear, 5), tabular.values)


def test_as_many_steps_as_an_episode_has_give_its_returns() -> None:
    agent = make(SemiGradientSarsa, n=50, step_size=1.0)
    agent.begin_episode()
    for one in (
        step(0, 0, 1.0, 1, 1),
        step(1, 1, 2.0, 2, 2),
        step(2, 2, 4.0, 3, 0),
        step(3, 0, 8.0, 0, 0, True),
    ):
        agent.learn(*one)
    assert agent.weights.tolist() == weights({(0, 0): 4.0, (1, 1): 6.0, (2, 2): 8.0, (3, 0): 8.0})


@settings(deadline=None, max_examples=60)
@given(
    seed=st.integers(0, 2**32),
    decay=st.floats(0, 1),
    step_size=st.floats(0.01, 2),
    setting=st.sampled_from([s for s in SETTINGS if s[0] is not SemiGradientSarsa]),
)
def test_list_of_traces_is_consistent(
    seed: int, decay: float, step_size: float, setting: tuple[type[Any], dict[str, Any]]
) -> None:
    cls, parameters = setting
    agent = cls.create(Square(), **{**parameters, "trace_decay": decay, "step_size": step_size})
    traces = agent.memory.traces if cls is TrueOnlineSarsa else agent.memory
    for walk in walks(seed, 2, episodes=3):
        agent.begin_episode()
        assert traces.length[0] == 0
        for one in walk:
            agent.learn(*one)
            length = traces.length[0]
            assert traces.positions[traces.weights[:length]].tolist() == list(range(length))
            assert np.count_nonzero(traces.positions >= 0) == length
            assert np.all(np.abs(traces.values[:length]) >= NEGLIGIBLE)


# In the arena


@pytest.mark.parametrize("hill", [Hill(), Hill(max_position=0.5, goal_position=-0.35)], ids=["far", "near"])
def test_both_drivers_get_the_same_bits(hill: Hill) -> None:
    entrants = [Entrant(name, cls, **given) for name, (cls, given) in zip(NAMES, SETTINGS)]
    tournament = Tournament(
        tuple(entrants), hill, Training(episodes=6, max_steps=150), Evaluation(3, 100), replicates=2
    )
    with (
        run(tournament, n_jobs=1, driver="compiled") as compiled,
        run(tournament, n_jobs=1, driver="pettingzoo") as interpreted,
    ):
        assert set(compiled.frame().driver) == {"compiled"}
        assert set(interpreted.frame().driver) == {"pettingzoo"}
        assert bits_of(compiled) == bits_of(interpreted)
        kept = compiled.arrays(NAMES[0])
        assert kept.keys() == {"weights", "lengths", "test_lengths", "test_reached"}
        assert np.count_nonzero(kept["weights"]) > 50


@pytest.mark.parametrize(("cls", "given"), SETTINGS, ids=NAMES)
def test_compiled_agents_allocate_nothing(cls: type[Any], given: dict[str, Any]) -> None:
    hill, agent = Hill(), cls.create(Hill(), **given)
    streams = np.random.default_rng(1), np.random.default_rng(2)
    loop = TrainingLoop(hill, agent, episode_hook(agent), 3, 2, 50, *streams, np.zeros(2, np.int64))
    arguments = (loop, 0, 2)
    compile_loop(train, *arguments)
    folder, fingerprint = cache_directory(), ReachableCode(train, *arguments).fingerprint()
    assert folder is not None
    assert (folder / fingerprint).exists()
    assert not (folder / f"{fingerprint}-counted").exists()


@pytest.mark.parametrize(
    ("cls", "given"),
    [
        (SemiGradientSarsa, {"n": 8}),
        (SarsaLambda, {"traces": "accumulating", "trace_decay": 1.0}),
        (TrueOnlineSarsa, {"trace_decay": 1.0}),
    ],
)
def test_run_that_diverges_fails_and_says_so(cls: type[Any], given: dict[str, Any]) -> None:
    entrant = Entrant("wild", cls, step_size=1e6, **given)
    tournament = Tournament((entrant,), Hill(), Training(5, 2000), Evaluation(1, 50), replicates=1)
    with run(tournament, n_jobs=1, driver="compiled") as results:
        assert results.frame().status.tolist() == ["failed"]
        assert "weights must be free of NaN" in results.runs[0]["error"]


@pytest.mark.parametrize(
    ("cls", "given"),
    [
        (SemiGradientSarsa, {"n": 4, "step_size": 0.5}),
        (SarsaLambda, {}),
        (TrueOnlineSarsa, {"step_size": 1.0}),
        (WatkinsQLambda, {}),
    ],
)
def test_hundred_episodes_teach_to_drive(cls: type[Any], given: dict[str, Any]) -> None:
    tournament = Tournament(
        (Entrant("one", cls, **given),),
        Hill(max_position=0.5),
        Training(100, 5000),
        Evaluation(100, 500),
        replicates=5,
    )
    with run(tournament, n_jobs=1) as results:
        frame = results.frame()
    assert frame.accuracy.mean() > 95.0
    assert frame.mean_length.between(97.0, 150.0).all()
