"""Each check of the contract suite can fail, and tells of the rule that is broken."""

import re

import pytest
from bad_agents import (
    BreaksFarAway,
    ChoosesMinusOne,
    ChoosesThree,
    DividesByZero,
    DrawsAnywhere,
    DrawsFromNumpy,
    DrawsFromRandom,
    DrawsInVain,
    DrawsNumbersByHand,
    DrawsOtherwiseWhenMade,
    ForgetsTheLastCell,
    HoldsALock,
    KeepsWhatCannotBeSaved,
    LearnsWhenTested,
    RaisesFarAway,
    ReturnsBool,
    ReturnsFloat,
    SharesADictionary,
    SharesAList,
)

from arena import Entrant
from arena.testing import check_agent, findings
from arena.testing.checks import CHECKS

OTHER_BITS = "leaves other bits"
NO_INTEGER = r"envs.InvalidTypeError: action must be an integer, got np\.float64\(\d\.0\)"
NAMES = [check.__name__.removeprefix("check_").replace("_", " ") for check in CHECKS]
BAD: dict[type, dict[str, str]] = {  # each with all that is found, as a pattern
    ChoosesThree: {
        "actions are valid": r"act\(\[.*\]\) must be less than 3 and not negative, got 3",
        "survives hostile transitions": r"act\(\[.*\]\) must be less than 3 and not negative, got 3",
        "same seed same bits": "IndexError: index 3 is out of bounds",
        "independent of others": "envs.InvalidValueError: action must be less than 3, got 3",
        "travels": "envs.InvalidValueError: action must be less than 3, got 3",
        "evaluation does not learn": "IndexError: index 3 is out of bounds",
        "saves and loads": "IndexError: index 3 is out of bounds",
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
    },
    DrawsInVain: {"independent of others": "it draws from the global random numbers; all must come from"},
    DrawsOtherwiseWhenMade: {
        "same seed same bits": f"a second run with the same seed {OTHER_BITS}",
        "independent of others": f"a run beside another entrant, .*{OTHER_BITS}",
        "travels": f"a run of its copy {OTHER_BITS}",
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
