"""Fitted Q iteration, and its forests."""

from typing import Any

import numpy as np
import pytest
from bits import bits_of
from chain import chain_values
from compiled_agents import NEAR

import agents.algorithms.fitted_q_iteration
from agents.algorithms.fitted_q_iteration import Fit, FittedQIteration, fitted
from agents.models.batch import Batch
from agents.models.forest import Forest
from arena import Entrant, Evaluation, Tournament, Training, run
from envs import Hill


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
            agent.learn(tuple(row), action, row[0] * action, tuple(row + 0.01 * action), False)
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
            agent.learn((-0.5 + 0.1 * action, 0.0), action, -1.0, (-0.4, 0.01), False)
    assert learned == [False, False, True, False, True, False]
    without = quick(every=1)
    for _ in range(3):
        without.begin_episode()
        without.learn((0.0, 0.0), 1, -1.0, (0.0, 0.0), False)
    assert not without.values.any()


def test_latest_steps_are_remembered() -> None:
    agent = quick(memory=3)
    for number in range(5):
        agent.learn((0.1 * number, 0.0), number % 3, -float(number), (0.2, 0.03), number == 4)
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
