import math
from typing import Any

import numpy as np
import pytest
from walks import A, B, Line, make, table, teach

from agents import Grid, HarmonicRate, LinearDecay, MomentumAgent, QLearning, RandomAgent, Sarsa
from agents.learning.action_values import best_action, epsilon_greedy
from agents.learning.exploration import EpsilonGreedy
from envs import Hill

CLASSES = [QLearning, Sarsa]

# Updates computed by hand: q + rate * (reward + discount * next value - q)


def test_q_learning_learns_from_the_best_next_action() -> None:
    agent = make(QLearning)
    teach(agent, A, 2, -1.0, B, 0, False)
    assert agent.values.tolist() == table(0.0, 0.0, 0.25 * (-1.0 + 0.5 * 5.0))
    assert agent.visits.tolist() == [[0, 0, 1], [0, 0, 0]]


def test_sarsa_learns_from_the_next_action_taken() -> None:
    agent = make(Sarsa)
    teach(agent, A, 2, -1.0, B, 2, False)
    assert agent.values.tolist() == table(0.0, 0.0, 0.25 * (-1.0 + 0.5 * 3.0))
    assert agent.visits.tolist() == [[0, 0, 1], [0, 0, 0]]


@pytest.mark.parametrize(("cls", "next_value"), [(QLearning, 8.0), (Sarsa, 4.0)])
def test_next_value_in_the_same_cell_is_the_one_before_the_update(cls: type[Any], next_value: float) -> None:
    agent = make(cls)
    agent.values[0] = [4.0, 0.0, 8.0]
    teach(agent, A, 0, -1.0, A, 0, False)
    assert agent.values.tolist() == table(4.0 + 0.25 * (-1.0 + 0.5 * next_value - 4.0), 0.0, 8.0)


@pytest.mark.parametrize("cls", CLASSES)
@pytest.mark.parametrize(
    ("goal", "learned"), [("terminal", 1.75), ("bootstrap", 1.75 + 0.25 * 0.5 * 5.0), ("zero", 0.0)]
)
def test_goal_rule(cls: type[Any], goal: str, learned: float) -> None:
    agent = make(cls, goal=goal, initial_values=2.0)
    teach(agent, A, 0, 1.0, B, 1, True)
    assert agent.values.tolist() == table(learned, 2.0, 2.0)
    assert agent.visits[0, 0] == 1
    teach(agent, A, 1, 1.0, B, 1, False)  # a time limit is no goal: here all rules are the same
    assert agent.values[0, 1] == 2.0 + 0.25 * (1.0 + 0.5 * 5.0 - 2.0)


def steps_taken(agent: Any, visited: str) -> list[float]:
    """The step sizes of visits: ``0`` and ``2`` take that action in A, ``|`` begins an episode."""
    taken = []
    for visit in visited:
        if visit == "|":
            agent.begin_episode()
        else:
            agent.values[0] = 0.0
            teach(agent, A, int(visit), 1.0, A, 0, True)
            taken.append(float(agent.values[0, int(visit)]))
    return taken


@pytest.mark.parametrize("cls", CLASSES)
@pytest.mark.parametrize(
    ("count_visits", "counts"),
    [("step", [0, 1, 0, 2, 3, 1, 4]), ("episode", [0, 0, 0, 0, 1, 1, 2]), ("state", [0, 1, 2, 3, 4, 5, 6])],
)
def test_step_size_follows_the_visits(cls: type[Any], count_visits: str, counts: list[int]) -> None:
    agent = make(cls, step_size=HarmonicRate(1.0, 2.0, 0.5), count_visits=count_visits)
    assert steps_taken(agent, "|0020|02|0") == [1.0 / (2.0 + 0.5 * n) for n in counts]
    assert agent.visits.tolist() == [[5, 0, 2], [0, 0, 0]]  # always every step


@pytest.mark.parametrize(("count_visits", "again"), [("step", 1), ("episode", 0), ("state", 1)])
def test_counts_belong_to_their_cell(count_visits: str, again: int) -> None:
    agent = make(QLearning, step_size=HarmonicRate(1.0, 2.0, 2.0), count_visits=count_visits)
    agent.begin_episode()
    taken = []
    for observation in (A, A, B, B):
        agent.values[:] = 0.0
        teach(agent, observation, 0, 1.0, A, 0, True)
        taken.append(agent.values.max())
    assert taken == [0.5, 1.0 / (2.0 + 2.0 * again)] * 2


# The table before learning


def test_initial_values_are_the_number_given() -> None:
    assert np.unique(QLearning.create(Hill()).values).tolist() == [0.0]
    assert np.unique(QLearning.create(Line(), bins=2, initial_values=-3).values).tolist() == [-3.0]


def test_initial_values_between_two_are_drawn_from_the_generator_given() -> None:
    parameters: dict[str, Any] = {"bins": 500, "initial_values": (-2.0, 1.0)}
    one, same, other = (
        Sarsa.create(Line(), **parameters, rng=np.random.default_rng(s)).values for s in (1, 1, 2)
    )
    assert one.tolist() == same.tolist() != other.tolist()
    assert -2.0 <= one.min() < -1.99
    assert 0.99 < one.max() < 1.0
    assert one.mean() == pytest.approx(-0.5, abs=4 * 3.0 / math.sqrt(12 * one.size))


def test_defaults_are_the_papers() -> None:
    agent = Sarsa.create(Hill())
    assert agent.cells == Grid.over(Hill(), (20, 30))
    assert agent.values.shape == agent.visits.shape == (600, 3)
    assert agent.policy == EpsilonGreedy(LinearDecay(0.6, 0.01))
    assert (agent.update.step_size, agent.update.discount) == (HarmonicRate(1.0, 10.0, 0.01), 0.99)


@pytest.mark.parametrize(
    ("parameter", "bad"),
    [("discount", 1.1), ("discount", "1"), ("bins", 0), ("count_visits", "steps"), ("goal", 0)]
    + [("initial_values", bad) for bad in (math.nan, "0", (1.0, 0.0), (0.0, 1.0, 2.0))],
)
def test_bad_parameter_is_refused_by_name(parameter: str, bad: Any) -> None:
    with pytest.raises((TypeError, ValueError), match=f"^{parameter} must "):
        QLearning.create(Hill(), **{parameter: bad})


# Schedules


def test_linear_decay_is_a_straight_line() -> None:
    assert [LinearDecay(0.75, 0.25).at(progress) for progress in (0.0, 0.25, 0.5, 1.0)] == [
        0.75,
        0.625,
        0.5,
        0.25,
    ]
    assert LinearDecay(0.0, 1.0).at(0.5) == 0.5


def test_harmonic_rate_falls_with_the_visits_and_is_constant_for_zero() -> None:
    assert [HarmonicRate(1.0, 2.0, 0.5).at(visits) for visits in (0, 4, 12)] == [0.5, 0.25, 0.125]
    assert {HarmonicRate(1.0, 8.0, 0.0).at(visits) for visits in (0, 1, 10**9)} == {0.125}
    assert HarmonicRate(2.0, 2.0, 1.0).at(0) == 1.0


@pytest.mark.parametrize(
    ("schedule", "name", "bad"),
    [(LinearDecay, name, bad) for name in ("start", "end") for bad in (-0.1, 1.1, math.nan, "1", None, True)]
    + [(HarmonicRate, name, bad) for name in "ABC" for bad in (-0.1, math.nan, math.inf, "1", None, True)]
    + [(HarmonicRate, "A", 0.0), (HarmonicRate, "B", 0.5)],
)
def test_bad_schedule_is_refused_by_name_and_value(schedule: type[Any], name: str, bad: Any) -> None:
    error = ValueError if isinstance(bad, float) else TypeError
    with pytest.raises(error, match=f"^{name} must be .*, got {bad!r}$"):
        schedule(**{name: bad})


# Choices


@pytest.mark.parametrize(
    ("values", "best"), [([1, 1, 1], 0), ([0, 1, 1], 1), ([1, 0, 1], 0), ([-3, -2, -1], 2), ([0, 1, 0], 1)]
)
def test_best_action_is_the_lowest_of_the_greatest(values: list[float], best: int) -> None:
    others = [-9.0, -9.0, 9.0]
    assert best_action(np.array([others, values, others]), 1) == best
    agent = make(QLearning)
    agent.values[0] = values
    assert agent.greedy(A) == best


def assert_frequencies(actions: list[int], expected: list[float]) -> None:
    found = np.bincount(actions, minlength=3) / len(actions)
    for frequency, p in zip(found, expected, strict=True):
        assert abs(frequency - p) <= 4 * math.sqrt(p * (1 - p) / len(actions))


@pytest.mark.parametrize("epsilon", [0.0, 0.5, 1.0])
def test_epsilon_greedy_takes_any_action_with_probability_epsilon(epsilon: float) -> None:
    rng, agent = np.random.default_rng(1), make(Sarsa, epsilon=LinearDecay(0.0, epsilon))
    expected = [epsilon / 3, 1 - epsilon + epsilon / 3, epsilon / 3]
    assert_frequencies([epsilon_greedy(agent.values, 1, epsilon, rng) for _ in range(20_000)], expected)
    assert_frequencies([agent.act(B, 1.0, rng) for _ in range(20_000)], expected)
    assert_frequencies([agent.act(B, 0.0, rng) for _ in range(100)], [0.0, 1.0, 0.0])


def test_random_agent_takes_all_actions_equally_often_also_when_evaluated() -> None:
    agent, rng = RandomAgent.create(Hill(), rng=np.random.default_rng(2)), np.random.default_rng(1)
    assert_frequencies([agent.act(A, 0.0, rng) for _ in range(20_000)], [1 / 3] * 3)
    assert_frequencies([agent.greedy(A) for _ in range(20_000)], [1 / 3] * 3)


def test_momentum_agent_thrusts_the_way_the_car_moves() -> None:
    agent, rng = MomentumAgent.create(Hill()), np.random.default_rng(1)
    for velocity, action in ((0.01, 2), (0.0, 2), (-1e-300, 0), (-0.07, 0)):
        assert agent.greedy((-0.5, velocity)) == agent.act((-0.5, velocity), 0.0, rng) == action


@pytest.mark.parametrize(
    "replace",
    [
        lambda: LinearDecay()._replace(end=3),
        lambda: HarmonicRate()._replace(A=0),
        lambda: Sarsa.create(Hill(), step_size=1.1),
    ],
)
def test_no_way_leads_around_the_validation_of_parameters(replace: Any) -> None:
    with pytest.raises((TypeError, ValueError), match=r"^(end|A|step_size) must be "):
        replace()
