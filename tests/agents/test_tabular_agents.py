"""Expected SARSA, double Q-learning, n-step SARSA, Monte Carlo, the tutorial's agent and Xiao's."""

import math
from collections import defaultdict
from typing import Any

import numpy as np
import pytest
from compiled_agents import KINDS, assert_allocates_nothing, assert_same_bits_from_both_drivers
from walks import A, B, Line, Square, episodes, learn_all, make, table, teach

from agents import HarmonicRate, LinearDecay, QLearning, Sarsa, Softmax, UpperConfidence
from agents.algorithms.double_q_learning import DoubleQLearning
from agents.algorithms.expected_sarsa import ExpectedSarsa
from agents.algorithms.monte_carlo import MonteCarlo
from agents.algorithms.n_step_sarsa import NStepSarsa
from agents.algorithms.semi_gradient_sarsa import SemiGradientSarsa
from agents.algorithms.tabular import Tabular
from agents.algorithms.tutorial import TutorialQLearning
from agents.baselines import XiaoAgent
from agents.parameters import parameters_of
from envs import Hill

RULES: list[dict[str, Any]] = [
    {},
    {"goal": "bootstrap", "count_visits": "episode", "step_size": HarmonicRate(1.0, 2.0, 0.5)},
    {"goal": "zero", "count_visits": "state", "initial_values": 1.5},
]
rules = pytest.mark.parametrize("rule", RULES, ids=["plain", "bootstrap", "zero"])


def same(one: Any, other: Any) -> bool:
    return np.array_equal(one.values, other.values) and np.array_equal(one.visits, other.visits)


# Expected SARSA: q + rate * (reward + discount * mean next value - q)


@pytest.mark.parametrize(
    ("parameters", "mean"),
    [
        ({"epsilon": LinearDecay(1.0, 0.0)}, 0.75 * 3.0 + 0.25 * 5.0),  # at a quarter epsilon is 3/4
        # exp(value / temperature) is 2, 32 and 8 at the temperature 1 / ln 2
        (
            {"explore": Softmax(1 / math.log(2), 1 / math.log(2))},
            (2 * 1.0 + 32 * 5.0 + 8 * 3.0) / 42,
        ),
        ({"explore": UpperConfidence()}, 5.0),
    ],
)
def test_expected_sarsa_learns_from_the_mean_over_what_it_explores(
    parameters: dict[str, Any], mean: float
) -> None:
    agent = make(ExpectedSarsa, **parameters)
    agent.act(B, 0.25, np.random.default_rng(1))
    teach(agent, A, 2, -1.0, B, 0, False)
    assert agent.values[0].tolist() == [0.0, 0.0, pytest.approx(0.25 * (-1.0 + 0.5 * mean), rel=1e-14)]
    assert agent.values[1].tolist() == [1.0, 5.0, 3.0]


@rules
def test_expected_sarsa_without_exploration_is_q_learning(rule: dict[str, Any]) -> None:
    one, other = (
        learn_all(cls.create(Square(), bins=3, epsilon=0.0, **rule), episodes(1))
        for cls in (ExpectedSarsa, QLearning)
    )
    assert same(one, other)


# Double Q-learning


class Coin:
    """Falls as it is told."""

    def __init__(self, *falls: float) -> None:
        self.falls = list(falls)

    def random(self) -> float:
        return self.falls.pop(0)


def with_coin(agent: Any, *falls: float) -> Any:
    return agent._replace(memory=agent.memory._replace(coin=Coin(*falls)))


def test_double_q_learning_by_hand() -> None:
    agent = with_coin(make(DoubleQLearning), 0.49, 0.5)
    first, second = agent.memory.first, agent.memory.second
    first.values[1], second.values[1] = [1.0, 5.0, 3.0], [7.0, 4.0, 9.0]
    teach(agent, A, 2, -1.0, B, 0, False)  # the first deems 1 best, which the second values with 4
    assert first.values[0].tolist() == [0.0, 0.0, 0.25 * (-1.0 + 0.5 * 4.0)]
    assert second.values[0].tolist() == [0.0, 0.0, 0.0]
    assert agent.values[0].tolist() == [0.0, 0.0, 0.125]
    teach(agent, A, 2, -1.0, B, 0, False)  # the second deems 2 best, which the first values with 3
    assert first.values[0, 2] == 0.25
    assert second.values[0, 2] == 0.25 * (-1.0 + 0.5 * 3.0)
    assert agent.values[0, 2] == (0.25 + 0.125) / 2
    assert (first.visits[0, 2], second.visits[0, 2], agent.visits[0, 2]) == (1, 1, 2)


@pytest.mark.parametrize(("count_visits", "again"), [("step", 0.5), ("state", 0.25), ("episode", 0.5)])
def test_step_sizes_of_double_q_learning_follow_the_visits_of_the_table(
    count_visits: str, again: float
) -> None:
    rate = HarmonicRate(1.0, 2.0, 2.0)
    agent = with_coin(make(DoubleQLearning, step_size=rate, count_visits=count_visits), 0.0, 0.9, 0.0, 0.9)
    agent.begin_episode()
    teach(agent, A, 0, 1.0, B, 0, True)
    teach(agent, A, 0, 1.0, B, 0, True)
    teach(agent, A, 1, 1.0, B, 0, True)
    assert agent.memory.first.values[0].tolist() == [0.5, again, 0.0]
    assert agent.memory.second.values[0].tolist() == [0.5, 0.0, 0.0]
    agent.begin_episode()
    teach(agent, A, 1, 1.0, B, 0, True)
    assert agent.memory.second.values[0].tolist() == [0.5, again, 0.0]


def test_double_q_learning_drives_by_the_mean_of_tables_that_begin_alike() -> None:
    agent = DoubleQLearning.create(Square(), bins=3, initial_values=(-2.0, 0.0), rng=np.random.default_rng(1))
    twins = agent.memory
    assert np.array_equal(agent.values, twins.first.values)
    assert np.array_equal(agent.values, twins.second.values)
    learn_all(agent, episodes(2))
    assert not np.array_equal(twins.first.values, twins.second.values)
    assert np.array_equal(agent.values, 0.5 * (twins.first.values + twins.second.values))
    assert np.array_equal(agent.visits, twins.first.visits + twins.second.visits)


def test_double_q_learning_does_not_take_luck_for_value() -> None:
    """Sutton & Barto's Example 6.7: the greatest of noisy values is too great, though all means are -0.1."""
    worth = defaultdict(list)
    for seed in range(40):
        for cls in (QLearning, DoubleQLearning):
            agent = cls.create(Line(), bins=2, discount=1.0, step_size=0.1, rng=np.random.default_rng(seed))
            noise = np.random.default_rng(100 + seed)
            for _ in range(60):
                teach(agent, B, int(noise.integers(3)), noise.normal(-0.1), A, 0, True)
                teach(agent, A, 0, 0.0, B, 0, False)
            worth[cls].append(agent.values[0, 0])
    assert np.mean(worth[QLearning]) > 0.1
    assert np.mean(worth[DoubleQLearning]) < 0.0


# n-step SARSA


@rules
def test_one_step_sarsa_is_sarsa(rule: dict[str, Any]) -> None:
    one = learn_all(NStepSarsa.create(Square(), bins=3, n=1, **rule), episodes(3))
    assert same(one, learn_all(Sarsa.create(Square(), bins=3, **rule), episodes(3)))


@pytest.mark.parametrize("n", [2, 3, 7, 100])
def test_n_step_sarsa_is_the_linear_agents_with_cells_for_features(n: int) -> None:
    tabular = NStepSarsa.create(Square(), bins=(3, 4), n=n, discount=0.9, step_size=0.25)
    linear = SemiGradientSarsa.create(Square(), bins=(3, 4), n=n, discount=0.9, step_size=0.25)
    assert np.array_equal(learn_all(tabular, episodes(4)).values, learn_all(linear, episodes(4)).weights)


def test_two_step_sarsa_learns_from_two_rewards_and_the_value_after_them() -> None:
    agent = make(NStepSarsa, n=2)
    teach(agent, A, 0, 4.0, A, 1, False)
    assert agent.values.tolist() == table(0.0, 0.0, 0.0)
    teach(agent, A, 1, 8.0, B, 2, False)
    assert agent.values.tolist() == table(0.25 * (4.0 + 0.5 * 8.0 + 0.25 * 3.0), 0.0, 0.0)
    assert agent.visits.tolist() == [[1, 0, 0], [0, 0, 0]]
    agent.begin_episode()  # the time was up: the step that waits has one reward and the value after it
    assert agent.values[0].tolist() == [2.1875, 0.25 * (8.0 + 0.5 * 3.0), 0.0]
    assert agent.visits.tolist() == [[1, 1, 0], [0, 0, 0]]
    agent.begin_episode()  # nothing waits any more
    assert agent.visits.sum() == 2


def test_steps_that_wait_count_for_the_episode_they_were_made_in() -> None:
    rate = HarmonicRate(1.0, 2.0, 2.0)
    agent = make(NStepSarsa, n=3, step_size=rate, count_visits="episode", discount=0.0)
    for _ in range(2):
        agent.begin_episode()
        teach(agent, A, 0, 8.0, B, 0, False)
    agent.begin_episode()
    assert agent.values[0, 0] == 4.0 + 0.25 * (8.0 - 4.0)  # 1/2, then 1/4 in the second episode


# Returns: three steps with rewards 1, 2, 4 and discount 1/2; the last leads to a cell whose value is 3


@pytest.mark.parametrize("cls", [NStepSarsa, MonteCarlo])
@pytest.mark.parametrize(("goal", "last"), [("terminal", 4.0), ("bootstrap", 4.0 + 0.5 * 3.0), ("zero", 0.0)])
def test_whole_episode_returns_its_rewards_and_what_the_goal_rule_says(
    cls: type[Any], goal: str, last: float
) -> None:
    agent = make(cls, goal=goal, initial_values=8.0, **({"n": 9} if cls is NStepSarsa else {}))
    teach(agent, A, 0, 1.0, A, 1, False)
    teach(agent, A, 1, 2.0, A, 2, False)
    assert agent.values.tolist() == table(8.0, 8.0, 8.0)
    teach(agent, A, 2, 4.0, B, 2, True)
    second = 2.0 + 0.5 * last
    first = 1.0 + 0.5 * second
    moved = [8.0 + 0.25 * (target - 8.0) for target in (first, second, last)]
    if goal == "zero":
        moved[2] = 0.0  # set, not moved
    assert agent.values.tolist() == table(*moved)
    assert agent.visits.tolist() == [[1, 1, 1], [0, 0, 0]]


def test_monte_carlo_with_steps_of_one_nth_takes_the_mean_of_all_returns() -> None:
    finished = [walk for walk in episodes(5, count=30) if walk[-1][-1]]
    agent = MonteCarlo.create(Square(), bins=3, discount=0.9, step_size=HarmonicRate(1.0, 1.0, 1.0))
    learn_all(agent, finished)
    returns = defaultdict(list)
    for walk in finished:
        total = 0.0
        for observation, action, reward, *_ in reversed(walk):
            total = reward + 0.9 * total
            returns[agent.cells.encode(observation), action].append(total)
    assert len(returns) == 27
    for pair, found in returns.items():
        assert agent.values[pair] == pytest.approx(np.mean(found), rel=1e-12)
        assert agent.visits[pair] == len(found)


def test_as_many_steps_as_an_episode_has_are_monte_carlo() -> None:
    parameters: dict[str, Any] = {"bins": 3, "step_size": HarmonicRate(1.0, 1.0, 1.0)}
    finished = [walk for walk in episodes(6) if walk[-1][-1]]
    one = learn_all(NStepSarsa.create(Square(), n=1000, **parameters), finished)
    other = learn_all(MonteCarlo.create(Square(), **parameters), finished)
    assert np.array_equal(one.visits, other.visits)  # a mean does not ask in which order
    assert np.allclose(one.values, other.values, rtol=1e-12, atol=1e-14)


def test_time_limit_leaves_monte_carlo_with_the_value_of_the_last_cell_and_action() -> None:
    agent = make(MonteCarlo)
    teach(agent, A, 0, 1.0, A, 1, False)
    teach(agent, A, 1, 2.0, B, 2, False)
    agent.begin_episode()
    second = 2.0 + 0.5 * 3.0
    assert agent.values.tolist() == table(0.25 * (1.0 + 0.5 * second), 0.25 * second, 0.0)
    agent.begin_episode()
    assert agent.visits.sum() == 2


def test_monte_carlo_forgets_what_is_beyond_its_memory() -> None:
    agent = make(MonteCarlo, memory=2)
    for action in (0, 1, 2, 1):
        teach(agent, A, action, 1.0, A, 0, False)
    teach(agent, A, 2, 4.0, B, 0, True)
    assert agent.values.tolist() == table(0.0, 0.25 * (1.0 + 0.5 * 4.0), 0.25 * 4.0)


# The tutorial's agent and Xiao's


def test_tutorial_is_q_learning_with_other_defaults() -> None:
    theirs: dict[str, Any] = {
        "bins": (20, 20),
        "discount": 0.95,
        "step_size": HarmonicRate(0.1, 1.0, 0.0),
        "epsilon": LinearDecay(1.0, 0.0, 0.5),
        "initial_values": (-2.0, 0.0),
        "goal": "zero",
    }
    rng = np.random.default_rng
    one = TutorialQLearning.create(Hill(), rng=rng(1))
    other = QLearning.create(Hill(), **theirs, rng=rng(1))
    assert (one.cells, one.policy) == (other.cells, other.policy)
    assert one.update[:4] == other.update[:4]
    assert np.array_equal(one.values, other.values)
    assert one.values.min() < -1.9 < -0.1 < one.values.max()
    fine = TutorialQLearning.create(Hill(), bins=40, discount=0.9)
    assert (fine.cells.size, fine.update.discount, fine.update.step_size.A) == (1600, 0.9, 0.1)


def test_xiaos_formula_drives_as_far_as_known() -> None:
    hill, agent, rng = Hill(), XiaoAgent.create(Hill()), np.random.default_rng(1)
    lengths = []
    for _ in range(1000):
        state, steps, reached = hill.reset(rng), 0, False
        while not reached and steps < 200:  # the limit of MountainCar-v0
            state, _, reached = hill.step(state, agent.act(state, 0.0, rng))
            steps += 1
        lengths.append(steps)
    assert np.mean(lengths) == pytest.approx(105.7, abs=4 * float(np.std(lengths)) / math.sqrt(1000))


# Parameters


@pytest.mark.parametrize(
    ("cls", "own"),
    [(ExpectedSarsa, []), (NStepSarsa, ["n"]), (MonteCarlo, ["memory"]), (TutorialQLearning, [])],
)
def test_inherited_parameters_are_declared_after_its_own(cls: type[Any], own: list[str]) -> None:
    declared, free = parameters_of(cls)
    parents, _ = parameters_of(Tabular)
    assert list(declared) == [*own, *parents]
    assert not free
    assert all(declared[name].rule() == parents[name].rule() for name in parents)


@pytest.mark.parametrize(
    ("cls", "parameter", "bad"),
    [
        (NStepSarsa, "n", 0),
        (MonteCarlo, "memory", 0),
        (ExpectedSarsa, "discount", 2),
        (TutorialQLearning, "bins", 0),
    ],
)
def test_bad_parameter_is_refused_by_name(cls: type[Any], parameter: str, bad: Any) -> None:
    with pytest.raises(ValueError, match=f"^{parameter} must "):
        cls.create(Hill(), **{parameter: bad})


# In the arena: kinds of cells and exploration take turns; the others are slow

COMPILED: list[tuple[type[Any], dict[str, Any]]] = [
    (ExpectedSarsa, {"explore": Softmax(2.0, 0.5)}),
    (DoubleQLearning, {"binning": "quantile", "count_visits": "episode"}),
    (NStepSarsa, {"n": 3, "binning": "kmeans", "explore": UpperConfidence(2.0)}),
    (MonteCarlo, {"memory": 50, "binning": "quantile", "goal": "bootstrap"}),
    (TutorialQLearning, {"binning": "kmeans"}),
    (XiaoAgent, {}),
]


@pytest.mark.exhaustive
@pytest.mark.parametrize(("cls", "parameters"), COMPILED, ids=[cls.__name__ for cls, _ in COMPILED])
def test_compiled_agents_allocate_nothing_and_leave_the_interpreters_bits(
    cls: type[Any], parameters: dict[str, Any]
) -> None:
    given = parameters if cls is XiaoAgent else {"bins": (4, 5), **parameters}
    assert_same_bits_from_both_drivers(cls, given, limit=40 if cls is XiaoAgent else 60)
    assert_allocates_nothing(cls, given)


@pytest.mark.exhaustive
@pytest.mark.parametrize("cls", [ExpectedSarsa, DoubleQLearning, NStepSarsa, MonteCarlo, TutorialQLearning])
@pytest.mark.parametrize("kind", KINDS, ids=["uniform", "quantile", "kmeans"])
def test_every_kind_of_cells_and_of_exploration(cls: type[Any], kind: dict[str, Any]) -> None:
    assert_same_bits_from_both_drivers(cls, kind)
    assert_allocates_nothing(cls, kind)
