"""Readings of the paper: what they set, which is the paper's, and which will go."""

import numpy as np
import pytest

from agents import QLearning, Sarsa
from arena import Entrant, Tournament, field, paper, quick
from arena.tournament.readings import READINGS, RETIRED
from envs import Hill


def test_the_paper_is_read_as_it_was_run_and_the_others_at_their_word() -> None:
    assert paper().reading == "as-run"
    assert {quick().reading, field().reading, Tournament((Entrant("q", QLearning),)).reading} == {"literal"}


def test_as_run_is_four_parameters_of_hill_and_agent() -> None:
    tournament = paper(replicates=1)
    assert tournament.hill == Hill(inelastic_wall=False, goal_reward=0.0)
    for entrant in tournament.entrants:
        changed = {"binning": "digitize", "goal": "bootstrap", "bins": entrant.parameters["bins"]}
        assert {**entrant.parameters, **changed} == entrant.parameters
        assert entrant.agent(*entrant.create(tournament.hill, np.random.default_rng(0)))
    literal = paper(replicates=1, reading="literal")
    assert literal.hill == Hill()
    assert [one.name for one in literal.entrants] == [one.name for one in tournament.entrants]


def test_a_reading_leaves_what_was_given() -> None:
    given = Entrant("s", Sarsa, binning="uniform", goal="zero")
    (entrant,) = Tournament((given,), reading="as-run").entrants
    assert (entrant.parameters["binning"], entrant.parameters["goal"]) == ("uniform", "zero")


@pytest.mark.parametrize("name", RETIRED)
def test_a_reading_of_before_works_and_says_in_which_version_it_goes(name: str) -> None:
    with pytest.warns(FutureWarning, match=f"^reading '{name}' goes in version 0.4: 'as-run' explains"):
        (entrant,) = Tournament((Entrant("q", QLearning),), reading=name).entrants
    assert entrant.parameters.items() >= RETIRED[name].parameters.items()
    assert name not in READINGS


@pytest.mark.parametrize("bad", ["asrun", None, ["as-run"]])
def test_an_unknown_reading_is_refused(bad: object) -> None:
    with pytest.raises(ValueError, match=r"^reading must be one of as-run, constant-rate, .*, got"):
        Tournament((Entrant("q", QLearning),), reading=bad)  # type: ignore[arg-type]
