"""The contract suite: every registered agent holds to it, and each of its checks can fail."""

import inspect
import json
import math
import random
import re
import threading
from pathlib import Path
from typing import Any, NamedTuple, Self

import numpy as np
import pytest
from hand_made_agents import Leaky, Scripted, Uncompilable
from numpy.typing import NDArray

from agents import registry
from agents.baselines import DoesNotLearn
from agents.registry import all_agents
from arena import Entrant
from arena.cli import main
from arena.testing import check_agent, findings, parametrize_with_checks
from arena.testing.checks import CHECKS, Check

Table = NDArray[np.float64]
NAMES = [check.__name__.removeprefix("check_").replace("_", " ") for check in CHECKS]
LOCK = threading.Lock()

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


# Agents that break one rule each


class Good(NamedTuple):
    """Holds to every rule; the others change one method."""

    values: Table
    n_actions: int

    @classmethod
    def create(cls, task: Any) -> Self:
        return cls(np.zeros(task.n_actions), task.n_actions)

    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> Any:
        return int(rng.random() * self.n_actions)

    def learn(
        self,
        observation: Any,
        action: int,
        reward: float,
        next_observation: Any,
        next_action: int,
        terminated: bool,
    ) -> None:
        self.values[action] += 0.1 * (abs(next_observation[1]) - self.values[action])

    def greedy(self, observation: Any) -> Any:
        return 2 if observation[1] >= 0.0 else 0


class ChoosesThree(Good):
    __slots__ = ()

    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> Any:
        return int(rng.random() * 3.5)


class ChoosesMinusOne(Good):
    __slots__ = ()

    def greedy(self, observation: Any) -> Any:
        return 2 if observation[1] >= 0.0 else -1


class ReturnsFloat(Good):
    __slots__ = ()

    def greedy(self, observation: Any) -> Any:
        return np.sign(observation[1]) + 1.0


class ReturnsBool(Good):
    __slots__ = ()

    def greedy(self, observation: Any) -> Any:
        return bool(observation[1] >= 0.0)


class ForgetsTheLastCell(Good):
    """Ten cells, and the upper corner of the box is in the eleventh."""

    __slots__ = ()

    def greedy(self, observation: Any) -> Any:
        return [0, 0, 0, 0, 1, 1, 2, 2, 2, 2][int((observation[0] + 1.2) / (0.6 + 1.2) * 10)]


class BreaksFarAway(Good):
    """NaN when the car jumps farther than any car can."""

    __slots__ = ()

    def learn(
        self,
        observation: Any,
        action: int,
        reward: float,
        next_observation: Any,
        next_action: int,
        terminated: bool,
    ) -> None:
        if abs(next_observation[0] - observation[0]) > 1.0:
            self.values[action] = math.nan


class RaisesFarAway(Good):
    __slots__ = ()

    def learn(
        self,
        observation: Any,
        action: int,
        reward: float,
        next_observation: Any,
        next_action: int,
        terminated: bool,
    ) -> None:
        self.values[action] += math.log(1.5 - abs(next_observation[0] - observation[0]))


class LearnsWhenTested(Good):
    __slots__ = ()

    def greedy(self, observation: Any) -> Any:
        self.values[0] += 1.0
        return 2 if observation[1] >= 0.0 else 0


class SharesAList(Good):
    """What one run has seen, the next one knows."""

    __slots__ = ()

    seen: list[float] = []  # noqa: RUF012 (on purpose)

    def learn(
        self,
        observation: Any,
        action: int,
        reward: float,
        next_observation: Any,
        next_action: int,
        terminated: bool,
    ) -> None:
        self.seen.append(next_observation[0])
        self.values[action] = len(self.seen)


class DrawsFromNumpy(Good):
    __slots__ = ()

    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> Any:
        return int(np.random.random() * self.n_actions)  # noqa: NPY002 (on purpose)


class DrawsFromRandom(Good):
    __slots__ = ()

    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> Any:
        return int(random.random() * self.n_actions)  # noqa: S311 (on purpose)


class DrawsInVain(Good):
    """Its bits are right; those of an agent beside it would not be."""

    __slots__ = ()

    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> Any:
        np.random.random()  # noqa: NPY002 (on purpose)
        return int(rng.random() * self.n_actions)


class DrawsOtherwiseWhenMade(Good):
    """Its generator is its own, and begins anywhere."""

    __slots__ = ()

    @classmethod
    def create(cls, task: Any) -> Self:
        return cls(np.random.default_rng().random(3), task.n_actions)

    def learn(
        self,
        observation: Any,
        action: int,
        reward: float,
        next_observation: Any,
        next_action: int,
        terminated: bool,
    ) -> None:
        self.values[action] += 1.0


class SharesADictionary(DoesNotLearn):
    """What one agent has seen, the next one knows, until all is seen; no array shows it."""

    seen: dict[float, bool] = {}  # noqa: RUF012 (on purpose)

    def greedy(self, observation: Any) -> int:
        self.seen[round(float(observation[0]), 2)] = True
        return len(self.seen) % 2


class DrawsAnywhere(DoesNotLearn):
    """Its generator begins anywhere; no array shows it."""

    def __init__(self) -> None:
        self.rng = np.random.default_rng()

    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> int:
        return int(self.rng.integers(3))

    def greedy(self, observation: Any) -> int:
        return 1


class HoldsALock(Good):
    __slots__ = ()

    @classmethod
    def create(cls, task: Any, *, lock: Any = LOCK) -> Self:
        with lock:
            return cls(np.zeros(task.n_actions), task.n_actions)


class KeepsWhatCannotBeSaved(Good):
    """Writes into an array that says it is constant: a checkpoint leaves it out."""

    __slots__ = ()

    @classmethod
    def create(cls, task: Any) -> Self:
        made = cls(np.zeros(task.n_actions), task.n_actions)
        made.values.flags.writeable = False
        return made

    def learn(
        self,
        observation: Any,
        action: int,
        reward: float,
        next_observation: Any,
        next_action: int,
        terminated: bool,
    ) -> None:
        self.values.flags.writeable = True
        self.values[action] += 1.0
        self.values.flags.writeable = False

    def greedy(self, observation: Any) -> Any:
        return 2 if self.values.sum() > 0.0 else 0


class DrawsNumbersByHand(Good):
    """A generator of one's own; machine integers overflow where Python's grow."""

    __slots__ = ()

    def learn(
        self,
        observation: Any,
        action: int,
        reward: float,
        next_observation: Any,
        next_action: int,
        terminated: bool,
    ) -> None:
        state = int(self.values[action]) + action
        self.values[action] = (state * 6364136223846793005 + 1442695040888963407) // 7 % 1000


class DividesByZero(Good):
    """The interpreter raises, machine code goes on with infinity."""

    __slots__ = ()

    def learn(
        self,
        observation: Any,
        action: int,
        reward: float,
        next_observation: Any,
        next_action: int,
        terminated: bool,
    ) -> None:
        zero = 1.0 if terminated else 0.0
        self.values[action] = 0.0 if 1.0 / zero > 0.0 else 1.0


OTHER_BITS = "leaves other bits"
NO_INTEGER = r"envs.InvalidTypeError: action must be an integer, got np\.float64\(\d\.0\)"
BAD: dict[type, dict[str, str]] = {  # each with all that is found, as a pattern
    ChoosesThree: {
        "actions are valid": r"act\(\[.*\]\) must be less than 3 and not negative, got 3",
        "survives hostile transitions": r"act\(\[.*\]\) must be less than 3 and not negative, got 3",
        "same seed same bits": "IndexError: index 3 is out of bounds",
        "independent of others": "envs.InvalidValueError: action must be less than 3, got 3",
        "travels": "envs.InvalidValueError: action must be less than 3, got 3",
        "evaluation does not learn": "IndexError: index 3 is out of bounds",
        "saves and loads": "IndexError: index 3 is out of bounds",
        "compiled is interpreted": "ValueError: action must be one of the hill's",
    },
    ChoosesMinusOne: {
        "actions are valid": r"greedy\(\[.*\]\) must be less than 3 and not negative, got -1",
        "survives hostile transitions": r"greedy\(\[.*\]\) must be less than 3 and not negative, got -1",
        "same seed same bits": "envs.InvalidValueError: action must be at least 0, got -1",
        "independent of others": "envs.InvalidValueError: action must be at least 0, got -1",
        "travels": "envs.InvalidValueError: action must be at least 0, got -1",
        "compiled is interpreted": "ValueError: action must be one of the hill's",
    },
    ReturnsFloat: {
        "actions are valid": r"greedy\(\[.*\]\) must return an integer, got np\.float64\(0\.0\)",
        "survives hostile transitions": r"greedy\(\[.*\]\) must return an integer, got np\.float64\(0\.0\)",
        "same seed same bits": NO_INTEGER,
        "independent of others": NO_INTEGER,
        "travels": NO_INTEGER,
        "compiled is interpreted": NO_INTEGER,
    },
    ReturnsBool: {
        "actions are valid": r"greedy\(\[.*\]\) must return an integer, got False",
        "survives hostile transitions": r"greedy\(\[.*\]\) must return an integer, got False",
        "same seed same bits": "envs.InvalidTypeError: action must be an integer, got (True|False)",
        "independent of others": "envs.InvalidTypeError: action must be an integer, got (True|False)",
        "travels": "envs.InvalidTypeError: action must be an integer, got (True|False)",
        "compiled is interpreted": "envs.InvalidTypeError: action must be an integer, got (True|False)",
    },
    ForgetsTheLastCell: {
        "actions are valid": "IndexError: list index out of range",
        "survives hostile transitions": "IndexError: list index out of range",
        "evaluation does not learn": "IndexError: list index out of range",
        "saves and loads": "IndexError: list index out of range",
    },
    BreaksFarAway: {"survives hostile transitions": "values has NaN after hostile transitions"},
    RaisesFarAway: {"survives hostile transitions": "ValueError: math domain error"},
    LearnsWhenTested: {"evaluation does not learn": "greedy changes values; it must not learn"},
    SharesAList: {
        "same seed same bits": f"a second run with the same seed {OTHER_BITS}",
        "independent of others": f"a run beside another entrant, .*{OTHER_BITS}",
        "travels": f"a run of its copy {OTHER_BITS}",
    },
    DrawsFromNumpy: {
        "same seed same bits": f"a second run with the same seed {OTHER_BITS}",
        "independent of others": f"a run beside another entrant, .*{OTHER_BITS}",
        "travels": f"a run of its copy {OTHER_BITS}",
        "compiled is interpreted": f"the compiled run {OTHER_BITS}",
    },
    DrawsFromRandom: {
        "same seed same bits": f"a second run with the same seed {OTHER_BITS}",
        "independent of others": f"a run beside another entrant, .*{OTHER_BITS}",
        "travels": f"a run of its copy {OTHER_BITS}",
        "compiled is interpreted": f"the compiled run {OTHER_BITS}",
    },
    DrawsInVain: {"independent of others": "it draws from the global random numbers; all must come from"},
    DrawsOtherwiseWhenMade: {
        "same seed same bits": f"a second run with the same seed {OTHER_BITS}",
        "independent of others": f"a run beside another entrant, .*{OTHER_BITS}",
        "travels": f"a run of its copy {OTHER_BITS}",
        "compiled is interpreted": f"the compiled run {OTHER_BITS}",
    },
    SharesADictionary: {"same seed same bits": "a second run with the same seed chooses other actions"},
    DrawsAnywhere: {"same seed same bits": "a second run with the same seed chooses other actions"},
    HoldsALock: {"travels": r"TypeError: cannot pickle '_thread\.lock' object"},
    KeepsWhatCannotBeSaved: {"saves and loads": r"greedy\(\[.*\]\) differs after saving and loading"},
    DrawsNumbersByHand: {"compiled is interpreted": f"the compiled run {OTHER_BITS}"},
    DividesByZero: {
        "actions are valid": "ZeroDivisionError: float division by zero",
        "survives hostile transitions": "ZeroDivisionError: float division by zero",
        "evaluation does not learn": "ZeroDivisionError: float division by zero",
        "same seed same bits": "ZeroDivisionError: float division by zero",
        "independent of others": "ZeroDivisionError: float division by zero",
        "travels": "ZeroDivisionError: float division by zero",
        "saves and loads": "ZeroDivisionError: float division by zero",
        "compiled is interpreted": "ZeroDivisionError: float division by zero",
    },
}


@pytest.mark.parametrize("bad", BAD, ids=lambda bad: bad.__name__)
def test_each_rule_that_an_agent_breaks_is_told_and_no_other(bad: type) -> None:
    found = {one.check: one.reason for one in findings(Entrant("bad", bad)) if one.status == "failed"}
    assert found.keys() == BAD[bad].keys()
    for check, reason in found.items():
        assert re.match(BAD[bad][check], reason)
        assert "\n" not in reason


def test_every_check_can_fail() -> None:
    assert {check for expected in BAD.values() for check in expected} == set(NAMES)


@pytest.mark.parametrize("bad", [LearnsWhenTested, HoldsALock])
def test_check_agent_raises_the_first_rule_that_is_broken(bad: type) -> None:
    (check, reason), *_ = BAD[bad].items()
    with pytest.raises(AssertionError, match=f"^{bad.__name__}: {check}: {reason}$"):
        check_agent(bad)


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
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """The name of a file with a good and a bad agent, in the current folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(registry, "_registered", {})
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
