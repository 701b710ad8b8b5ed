"""Agents made again from the arrays in a results file."""

from collections.abc import Iterator

import numpy as np
import pytest
from page_tournament import Broken

from agents import MomentumAgent, QLearning, RandomAgent, Sarsa
from agents.algorithms.double_q_learning import DoubleQLearning
from agents.algorithms.dyna_q import DynaQ
from agents.algorithms.sarsa_lambda import SarsaLambda
from agents.contract import Observation
from arena import Entrant, Evaluation, Results, Tournament, Training, run
from arena.results import UnknownPolicyError


class Secretive:
    """Learns a number that is no array, and drives by it."""

    def __init__(self) -> None:
        self.steps = 0

    def act(self, observation: Observation, progress: float, rng: np.random.Generator) -> int:
        return int(rng.integers(3))

    def learn(self, *transition: object) -> None:
        self.steps += 1

    def greedy(self, observation: Observation) -> int:
        right = self.steps > 0 and observation[1] >= 0.0
        return 2 if right else 0


ENTRANTS = (
    Entrant("sarsa", Sarsa, bins=(8, 9)),
    Entrant("quantiles", QLearning, bins=(6, 7), binning="quantile", initial_values=(-1.0, 0.0)),
    Entrant("clusters", QLearning, bins=(5, 5), binning="kmeans"),
    Entrant("two tables", DoubleQLearning, bins=(8, 9)),
    Entrant("model", DynaQ, bins=(8, 9)),
    Entrant("tiles", SarsaLambda, tilings=3),
    Entrant("momentum", MomentumAgent),
    Entrant("random", RandomAgent),
)


@pytest.fixture(scope="module")
def results() -> Iterator[Results]:
    failing = (Entrant("secretive", Secretive), Entrant("broken", Broken))
    tournament = Tournament(
        ENTRANTS + failing, training=Training(5, 200), evaluation=Evaluation(4, 150), replicates=2
    )
    with run(tournament, driver="pettingzoo", n_jobs=1) as found:
        yield found


@pytest.mark.parametrize("entrant", [one.name for one in ENTRANTS])
def test_it_drives_as_it_did_in_the_test(results: Results, entrant: str) -> None:
    for replicate in (0, 1):
        again = results.trained(entrant, replicate)
        arrays = results.arrays(entrant, replicate)
        for name in {"values", "visits", "weights"} & arrays.keys():
            assert np.array_equal(getattr(again.agent, name), arrays[name])
        fresh = zip(again.starts[3:], again.test_lengths[3:], again.test_reached[3:])  # others are checked
        for start, steps, reached in fresh:
            path = again.drive(float(start))
            assert path.shape == (steps + 1, 2)
            assert tuple(path[0]) == (start, 0.0)
            assert (path[-1, 0] >= again.hill.goal_position) == reached


def test_what_is_not_in_the_arrays_is_missed(results: Results) -> None:
    with pytest.raises(UnknownPolicyError, match="cannot be made again"):
        results.trained("secretive")  # the class is of this file, not installed
    with pytest.raises(UnknownPolicyError, match="replicate 1 of 'broken' failed"):
        results.trained("broken", 1)
    with pytest.raises(ValueError, match=r"entrant must be one of .* got 'nobody'"):
        results.trained("nobody")
    with pytest.raises(ValueError, match="replicate must be one that 'sarsa' has run, got 2"):
        results.trained("sarsa", 2)


def test_an_agent_that_drives_otherwise_than_it_did_is_refused(
    results: Results, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(MomentumAgent, "greedy", lambda self, observation: 0)
    with pytest.raises(UnknownPolicyError, match="'momentum' has learned more than the arrays"):
        results.trained("momentum")
