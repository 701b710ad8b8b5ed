"""Parameters of agents of one's own: one sentence for a wrong one, wherever it is given."""

import json
import math
import re
from pathlib import Path

import pytest
from broken_plugins import DRIVER
from plugin_files import RACE, RUN

from agents import agent_class
from agents.parameters import parameters_of
from arena import Entrant, load, load_plugin, sweep
from arena.cli import main
from arena.testing import findings
from arena.tournament import load_tournament

pytestmark = pytest.mark.usefixtures("folder")

WRONG = {
    "step_size = 2": "step_size must be in (0, 1], got 2.0",
    "step_size = 0": "step_size must be in (0, 1], got 0.0",
    "step_size = 'big'": "step_size must be a number, got 'big'",
    "step_size = nan": "step_size must be a finite number, got nan",
    "bins = [3]": "bins must have 2 values, got [3]",
    "bins = [3, 4.5]": "bins must be an integer, got 4.5",
    "bins = 3": "bins must be a list, got 3",
    "mood = 'blod'": "mood must be one of bold, shy, got 'blod'; did you mean 'bold'?",
    "stepsize = 0.1": (
        "parameter of speedy must be one of bins, mood, step_size, got 'stepsize'; did you mean 'step_size'?"
    ),
}


@pytest.mark.parametrize("line", WRONG)
def test_a_wrong_parameter_is_one_sentence_wherever_it_is_given(
    line: str, capsys: pytest.CaptureFixture[str]
) -> None:
    name, _, text = line.partition(" = ")
    value = {"nan": float("nan")}.get(text) or json.loads(text.replace("'", '"'))
    speedy = load_plugin("speedy.py")["speedy"]
    with pytest.raises((TypeError, ValueError), match=f"^entrant 'a': {re.escape(WRONG[line])}$"):
        Entrant("a", speedy, **{name: value})
    with pytest.raises((TypeError, ValueError), match=f": {re.escape(WRONG[line])}$"):
        list(sweep("a", speedy, over={name: [value]}))
    head = 'plugins = ["speedy.py"]\n[[entrants]]\nname = "a"\nagent = "speedy"\n'
    for table, label in ((f"parameters = {{ {line} }}", "a"), (f"sweep = {{ {name} = [{text}] }}", None)):
        Path("race.toml").write_text(head + table)
        assert main(["run", "race.toml"]) == 2
        told = capsys.readouterr().err
        assert told.startswith("arena: race.toml: entrant 'a")
        assert told.endswith(f": {WRONG[line]}\n")
        assert label is None or told == f"arena: race.toml: entrant 'a': {WRONG[line]}\n"


def test_parameters_of_a_file_arrive_as_those_of_a_script() -> None:
    Path("race.toml").write_text(
        'plugins = ["speedy.py"]\n[[entrants]]\nname = "a"\nagent = "speedy"\n'
        "parameters = { step_size = 1, bins = [5, 6] }"
    )
    (entrant,) = load_tournament("race.toml").entrants
    assert entrant == Entrant("a", agent_class("speedy"), step_size=1.0, bins=(5, 6))
    assert entrant.parameters == {"step_size": 1.0, "bins": (5, 6), "mood": "bold"}


def test_a_parameter_without_a_default_must_be_given() -> None:
    Path("needy.py").write_text(f"{DRIVER}\n    def __init__(self, weight: float):\n        pass\n")
    driver = load_plugin("needy.py")["driver"]
    with pytest.raises(TypeError, match=r"^entrant 'a': parameter weight of driver must be given$"):
        Entrant("a", driver)
    assert parameters_of(driver)[0]["weight"].rule() == "float"
    assert main(["check", "needy.py"]) == 2


PLACES = """
from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

class Spring(NamedTuple):
    stiffness: float
    reach: float


@dataclass
class Driver:
    limit: float = math.inf
    seed: int = None
    spring: Spring = Spring(1.0, math.inf)
    counts: np.ndarray = field(default_factory=lambda: np.zeros(3))
"""


def test_any_default_is_accepted_made_in_the_worker_and_verified(capsys: pytest.CaptureFixture[str]) -> None:
    methods = DRIVER.partition("class Driver:\n")[2].replace("pass", "self.counts[action] += 1")
    Path("places.py").write_text(PLACES + methods)
    Path("race.toml").write_text(
        f'plugins = ["places.py"]\n{RACE.partition("[[entr")[0]}[[entrants]]\nagent = "driver"'
    )
    (entrant,) = load_tournament("race.toml").entrants
    assert set(entrant.parameters) == {"limit", "seed", "spring"}
    assert not [one for one in findings(entrant) if one.status == "failed"]
    assert main([*RUN, "--jobs", "2", "--out", "r.sqlite"]) == 0
    with load("r.sqlite") as results:
        assert results.arrays("driver")["counts"].sum() == results.runs[0]["iterations"]
    capsys.readouterr()
    assert main(["verify", "r.sqlite"]) == 0
    assert capsys.readouterr().out == "no difference\n"
    with pytest.raises(ValueError, match="limit must be a finite number, got nan"):
        Entrant("a", agent_class("driver"), limit=math.nan)
