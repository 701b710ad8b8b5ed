"""A tournament as a TOML file."""

import contextlib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from agents import HarmonicRate, MomentumAgent, Sarsa
from arena import Entrant, Evaluation, Tournament, Training, sweep
from arena.tournament import from_dict, load_tournament
from envs import Hill

WHOLE = """
name = "mine"
seed = 5
replicates = 3
reading = "literal"

[hill]
friction = 0.1
integrator = "explicit"

[training]
episodes = 40

[evaluation]
max_steps = 300

[[entrants]]
agent = "sarsa"
name = "s"
parameters = { bins = [10, 20], step_size = { A = 1.0, B = 5.0, C = 0.0 } }

[[entrants]]
agent = "sarsa"
sweep = { bins = [[5, 5], [6, 6]], discount = [0.9] }
parameters = { goal = "zero" }

[[entrants]]
agent = "momentum"
"""


def test_a_file_says_the_same_as_the_objects(tmp_path: Path) -> None:
    path = tmp_path / "race.toml"
    path.write_text(WHOLE)
    expected = Tournament(
        (
            Entrant("s", Sarsa, bins=(10, 20), step_size=HarmonicRate(1.0, 5.0, 0.0)),
            Entrant("sarsa 5x5 discount=0.9", Sarsa, bins=(5, 5), discount=0.9, goal="zero"),
            Entrant("sarsa 6x6 discount=0.9", Sarsa, bins=(6, 6), discount=0.9, goal="zero"),
            Entrant("momentum", MomentumAgent),
        ),
        Hill(friction=0.1, integrator="explicit"),
        Training(episodes=40),
        Evaluation(max_steps=300),
        replicates=3,
        seed=5,
        name="mine",
    )
    assert load_tournament(path) == expected
    assert load_tournament(path, seed=6, replicates=1).to_dict() == {
        **expected.to_dict(),
        "seed": 6,
        "replicates": 1,
    }
    assert from_dict(expected.to_dict()) == expected


def test_a_file_without_a_name_is_called_by_its_own(tmp_path: Path) -> None:
    path = tmp_path / "my race.toml"
    path.write_text('[[entrants]]\nagent = "random"\n')
    assert load_tournament(path).name == "my race"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "entrants must be one or more, got none"),
        ("name = 3 3", "is not a TOML file: .*line 1"),
        ("\x00", "is not a TOML file"),
        ("sed = 3", "key of the tournament must be one of .*'sed'; did you mean 'seed'"),
        ("hill = 3", "hill must be a table, got 3"),
        ("[hill]\nmas = 3", "key of hill must be .*did you mean 'mass'"),
        ("[hill]\nmass = nan", "mass must be a finite number greater than 0, got nan"),
        ("[hill]\nmass = -inf", "mass must be a finite number greater than 0, got -inf"),
        ("[training]\nepisodes = -1", "training episodes must be at least 1, got -1"),
        ("[training]\nepisodes = '9'", "training episodes must be an integer, got '9'"),
        ("entrants = 3", "entrants must be a list of tables, got 3"),
        ("entrants = [3]", "each of entrants must be a table, got 3"),
        ("[[entrants]]\nname = 'x'", "each of entrants must have an agent"),
        ("[[entrants]]\nagent = 'sarssa'", "agent must be .*'sarssa'; did you mean 'sarsa'"),
        ("[[entrants]]\nagent = 3", "agent must be one of .* got 3"),
        ("[[entrants]]\nagent = 'sarsa'\nbins = 3", "key of an entrant must be .*got 'bins'"),
        ("[[entrants]]\nagent = 'sarsa'\nsweep = 3", "sweep of entrant 'sarsa' must be a table, got 3"),
        (
            "[[entrants]]\nagent = 'sarsa'\nparameters = {bins = 0}",
            "entrant 'sarsa': bins must be at least 1",
        ),
        (
            "[[entrants]]\nagent = 'sarsa'\nparameters = {bins = 2}\nsweep = {bins = [3]}",
            "sweep of bins must not be of a parameter that is given, got 2",
        ),
        ("[[entrants]]\nagent = 'sarsa'\nparameters = {bins = [2, 0]}", "bins must be at least 1, got 0"),
        ("[[entrants]]\nagent = 'sarsa'\nparameters = {goal = 'z'}", "goal must be one of .* got 'z'"),
        ("replicates = 1e3\n[[entrants]]\nagent = 'sarsa'", "replicates must be an integer, got 1000.0"),
    ],
)
def test_a_bad_file_is_told_in_one_sentence_that_names_it(tmp_path: Path, content: str, message: str) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(content)
    with pytest.raises((TypeError, ValueError), match=message) as told:
        load_tournament(path)
    assert str(path) in str(told.value)


def test_a_missing_file_a_folder_and_bytes_are_told(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"there is no tournament file .*none.toml"):
        load_tournament(tmp_path / "none.toml")
    with pytest.raises(ValueError, match="Is a directory"):
        load_tournament(tmp_path)
    (tmp_path / "b.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ValueError, match="is not a TOML file"):
        load_tournament(tmp_path / "b.toml")


def test_a_sweep_over_what_is_no_mapping_is_told() -> None:
    wrong: Any = [3]
    with pytest.raises(TypeError, match=r"^over must be a mapping from parameters .*, got \[3\]$"):
        list(sweep("s", Sarsa, over=wrong))


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=6,
)
KEYS = ["name", "seed", "replicates", "reading", "hill", "training", "evaluation", "entrants", "agent"]
KEYS += ["parameters", "sweep", "mass", "episodes", "bins", "step_size", "discount"]
TABLES = st.dictionaries(st.sampled_from(KEYS), VALUES, max_size=4)
ENTRANTS = st.lists(
    st.fixed_dictionaries({"agent": st.sampled_from(["sarsa", "random"])}).flatmap(
        lambda known: TABLES.map(lambda table: {**table, **known})
    ),
    max_size=2,
)


@settings(max_examples=300, deadline=None)
@given(st.one_of(TABLES, TABLES.flatmap(lambda t: ENTRANTS.map(lambda e: {**t, "entrants": e}))))
def test_nothing_but_type_and_value_errors_comes_of_any_content(content: dict[str, object]) -> None:
    with contextlib.suppress(TypeError, ValueError):
        from_dict(content)
