from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from agents.algorithms.value_iteration import ValueIteration, total_steps
from agents.discretization import EdgeGrid, Voronoi
from agents.optimal import optimal_steps
from arena import Entrant
from arena.execution.loops import EvaluationLoop, evaluate
from arena.testing import parametrize_with_checks
from envs import Hill
from envs.compilation import compile_loop

STARTS = np.random.default_rng(1).uniform(-0.6, -0.4, 300)


def lengths(agent: Any) -> NDArray[np.int64]:
    """Steps of greedy drives from ``STARTS``; all reach the goal."""
    starts = np.stack([STARTS, np.zeros_like(STARTS)], axis=1)
    steps, reached = np.zeros(len(starts), np.int64), np.zeros(len(starts), np.bool_)
    loop = EvaluationLoop(Hill(), agent, 3, starts, 500, steps, reached)
    compile_loop(evaluate, loop)(loop)
    assert reached.all()
    return steps


@parametrize_with_checks([Entrant("value iteration", ValueIteration, bins=(6, 7), polish=2)])
def test_contract(entrant: Any, check: Any) -> None:
    check(entrant)


@pytest.mark.parametrize("discount", [1.0, 0.9])
def test_values_solve_bellmans_equation_of_the_digitized_model(discount: float) -> None:
    agent = ValueIteration.create(Hill(), bins=(5, 4), samples=10_000, discount=discount)
    # The same again, from a lattice of points, and solved by linear algebra.
    middles = (np.arange(1000) + 0.5) / 1000
    x, v = (part.ravel() for part in np.meshgrid(-1.2 + 1.7 * middles, -0.07 + 0.14 * middles))
    chances = np.zeros((20, 3, 21))
    for action in range(3):
        speed = np.clip(v + (action - 1) * 0.001 - 0.0025 * np.cos(3.0 * x), -0.07, 0.07)
        place = np.maximum(x + speed, -1.2)
        speed[(place == -1.2) & (speed < 0.0)] = 0.0
        np.add.at(chances[:, action], (cell(x, v), np.where(place >= 0.5, 20, cell(place, speed))), 1.0)
    chances /= chances.sum(axis=2, keepdims=True)
    own = chances[np.arange(20), agent.policy]  # of the policy
    worth = np.linalg.solve(np.eye(20) - discount * own[:, :20], -np.ones(20))
    values = -1.0 + discount * chances[:, :, :20] @ worth
    assert agent.values == pytest.approx(values, rel=0.02)
    assert agent.policy.tolist() == agent.values.argmax(axis=1).tolist()
    assert agent.values.max(axis=1) == pytest.approx(values.max(axis=1), rel=0.02)  # no policy is better


def cell(x: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.int64]:
    """Of the 5x4 cells of the default hill."""
    column, row = np.floor((x + 1.2) / 1.8 * 5), np.floor((v + 0.07) / 0.14 * 4)
    found: NDArray[np.int64] = (np.clip(column, 0, 4) * 4 + np.clip(row, 0, 3)).astype(np.int64)
    return found


def test_greedy_takes_the_action_of_the_cell() -> None:
    agent = ValueIteration.create(Hill(), bins=(3, 2))
    agent.policy[:] = [0, 1, 2, 2, 1, 0]
    places = [(x, v) for x in (-1.0, -0.3, 0.4) for v in (-0.01, 0.01)]
    assert [agent.greedy(place) for place in places] == [0, 1, 2, 2, 1, 0]
    assert [agent.act(place, 0.5, np.random.default_rng(0)) for place in places] == [0, 1, 2, 2, 1, 0]


def test_finer_grids_lose_less_and_none_beats_the_optimum() -> None:
    _, optimum = optimal_steps(Hill(), STARTS)
    losses = [lengths(ValueIteration.create(Hill(), bins=bins)) - optimum for bins in (10, 40, 80)]
    assert all(loss.min() >= 0 for loss in losses)
    means = [loss.mean() for loss in losses]
    assert means[0] > 10.0 > means[1] > 2.0 > means[2]


def test_polish_shortens_drives_that_it_has_not_seen() -> None:
    plain = ValueIteration.create(Hill(), bins=20)
    polished = ValueIteration.create(Hill(), bins=20, polish=20, rng=np.random.default_rng(3))
    assert polished.values.tolist() == plain.values.tolist()
    _, optimum = optimal_steps(Hill(), STARTS)
    assert lengths(polished).mean() < lengths(plain).mean() - 2.0
    assert np.all(lengths(polished) >= optimum)


def test_polish_leaves_nothing_that_the_change_of_a_single_cell_improves() -> None:
    hill, rng = Hill(), np.random.default_rng(4)
    agent = ValueIteration.create(hill, bins=6, polish=100, rng=np.random.default_rng(4))
    starts = np.array([hill.reset(rng) for _ in range(100)])  # those that it was polished with
    policy, passed = agent.policy.copy(), np.zeros(36, np.int64)
    arguments = (hill, agent.cells, starts, policy, passed)
    judge = compile_loop(total_steps, *arguments)
    shortest = judge(*arguments)
    assert passed.sum() == shortest
    for cell in range(36):
        for action in range(3):
            policy[cell] = action
            assert judge(*arguments) >= shortest
        policy[cell] = agent.policy[cell]


def test_polish_and_cells_depend_on_the_generator_alone() -> None:
    made = [
        ValueIteration.create(Hill(), bins=8, binning="quantile", polish=1, rng=np.random.default_rng(seed))
        for seed in (5, 5, 6)
    ]
    assert made[0].policy.tolist() == made[1].policy.tolist()
    assert made[0].values.tolist() != made[2].values.tolist()


@pytest.mark.parametrize(("binning", "kind"), [("quantile", EdgeGrid), ("kmeans", Voronoi)])
def test_other_cells_are_planned_for(binning: Any, kind: type[Any]) -> None:
    agent = ValueIteration.create(Hill(), bins=20, binning=binning, rng=np.random.default_rng(7))
    assert isinstance(agent.cells, kind)
    assert lengths(agent).mean() < 130.0


def test_cell_without_points_is_avoided() -> None:
    edges = (
        (-1.2, -0.5, -0.5 + 1e-9, 0.6),
        (-0.07, 0.0, 0.07),
    )  # none of the points is between -0.5 and -0.5
    agent = ValueIteration.create(Hill(), bins=edges)
    assert np.all(agent.values[2:4] == 0.0)  # not computed
    assert np.all(agent.values[[0, 1, 4, 5]] > -1e4)  # and not counted on by the others
    assert np.all(agent.values[[0, 1, 4, 5]] < -1.0)


@pytest.mark.parametrize(
    ("parameter", "bad"),
    [("bins", 0), ("binning", "round"), ("samples", 0), ("discount", 1.1), ("polish", -1), ("polish", 0.5)],
)
def test_bad_parameter_is_refused_by_name(parameter: str, bad: Any) -> None:
    with pytest.raises((TypeError, ValueError), match=f"^{parameter} must "):
        ValueIteration.create(Hill(), **{parameter: bad})
