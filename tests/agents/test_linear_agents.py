"""What the linear agents share, and all of them in the arena."""

import math
from typing import Any

import numpy as np
import pytest
from bits import bits_of
from compiled_agents import assert_allocates_nothing
from linear_walks import make, step, weights

from agents import Grid, LinearDecay
from agents.algorithms.linear import epsilon_greedy_of
from agents.algorithms.sarsa_lambda import SarsaLambda
from agents.algorithms.semi_gradient_sarsa import SemiGradientSarsa
from agents.algorithms.true_online_sarsa import TrueOnlineSarsa
from agents.algorithms.watkins_q_lambda import WatkinsQLambda
from agents.discretization import TileCoding
from arena import Entrant, Evaluation, Tournament, Training, run
from envs import Hill

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


# Two tilings with tiles of length 2 on the line: where x = 1, features 0 and 4 are active; where x = 3,
# features 1 and 5 (see test_tile_coding).


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


@pytest.mark.exhaustive
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


@pytest.mark.exhaustive
@pytest.mark.parametrize(("cls", "given"), SETTINGS, ids=NAMES)
def test_compiled_agents_allocate_nothing(cls: type[Any], given: dict[str, Any]) -> None:
    assert_allocates_nothing(cls, given)


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
