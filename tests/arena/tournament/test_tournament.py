"""Entrants, sweeps, tournaments, readings: validated, frozen, and told as plain values."""

import dataclasses
import json
import math
import pickle
from typing import Any, NamedTuple, Self

import numpy as np
import pytest
from hand_made_agents import Leaky, Scripted

from agents import HarmonicRate, LinearDecay, MomentumAgent, QLearning, RandomAgent, Sarsa
from arena import Entrant, Evaluation, Tournament, Training, paper, quick, sweep
from envs import Hill


def test_an_entrant_knows_all_its_parameters() -> None:
    entrant = Entrant("s", Sarsa, bins=[10, 20], epsilon={"start": 0.5})
    assert entrant.parameters["bins"] == (10, 20)
    assert entrant.parameters["epsilon"] == LinearDecay(0.5, 0.01)
    assert entrant.parameters["discount"] == 0.99
    assert "rng" not in entrant.parameters
    assert entrant.to_dict() == {
        "name": "s",
        "agent": "sarsa",
        "parameters": {
            "bins": [10, 20],
            "binning": "uniform",
            "discount": 0.99,
            "step_size": {"A": 1.0, "B": 10.0, "C": 0.01},
            "epsilon": {"start": 0.5, "end": 0.01, "until": 1.0},
            "explore": None,
            "initial_values": 0.0,
            "count_visits": "step",
            "goal": "terminal",
        },
    }


def test_an_entrant_of_any_class_with_the_methods_will_do() -> None:
    entrant = Entrant("plain", Scripted, favourite=1)
    agent = entrant.create(Hill(), np.random.default_rng())
    assert isinstance(agent, Scripted)
    assert agent.favourite == 1
    assert entrant.to_dict()["agent"] == "hand_made_agents:Scripted"


# What the types forbid is passed on purpose.
entrant: Any = Entrant
tournament: Any = Tournament
evaluation: Any = Evaluation
swept: Any = sweep


class NoGreedy(NamedTuple):
    x: int = 0

    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> int:
        return 0

    def learn(self, *transition: Any) -> None:
        pass


class Demanding(NoGreedy):
    @classmethod
    def create(cls, task: Any, *, must: int) -> Self:
        return cls(must)

    def greedy(self, observation: Any) -> int:
        return 0


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: entrant("", Sarsa), "name must be a printable text that is not empty, got ''"),
        (lambda: entrant("a\x1b[2J", Sarsa), "name must be a printable text"),
        (lambda: entrant(3, Sarsa), "name must be a printable text that is not empty, got 3"),
        (lambda: entrant("s", "sarsa"), "agent must be a class, got 'sarsa'"),
        (lambda: entrant("s", NoGreedy), "agent must have the methods .* lacks greedy"),
        (lambda: entrant("s", Sarsa, bin=3), "parameter of sarsa must be .*'bin'; did you mean 'bins'"),
        (lambda: entrant("s", MomentumAgent, x=3), "parameter of momentum must be one of nothing, got 'x'"),
        (lambda: entrant("s", RandomAgent, rng=3), "parameter of random must be one of nothing, got 'rng'"),
        (lambda: entrant("s", Demanding), "parameter must of .*Demanding must be given"),
        (lambda: entrant("s", Sarsa, epsilon={"strt": 0.1}), "field of epsilon .*did you mean 'start'"),
        (lambda: entrant("s", Sarsa, step_size={"A": -1}), "step_size.A must be greater than 0, got -1"),
        (lambda: list(swept("s", Sarsa, over={"bins": []})), "sweep of bins must be a list .* got \\[\\]"),
        (lambda: list(swept("s", Sarsa, over={"bins": 3})), "sweep of bins must be a list .* got 3"),
    ],
)
def test_a_bad_entrant_is_told_in_one_sentence(make: Any, message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=message) as told:
        make()
    assert "\n" not in str(told.value)


def test_a_sweep_is_the_product_of_its_values() -> None:
    entrants = list(sweep("s", Sarsa, over={"bins": [(5, 5), (5, 9)], "discount": [0.9, 1.0]}, goal="zero"))
    assert [entrant.name for entrant in entrants] == [
        "s 5x5 discount=0.9",
        "s 5x5 discount=1.0",
        "s 5x9 discount=0.9",
        "s 5x9 discount=1.0",
    ]
    assert [entrant.parameters["discount"] for entrant in entrants] == [0.9, 1.0, 0.9, 1.0]
    assert {entrant.parameters["goal"] for entrant in entrants} == {"zero"}


ONE = Entrant("s", Sarsa)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: tournament(()), "entrants must be one or more, got none"),
        (lambda: tournament((ONE, ONE)), "entrants must have names that differ, got 's' twice"),
        (lambda: tournament(("sarsa",)), "entrants must be Entrant objects, got 'sarsa'"),
        (lambda: tournament((ONE,), replicates=0), "replicates must be at least 1, got 0"),
        (lambda: tournament((ONE,), replicates=2.5), "replicates must be an integer, got 2.5"),
        (lambda: tournament((ONE,), seed=-1), "seed must be at least 0, got -1"),
        (lambda: tournament((ONE,), hill={}), "hill must be a Hill, got {}"),
        (lambda: tournament((ONE,), training=4000), "training must be a Training, got 4000"),
        (lambda: tournament((ONE,), reading="litral"), "reading must .*; did you mean 'literal'"),
        (lambda: tournament((ONE,), name=""), "name must be a printable text"),
        (lambda: Training(episodes=0), "training episodes must be at least 1, got 0"),
        (lambda: Training(max_steps=-5), "training max_steps must be at least 1, got -5"),
        (lambda: evaluation(episodes=math.nan), "evaluation episodes must be an integer, got nan"),
        (lambda: tournament((Entrant("s", Sarsa, bins=0),)), "entrant 's': bins must be at least 1, got 0"),
        (
            lambda: tournament((Entrant("s", Sarsa, epsilon="x"),)),
            "epsilon must be LinearDecay or float .* got 'x'",
        ),
        (lambda: tournament((Entrant("s", Sarsa, discount=2),)), "entrant 's': discount must be in .0, 1."),
    ],
)
def test_a_bad_tournament_is_told_in_one_sentence(make: Any, message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=message) as told:
        make()
    assert "\n" not in str(told.value)


def test_a_tournament_is_frozen_and_travels() -> None:
    tournament = Tournament((ONE, Entrant("l", Leaky)), Hill(friction=1.0), replicates=3)
    with pytest.raises(dataclasses.FrozenInstanceError):
        tournament.seed = 3  # type: ignore[misc]
    travelled = pickle.loads(pickle.dumps(tournament))  # noqa: S301 (our own)
    assert travelled == tournament
    assert travelled.to_dict() == tournament.to_dict()
    assert json.loads(json.dumps(tournament.to_dict())) == tournament.to_dict()
    assert len(tournament.runs) == 6
    assert len({run.identity for run in tournament.runs}) == 6


def test_the_paper_s_tournament_has_the_paper_s_parameters() -> None:
    tournament = paper()
    assert tournament.training == Training(4000, 30000)
    assert tournament.evaluation == Evaluation(1000, 500)
    assert tournament.hill == Hill(goal_reward=0.0, inelastic_wall=False)  # test_readings.py says why
    assert tournament.replicates == 10
    grids = {(p, v) for p in (10, 20, 30, 40) for v in (10, 20, 30, 40)}
    for agent in (QLearning, Sarsa):
        own = [entrant for entrant in tournament.entrants if entrant.agent is agent]
        assert {entrant.parameters["bins"] for entrant in own} == grids
        for entrant in own:
            assert entrant.parameters["discount"] == 0.99
            assert entrant.parameters["epsilon"] == LinearDecay(0.6, 0.01)
            assert entrant.parameters["step_size"] == HarmonicRate(1.0, 10.0, 0.01)
    assert len(quick().entrants) == 4


def test_a_reading_sets_what_was_not_given() -> None:
    tournament = Tournament(
        (ONE, Entrant("own", Sarsa, step_size=HarmonicRate(C=0.5)), Entrant("m", MomentumAgent)),
        reading="slow-state-visits",
    )
    plain, own, momentum = tournament.entrants
    assert plain.parameters["step_size"] == HarmonicRate(C=0.001)
    assert own.parameters["step_size"] == HarmonicRate(C=0.5)
    assert momentum.parameters == {}
    assert tournament.hill.min_start == pytest.approx(-math.pi / 6 - 0.05)
    assert tournament.to_dict()["reading"] == "slow-state-visits"
    again = dataclasses.replace(tournament, replicates=2)
    assert again.entrants == tournament.entrants
    assert Tournament((ONE,), reading="explicit-euler").hill == Hill(integrator="explicit")
