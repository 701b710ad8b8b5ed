"""The contract suite: every registered agent holds to it; the command that runs it."""

import inspect
import json
import re
from pathlib import Path
from typing import Any, NamedTuple, Self

import numpy as np
import pytest
from bad_agents import Good, LearnsWhenTested
from hand_made_agents import Leaky, Scripted, Uncompilable

from agents.registry import all_agents
from arena import Entrant
from arena.cli import main
from arena.testing import check_agent, findings, parametrize_with_checks
from arena.testing.checks import CHECKS, Check

NAMES = [check.__name__.removeprefix("check_").replace("_", " ") for check in CHECKS]

# Parameters with which a slow agent is checked in a moment.
FEW_TILES = {"tilings": 2, "tiles": (4, 4)}
SMALL: dict[str, dict[str, Any]] = {
    "dyna-q": {"planning": 2},
    "fitted-q-iteration": {"every": 1, "growths": 2, "iterations": 2, "trees": 2, "resolution": 8},
    "optimal": {"bins": 60},
    "prioritized-sweeping": {"bins": (6, 6), "planning": 2},
    "r-max": {"bins": (5, 5), "known": 2, "sweeps": 5},
    "sarsa-lambda": FEW_TILES,
    "semi-gradient-sarsa": FEW_TILES,
    "true-online-sarsa": FEW_TILES,
    "value-iteration": {"bins": (6, 6), "samples": 5, "polish": 1},
    "watkins-q-lambda": FEW_TILES,
}


@parametrize_with_checks(
    [
        *(Entrant(name, one.agent, **SMALL.get(name, {})) for name, one in all_agents()[0].items()),
        Entrant("allocates", Leaky),
        Entrant("interpreted", Scripted),
        Entrant("uncompilable", Uncompilable),
    ]
)
def test_contract(entrant: Entrant, check: Check) -> None:
    check(entrant)


def test_a_good_agent_passes_every_check() -> None:
    assert [(one.check, one.status) for one in findings(Entrant("good", Good))] == [
        (name, "ok") for name in NAMES
    ]
    check_agent(Good)


def test_what_does_not_apply_is_skipped_with_the_reason() -> None:
    skipped = {one.check: one.reason for one in findings(Entrant("it", Scripted)) if one.status == "skipped"}
    assert skipped == {
        "saves and loads": "it cannot be saved in the middle: an interrupted run starts anew",
        "compiled is interpreted": "it is no NamedTuple, so it runs interpreted",
    }
    skipped = {one.check: one.reason for one in findings(Entrant("it", Uncompilable)) if one.status != "ok"}
    assert list(skipped) == ["compiled is interpreted"]
    assert skipped["compiled is interpreted"].startswith("it runs interpreted: ")


class DrawsALeaning(NamedTuple):
    """Draws a number when it is made, which its run, saved and continued, draws again."""

    leaning: float

    @classmethod
    def create(cls, task: Any, *, rng: np.random.Generator) -> Self:
        return cls(rng.uniform(-0.05, 0.05))

    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> int:
        return self.greedy(observation)

    def learn(
        self,
        observation: Any,
        action: int,
        reward: float,
        next_observation: Any,
        next_action: int,
        terminated: bool,
    ) -> None:
        pass

    def greedy(self, observation: Any) -> int:
        return 2 if observation[1] >= self.leaning else 0


def test_numbers_that_are_drawn_when_the_agent_is_made_need_no_saving() -> None:
    check_agent(DrawsALeaning)


def test_parameters_of_the_agent_are_those_of_the_check() -> None:
    with pytest.raises(TypeError, match=r"^entrant 'Leaky': leak must be a number, got 'much'$"):
        check_agent(Leaky, leak="much")
    with pytest.raises(TypeError, match="lacks greedy"):
        check_agent(type("Mute", (), {"act": Good.act, "learn": Good.learn}))


def test_the_checks_leave_the_suite_s_own_entrants_and_checks_as_parameters() -> None:
    mark = parametrize_with_checks([Entrant("one", Good), Entrant("two", Leaky)]).mark
    names, pairs = mark.args
    assert names == ("entrant", "check")
    assert len(pairs) == 2 * len(CHECKS)
    assert pairs[0].id == "one-same_seed_same_bits"


# The command

FILE = f"""
from typing import Any, NamedTuple, Self

import numpy as np

Table = Any

{inspect.getsource(Good)}

{inspect.getsource(LearnsWhenTested)}
"""


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, isolated_registry: None) -> str:
    """The name of a file with a good and a bad agent, in the current folder."""
    monkeypatch.chdir(tmp_path)
    Path("drivers.py").write_text(FILE)
    return "drivers.py"


def test_the_command_tells_what_is_broken_and_exits_with_1(
    file: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["check", file]) == 1
    out, err = capsys.readouterr()
    assert err == ""
    good, bad = out.split("learns-when-tested\n")
    assert [line.split()[0] for line in good.splitlines()[1:-1]] == ["ok"] * len(CHECKS)
    assert re.fullmatch(r"  \d+ ns a step, \d+\.\d\d times the built-in Q-learning", good.splitlines()[-1])
    assert "  failed  evaluation does not learn: greedy changes values; it must not learn\n" in bad
    assert "ns a step" not in bad  # it does not matter how fast
    Path(file).write_text(FILE.partition("class LearnsWhenTested")[0])
    assert main(["check", file]) == 0


def test_the_command_prints_json(file: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", file, "--json"]) == 1
    good, bad = json.loads(capsys.readouterr().out)
    assert (good["agent"], bad["agent"]) == ("good", "learns-when-tested")
    assert good["checks"] == [{"check": name, "status": "ok", "reason": ""} for name in NAMES]
    assert good["seconds_per_step"] > 0.0
    assert good["seconds_per_step_of_q_learning"] > 0.0
    assert {one["check"]: one["reason"] for one in bad["checks"] if one["status"] == "failed"} == {
        "evaluation does not learn": "greedy changes values; it must not learn"
    }


def test_the_command_checks_an_agent_by_its_name(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "momentum"]) == 0
    assert capsys.readouterr().out.startswith("momentum\n  ok      same seed same bits\n")
    assert main(["check", "momentun"]) == 2
    assert "did you mean 'momentum'?" in capsys.readouterr().err
