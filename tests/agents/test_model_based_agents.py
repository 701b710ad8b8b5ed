"""Dyna-Q, prioritized sweeping, R-MAX and fitted Q iteration, and what they are made of."""

import math
from typing import Any, NamedTuple

import numpy as np
import pytest
from bits import bits_of
from compiled_agents import KINDS, NEAR, assert_allocates_nothing, assert_same_bits_from_both_drivers
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from walks import A, B, Square, episodes, learn_all, make, table

import agents.algorithms.fitted_q_iteration
from agents import HarmonicRate, QLearning, Softmax
from agents.algorithms.dyna_q import DynaQ
from agents.algorithms.fitted_q_iteration import Fit, FittedQIteration, fitted
from agents.algorithms.prioritized_sweeping import PrioritizedSweeping
from agents.algorithms.r_max import RMax
from agents.models.batch import Batch
from agents.models.cell_model import SUCCESSORS, CellModel
from agents.models.forest import Forest
from agents.models.priority_queue import PriorityQueue
from agents.parameters import parameters_of
from arena import Entrant, Evaluation, Tournament, Training, run
from envs import Hill


class Draws:
    """Random numbers as they are told."""

    def __init__(self, *numbers: float) -> None:
        self.numbers = list(numbers)

    def random(self) -> float:
        return self.numbers.pop(0)


def with_draws(agent: Any, *numbers: float) -> Any:
    return agent._replace(memory=agent.memory._replace(rng=Draws(*numbers)))


# Dyna-Q


@pytest.mark.parametrize(
    "rule",
    [{}, {"goal": "bootstrap", "count_visits": "episode"}, {"goal": "zero", "count_visits": "state"}],
)
def test_dyna_q_without_planning_is_q_learning(rule: dict[str, Any]) -> None:
    one = learn_all(DynaQ.create(Square(), bins=3, planning=0, **rule), episodes(1))
    other = learn_all(QLearning.create(Square(), bins=3, **rule), episodes(1))
    assert np.array_equal(one.values, other.values)
    assert np.array_equal(one.visits, other.visits)


def test_dyna_q_repeats_what_it_saw_last() -> None:
    agent = with_draws(make(DynaQ, planning=2), 0.0, 0.99, 0.6, 0.4, 0.0, 0.0)
    agent.learn(A, 0, -1.0, B, 0, False)  # pair (A, 0) is all that was seen: it is learned three times
    value = 0.0
    for _ in range(3):
        value += 0.25 * (-1.0 + 0.5 * 5.0 - value)
    assert agent.values.tolist() == table(value, 0.0, 0.0)
    agent.learn(A, 2, 8.0, B, 0, True)  # then (A, 2), which nothing follows, and (A, 0) once more
    after = 2.0 + 0.25 * (8.0 - 2.0)
    value += 0.25 * (1.5 - value)
    assert agent.values.tolist() == table(value, 0.0, after)
    agent.learn(A, 0, 3.0, A, 0, False)  # from now on (A, 0) leads to A with reward 3
    for _ in range(3):
        value += 0.25 * (3.0 + 0.5 * max(value, after) - value)
    assert agent.values.tolist() == table(value, 0.0, after)
    assert agent.visits.tolist() == [[2, 0, 1], [0, 0, 0]]  # what is repeated is no visit


def test_step_size_of_what_is_repeated_follows_the_visits() -> None:
    agent = make(DynaQ, planning=1, step_size=HarmonicRate(1.0, 2.0, 2.0))
    agent.learn(A, 0, 8.0, B, 0, True)
    assert agent.values[0, 0] == 4.0 + 0.25 * (8.0 - 4.0)  # the visit, then one after it


def test_curiosity_raises_rewards_of_what_was_not_tried_for_long() -> None:
    agent = with_draws(make(DynaQ, planning=1, curiosity=3.0), 0.0, 0.9, 0.9, 0.9, 0.0)
    agent.learn(A, 0, 0.0, B, 0, True)
    for _ in range(3):
        agent.learn(A, 1, 0.0, B, 0, True)
    assert agent.values.tolist() == table(0.0, 0.0, 0.0)  # what is repeated at once has no bonus
    agent.learn(A, 1, 0.0, B, 0, True)  # repeats (A, 0), which was tried four steps ago
    assert agent.values.tolist() == table(0.25 * 3.0 * math.sqrt(4), 0.0, 0.0)


# The model


@given(
    steps=st.lists(
        st.tuples(st.integers(0, 5), st.floats(-4, 4), st.integers(0, SUCCESSORS - 1)),
        min_size=1,
        max_size=60,
    ),
    discount=st.floats(0, 1),
)
def test_model_expects_the_mean_of_what_it_saw(steps: list[tuple[int, float, int]], discount: float) -> None:
    worth = np.sin(np.arange(SUCCESSORS))
    model = CellModel.empty(SUCCESSORS - 1, 2)
    for step in steps:
        model.observe(*step)
    for pair in {pair for pair, _, _ in steps}:
        seen = [reward + discount * worth[cell] for which, reward, cell in steps if which == pair]
        assert model.expected(pair, worth, discount) == pytest.approx(np.mean(seen), rel=1e-9, abs=1e-9)
        assert model.tries[pair] == len(seen)
    assert_chains_hold(model, {(pair, cell) for pair, _, cell in steps})


@pytest.mark.parametrize("seed", range(20))
def test_model_that_is_full_forgets_the_rarest(seed: int) -> None:
    rng, model = np.random.default_rng(seed), CellModel.empty(15, 1)
    counts: list[dict[int, int]] = [{}, {}, {}]  # by pair, in the order of their places
    forgotten = 0
    for _ in range(60):
        pair, cell = int(rng.integers(3)), int(rng.geometric(0.15)) % 12
        model.observe(pair, 0.0, cell)
        seen = counts[pair]
        if cell not in seen and len(seen) == SUCCESSORS:
            rarest = min(seen, key=lambda one: seen[one])
            counts[pair] = seen = {cell if one == rarest else one: n for one, n in seen.items()}
            seen[cell] = 0
            forgotten += 1
        seen[cell] = seen.get(cell, 0) + 1
    for pair, seen in enumerate(counts):
        assert model.successors[pair][model.counts[pair] > 0].tolist() == list(seen)
        assert model.counts[pair][model.counts[pair] > 0].tolist() == list(seen.values())
        assert model.tries[pair] == sum(seen.values())
    assert_chains_hold(model, {(pair, cell) for pair, seen in enumerate(counts) for cell in seen})
    assert forgotten > 0


def assert_chains_hold(model: CellModel, expected: set[tuple[int, int]]) -> None:
    """The links to each cell are those of the pairs that lead there, each once."""
    found = []
    for cell in range(len(model.first)):
        link = model.first[cell]
        while link >= 0:
            assert model.successors.ravel()[link] == cell
            assert model.counts.ravel()[link] > 0
            found.append((link // SUCCESSORS, cell))
            link = model.next_link[link]
    assert sorted(found) == sorted(expected)


# The queue


@given(
    st.lists(
        st.one_of(
            st.none(), st.tuples(st.integers(0, 11), st.sampled_from([0.5, 1.0, 2.0]) | st.floats(0.1, 9))
        )
    )
)
def test_queue_gives_the_greatest_first(orders: list[tuple[int, float] | None]) -> None:
    queue, oracle = PriorityQueue.empty(12), dict[int, float]()
    for order in orders:
        if order is not None:
            queue.put(*order)
            oracle[order[0]] = order[1]
        elif oracle:
            number = queue.pop()
            assert oracle.pop(number) >= max(oracle.values(), default=0.0)
        assert queue.length[0] == len(oracle)
        assert set(queue.heap[: len(oracle)].tolist()) == oracle.keys()
        assert {n: queue.priorities[n] for n in range(12) if queue.priorities[n] > 0.0} == oracle
        assert {n for n in range(12) if queue.positions[n] >= 0} == oracle.keys()
    left = [oracle[queue.pop()] for _ in range(len(oracle))]
    assert left == sorted(oracle.values(), reverse=True)


# Chains, whose values are known


class Chain(NamedTuple):
    """Cells 0 to 4 in a row; action 1 goes right, 0 left; the goal is right of the last."""

    low: tuple[float, ...] = (0.0,)
    high: tuple[float, ...] = (5.0,)
    n_actions: int = 2


def chain_values(discount: float) -> NDArray[np.float64]:
    """The values of both actions, from the linear equations of the policy that always goes right."""
    rightwards = np.eye(5, k=1)  # from the last cell nothing follows
    worth = np.linalg.solve(np.eye(5) - discount * rightwards, -np.ones(5))
    left, right = np.maximum(np.arange(5) - 1, 0), np.arange(5) + 1
    return np.stack([-1 + discount * worth[left], -1 + discount * np.append(worth, 0.0)[right]], axis=1)


def drive_chain(agent: Any, drives: int) -> None:
    rng = np.random.default_rng(1)
    for _ in range(drives):
        cell, action, end = 0, agent.act((0.5,), 0.0, rng), False
        agent.begin_episode()
        while not end:
            following = cell + 1 if action == 1 else max(cell - 1, 0)
            end = following == 5
            next_action = agent.act((following + 0.5,), 0.0, rng)
            agent.learn((cell + 0.5,), action, -1.0, (following + 0.5,), next_action, end)
            cell, action = following, next_action


@pytest.mark.parametrize("discount", [0.5, 0.9, 1.0])
@pytest.mark.parametrize(
    ("cls", "parameters"),
    [
        (RMax, {"known": 1, "tolerance": 0.0}),
        (RMax, {"known": 3, "tolerance": 0.0}),
        (PrioritizedSweeping, {"threshold": 0.0, "epsilon": 1.0}),
    ],
)
def test_values_of_a_chain_are_exact(cls: type[Any], parameters: dict[str, Any], discount: float) -> None:
    agent = cls.create(Chain(), bins=5, discount=discount, rng=np.random.default_rng(1), **parameters)
    drive_chain(agent, 30)
    assert agent.values == pytest.approx(chain_values(discount), rel=1e-12)
    assert [agent.greedy((cell + 0.5,)) for cell in range(5)] == [1] * 5


# Prioritized sweeping


class Cells4(NamedTuple):
    """Four cells and nothing to choose."""

    low: tuple[float, ...] = (0.0,)
    high: tuple[float, ...] = (4.0,)
    n_actions: int = 1


def swept(threshold: float, planning: int = 1) -> Any:
    """An agent that has seen 1 lead to 0, 2 lead to 0 and to 3, and now 0 lead to the goal with reward 8."""
    agent = PrioritizedSweeping.create(Cells4(), bins=4, discount=0.5, planning=planning, threshold=threshold)
    for cell, following in ((1, 0), (2, 0), (2, 3)):
        agent.learn((cell + 0.5,), 0, 0.0, (following + 0.5,), 0, False)
    assert agent.values.tolist() == [[0.0]] * 4
    agent.learn((0.5,), 0, 8.0, (3.5,), 0, True)
    return agent


def test_sweeping_begins_where_the_change_is_most_likely_to_matter() -> None:
    agent = swept(threshold=0.5)
    # The change of 8 has priority 8 in cell 1, and 8 times 1/2 in cell 2, which waits.
    assert agent.values.tolist() == [[8.0], [4.0], [0.0], [0.0]]
    agent.learn((3.5,), 0, 0.0, (0.5,), 0, True)
    assert agent.values.tolist() == [[8.0], [4.0], [0.5 * (8.0 + 0.0) / 2], [0.0]]
    assert agent.visits.tolist() == [[1], [1], [2], [1]]


@pytest.mark.parametrize(("threshold", "second"), [(3.99, 2.0), (4.0, 0.0)])
def test_change_below_the_threshold_is_not_worth_a_sweep(threshold: float, second: float) -> None:
    agent = swept(threshold, planning=9)
    assert agent.values.tolist() == [[8.0], [4.0], [second], [0.0]]


def test_what_was_never_tried_keeps_its_initial_value() -> None:
    agent = make(PrioritizedSweeping, step_size=None, initial_values=-7.0)
    agent.learn(A, 1, 2.0, A, 0, True)
    assert agent.values.tolist() == table(-7.0, 2.0, -7.0)


# R-MAX


def test_what_is_not_known_is_worth_the_greatest_return() -> None:
    agent = RMax.create(Chain(), bins=5, known=3, greatest_return=10.0, discount=0.5)
    for visit in range(3):
        assert np.all(agent.values == 10.0)
        agent.learn((0.5,), 0, -1.0 - visit, (1.5,), 0, False)
    assert agent.values[0].tolist() == [-2.0 + 0.5 * 10.0, 10.0]
    assert agent.greedy((0.5,)) == agent.act((0.5,), 0.0, np.random.default_rng(1)) == 1


def test_values_are_computed_anew_when_the_visits_of_a_pair_have_doubled() -> None:
    agent = RMax.create(Chain(), bins=5, known=1)
    found = []
    for reward in (-1.0, -3.0, -8.0, -4.0, -9.0):  # means -1, -2, -4, -4, -5
        agent.learn((0.5,), 0, reward, (0.5,), 0, True)
        found.append(agent.values[0, 0])
    assert found == [-1.0, -2.0, -2.0, -4.0, -4.0]


@pytest.mark.parametrize(("tolerance", "value"), [(0.0, -3.0), (0.99, -3.0), (1.0, -1.0)])
def test_value_iteration_stops_after_its_sweeps_or_when_little_changes(
    tolerance: float, value: float
) -> None:
    agent = RMax.create(Cells4(), bins=4, known=1, sweeps=3, tolerance=tolerance, discount=1.0)
    agent.learn((1.5,), 0, -1.0, (1.5,), 0, False)  # each sweep finds one step more in this circle
    assert agent.values.tolist() == [[0.0], [value], [0.0], [0.0]]


# Fitted Q iteration


def chain_batch() -> Batch:
    """Every step of the chain, three times."""
    cells, actions = np.meshgrid(np.arange(5), np.arange(2))
    cells, actions = np.tile(cells.ravel(), 3), np.tile(actions.ravel(), 3)
    following = np.where(actions == 1, cells + 1, np.maximum(cells - 1, 0))
    points, next_points = np.array([cells, following], np.float64)[..., None] + 0.5
    return Batch(points, actions, -np.ones(30), next_points, following < 5)


@pytest.mark.parametrize("growths", [1, 2])
@pytest.mark.parametrize("discount", [0.5, 0.9])
def test_trees_with_a_leaf_for_each_cell_find_the_exact_values(growths: int, discount: float) -> None:
    fit = Fit(discount, every=1, growths=growths, iterations=10, trees=3, leaf=1)
    forests = fitted(chain_batch(), fit, np.random.default_rng(1))
    points = np.arange(0.5, 5.0)[:, None]
    found = np.stack([forest.predict(forest.leaves(points)) for forest in forests], axis=1)
    assert found == pytest.approx(chain_values(discount), rel=1e-12)


@pytest.mark.parametrize("rounds", [1, 2, 3])
def test_each_round_looks_one_step_farther(rounds: int) -> None:
    fit = Fit(1.0, every=1, growths=1, iterations=rounds, trees=3, leaf=1)
    forests = fitted(chain_batch(), fit, np.random.default_rng(1))
    points = np.arange(0.5, 5.0)[:, None]
    assert forests[1].predict(forests[1].leaves(points)).tolist() == [
        -float(min(rounds, 5 - cell)) for cell in range(5)
    ]


def test_first_trees_are_randomized_and_later_ones_grown_to_the_values_found(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    grown = []

    class Recorded(Forest):
        def __init__(self, points: Any, targets: Any, tries: int, **parameters: Any) -> None:
            grown.append((tries, targets))
            super().__init__(points, targets, tries, **parameters)

    monkeypatch.setattr(agents.algorithms.fitted_q_iteration, "Forest", Recorded)
    batch = chain_batch()
    wide = batch._replace(
        observations=np.repeat(batch.observations, 2, axis=1),
        next_observations=np.repeat(batch.next_observations, 2, axis=1),
    )
    fit = Fit(0.5, every=1, growths=2, iterations=10, trees=1, leaf=1)
    fitted(wide, fit, np.random.default_rng(1))
    assert [tries for tries, _ in grown] == [1, 1, 2, 2]
    assert np.unique(grown[0][1]).size == 15  # noise, by which no two steps are alike
    assert grown[2][1] == pytest.approx(np.tile(chain_values(0.5)[:, 0], 3), rel=1e-12)


def test_forest_predicts_what_scikit_learn_does_and_can_be_filled_anew() -> None:
    rng = np.random.default_rng(1)
    points, others = rng.random((200, 2)), rng.random((50, 2))
    targets, new = rng.random(200), rng.random(200)
    forest = Forest(points, targets, 2, n_estimators=5, min_samples_leaf=3, random_state=1)
    leaves = forest.leaves(others)
    assert forest.predict(leaves) == pytest.approx(forest.trees.predict(others), rel=1e-12)
    forest.fill(new)
    means = [[new[own == leaf].mean() for own, leaf in zip(forest.own.T, row)] for row in leaves]
    assert forest.predict(leaves) == pytest.approx(np.mean(means, axis=1), rel=1e-12)


QUICK = {
    "every": 2,
    "growths": 2,
    "iterations": 3,
    "trees": 2,
    "resolution": (7, 9),
    "memory": 200,
    "hold": 8,
}


def quick(**parameters: Any) -> Any:
    return FittedQIteration.create(Hill(), rng=np.random.default_rng(1), **{**QUICK, **parameters})


def test_fine_grid_has_the_predictions_at_its_centres() -> None:
    agent, hill = quick(), Hill()
    for row in np.random.default_rng(1).uniform(hill.low, hill.high, (150, 2)):
        for action in range(3):
            agent.learn(tuple(row), action, row[0] * action, tuple(row + 0.01 * action), 0, False)
    rng = np.random.default_rng()
    rng.bit_generator.state = agent.rng.bit_generator.state
    agent.begin_episode()
    forests = fitted(agent.batch, agent.fit, rng)
    width, height = 1.8 / 7, 0.14 / 9
    for cell in (0, 1, 8, 9, 30, 62):
        centre = [(-1.2 + (cell // 9 + 0.5) * width, -0.07 + (cell % 9 + 0.5) * height)]
        expected = [float(f.predict(f.leaves(np.array(centre)))[0]) for f in forests]
        assert agent.values[cell].tolist() == pytest.approx(expected, rel=1e-12)
        assert agent.greedy(centre[0]) == int(np.argmax(agent.values[cell]))
    assert len(np.unique(agent.values)) > 10


def test_batch_is_fitted_every_few_episodes_once_each_action_was_taken() -> None:
    agent, learned = quick(every=2), []
    for episode in range(6):
        agent.begin_episode()
        learned.append(bool(agent.values.any()))
        agent.values[:] = 0.0
        actions = (0, 1, 0) if episode < 1 else (0, 1, 2)
        for action in actions:
            agent.learn((-0.5 + 0.1 * action, 0.0), action, -1.0, (-0.4, 0.01), 0, False)
    assert learned == [False, False, True, False, True, False]
    without = quick(every=1)
    for _ in range(3):
        without.begin_episode()
        without.learn((0.0, 0.0), 1, -1.0, (0.0, 0.0), 0, False)
    assert not without.values.any()


def test_latest_steps_are_remembered() -> None:
    agent = quick(memory=3)
    for number in range(5):
        agent.learn((0.1 * number, 0.0), number % 3, -float(number), (0.2, 0.03), 0, number == 4)
    assert sorted(zip(agent.batch.rewards, agent.batch.actions, agent.batch.goes_on)) == [
        (-4.0, 1, False),
        (-3.0, 0, True),
        (-2.0, 2, True),
    ]
    assert sorted(agent.batch.observations[:, 0]) == pytest.approx([0.2, 0.3, 0.4])
    assert np.all(agent.batch.next_observations == (0.2, 0.03))


def test_exploration_holds_an_action_for_a_while() -> None:
    agent, rng = quick(hold=5, epsilon=0.25), np.random.default_rng(1)
    agent.values[:, 1] = 1.0  # what it drives when it does not explore
    chosen = [agent.act((0.0, 0.0), 0.0, rng) for _ in range(30_000)]
    assert chosen.count(0) / 30_000 == pytest.approx(0.25 / 3, abs=0.01)
    assert chosen.count(2) / 30_000 == pytest.approx(0.25 / 3, abs=0.01)
    runs = "".join(map(str, chosen)).replace("2", " ").replace("1", " ").split()
    assert np.mean([len(one) for one in runs]) > 2.5  # held for 3 on average
    agent = quick(hold=1, epsilon=0.0)
    agent.values[:, 2] = 1.0
    assert {agent.act((0.0, 0.0), 0.0, rng) for _ in range(100)} == {2}


def test_same_seed_gives_the_same_bits() -> None:
    race = Tournament(
        (Entrant("it", FittedQIteration, **QUICK),), NEAR, Training(5, 60), Evaluation(3, 60), replicates=2
    )
    with run(race, n_jobs=1) as results, run(race, n_jobs=1) as again:
        assert bits_of(results) == bits_of(again)
        assert set(results.frame().driver) == {"pettingzoo"}
        arrays = results.arrays("it")
        assert arrays.keys() == {"values", "lengths", "test_lengths", "test_reached"}
        assert len(np.unique(arrays["values"])) > 10


def test_missing_scikit_learn_is_told_in_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(agents.algorithms.fitted_q_iteration, "find_spec", lambda name: None)
    with pytest.raises(ImportError, match=r"needs scikit-learn: pip install 'mountain-car-arena\[trees\]'$"):
        FittedQIteration.create(Hill())


@pytest.mark.statistical
def test_thirty_episodes_teach_to_drive() -> None:
    race = Tournament(
        (Entrant("it", FittedQIteration),),
        training=Training(30, 1000),
        evaluation=Evaluation(100),
        replicates=2,
    )
    with run(race, n_jobs=2) as results:
        assert results.frame().accuracy.min() > 80.0
        assert results.frame().mean_length.max() < 250.0


# Parameters


@pytest.mark.parametrize("cls", [PrioritizedSweeping, RMax])
def test_model_has_no_parameters_of_learning_step_by_step(cls: type[Any]) -> None:
    assert not {"step_size", "count_visits", "goal"} & parameters_of(cls)[0].keys()
    with pytest.raises(ValueError, match=r"^parameter of \w+ must be one of .*, got 'step_size'"):
        cls.create(Hill(), step_size=0.5)


@pytest.mark.parametrize(
    ("cls", "parameter", "bad"),
    [
        (DynaQ, "planning", -1),
        (DynaQ, "curiosity", -0.1),
        (PrioritizedSweeping, "planning", -1),
        (PrioritizedSweeping, "threshold", -0.1),
        (RMax, "known", 0),
        (RMax, "sweeps", 0),
        (RMax, "tolerance", -1.0),
        (RMax, "bins", 0),
        (FittedQIteration, "trees", 0),
        (FittedQIteration, "hold", 0),
        (FittedQIteration, "discount", 1.5),
    ],
)
def test_bad_parameter_is_refused_by_name(cls: type[Any], parameter: str, bad: Any) -> None:
    with pytest.raises(ValueError, match=f"^{parameter} must "):
        cls.create(Hill(), **{parameter: bad})


# In the arena: kinds of cells and exploration take turns; the others are slow

EDGES = [[-1.2, -0.7, -0.5, -0.45, 0.6], [-0.07, -0.01, 0.0, 0.002, 0.07]]
COMPILED: list[tuple[type[Any], dict[str, Any]]] = [
    (DynaQ, {"bins": (4, 5), "binning": "kmeans", "curiosity": 0.1}),
    (PrioritizedSweeping, {"bins": EDGES, "explore": Softmax()}),
    (RMax, {"bins": (4, 5), "known": 2}),
]


@pytest.mark.exhaustive
@pytest.mark.parametrize(("cls", "parameters"), COMPILED, ids=[cls.__name__ for cls, _ in COMPILED])
def test_compiled_agents_allocate_nothing_and_leave_the_interpreters_bits(
    cls: type[Any], parameters: dict[str, Any]
) -> None:
    assert_same_bits_from_both_drivers(cls, parameters)
    assert_allocates_nothing(cls, parameters)


@pytest.mark.exhaustive
@pytest.mark.parametrize("cls", [DynaQ, PrioritizedSweeping, RMax])
@pytest.mark.parametrize("kind", KINDS, ids=["uniform", "quantile", "kmeans"])
def test_every_kind_of_cells_and_of_exploration(cls: type[Any], kind: dict[str, Any]) -> None:
    given = {name: value for name, value in kind.items() if name in parameters_of(cls)[0]}
    assert_same_bits_from_both_drivers(cls, given)
    assert_allocates_nothing(cls, given)
