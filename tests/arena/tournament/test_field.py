"""The built-in tournament of all kinds of agents."""

import dataclasses
import re
import subprocess
import sys
from pathlib import Path

import pytest
from paths import ROOT

from agents.registry import BUILT_IN
from arena import Evaluation, Tournament, Training, field, run
from arena.statistics.intervals import mean_interval
from arena.tournament import load_tournament

FIXED = ["tutorial", "xiao", "momentum", "random", "value-iteration", "optimal"]


def test_every_built_in_agent_that_races_in_a_moment_is_in_the_field() -> None:
    entered = {entrant.agent for entrant in field().entrants}
    slow = {"fitted-q-iteration"}
    assert {name for name, agent in BUILT_IN.items() if agent not in entered} <= slow


@pytest.mark.exhaustive
def test_the_field_races_compiled() -> None:
    short = Tournament(
        field(replicates=1).entrants,
        training=Training(episodes=3, max_steps=200),
        evaluation=Evaluation(episodes=2, max_steps=200),
        replicates=1,
    )
    frame = run(short, n_jobs=2).frame()
    assert set(frame["driver"]) == {"compiled"}
    assert set(frame["status"]) == {"finished"}


@pytest.mark.docs
def test_the_search_goes_on_where_it_stopped_and_writes_a_tournament(tmp_path: Path) -> None:
    script = str(ROOT / "scripts" / "tune_field.py")
    for trials in ("1", "2"):
        options = ["--agent", "expected-sarsa", "--trials", trials, "--write", "found.toml"]
        done = subprocess.run(
            [sys.executable, script, *options],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
            timeout=300,
        )
        assert done.returncode == 0, done.stderr
        assert f"# best of {trials} trials" in done.stdout
    found = load_tournament(tmp_path / "found.toml")
    assert [entrant.name for entrant in found.entrants] == ["expected-sarsa", *FIXED]


@pytest.mark.docs
@pytest.mark.parametrize("name", ["watkins-q-lambda", "q-learning", "xiao"])
def test_the_readme_shows_what_the_field_prints(name: str) -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    (shown,) = re.findall(rf"^ \S+ +{name} +(\S+ ± \S+) +(\S+) +(\S+) +(\S+)$", readme, re.MULTILINE)
    whole = field()
    entrants = tuple(one for one in whole.entrants if one.name == name)
    with run(dataclasses.replace(whole, entrants=entrants), n_jobs=2) as results:  # others change nothing
        frame = results.frame()
    steps, error = mean_interval(frame["steps"])
    length = frame["mean_length"].mean()
    told = f"{steps:.1f} ± {error:.1f}", f"{frame['accuracy'].mean():.1f}", f"{length:.1f}"
    assert shown == (*told, f"{frame['iterations'].mean():,.0f}")
