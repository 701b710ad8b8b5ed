"""Decorators that validate parameters: of named tuples, of ``create``, of one that extends another."""

import copy
import pickle
from typing import Any, NamedTuple

import cloudpickle
import numpy as np
import pytest

from agents import HarmonicRate, LinearDecay, QLearning, Softmax, UpperConfidence
from agents.parameters import (
    Count,
    NonNegative,
    Positive,
    Probability,
    extends,
    inherits,
    parameters_of,
    validated,
)
from arena import Entrant
from envs import Hill
from envs.compilation import compile_loop
from envs.foundation.checks import number


@validated
class Spring(NamedTuple):
    """A plugin's, with a rule about two of its fields."""

    stiffness: Positive
    rest: float = -0.5
    reach: Any = None

    def __post_init__(self) -> None:
        number("rest", self.rest, -self.stiffness)

    def pull(self, at: float) -> float:
        return self.stiffness * (self.rest - at)


def pull(spring: Spring, at: float) -> float:
    return spring.pull(at)


@pytest.mark.parametrize(
    "made",
    [
        lambda: Spring(2, rest=np.float64(0.5)),
        lambda: Spring(1.0)._replace(stiffness=2, rest=0.5),
        lambda: Spring._make([2, 0.5]),
        lambda: copy.deepcopy(Spring(2, 0.5)),
        lambda: pickle.loads(pickle.dumps(Spring(2, 0.5))),  # noqa: S301 (our own)
    ],
)
def test_a_validated_named_tuple_has_the_types_of_its_fields_however_it_is_made(made: Any) -> None:
    spring = made()
    assert spring == Spring(2.0, 0.5)
    assert [type(part) for part in spring] == [float, float, type(None)]
    assert type(spring) is Spring


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Spring(0), "stiffness must be greater than 0, got 0.0"),
        (lambda: Spring("x"), "stiffness must be a number, got 'x'"),  # type: ignore[arg-type]  # that is the point
        (lambda: Spring(1.0)._replace(rest=-2), "rest must be a finite number of at least -1, got -2.0"),
        (lambda: Spring(1.0)._replace(stiffness=0), "stiffness must be greater than 0, got 0.0"),
        (lambda: Spring._make((-1.0, 0.0, None)), "stiffness must be greater than 0, got -1.0"),
        (lambda: HarmonicRate(A=20), "B must be a finite number of at least 20, got 10.0"),
        (lambda: HarmonicRate()._replace(C=-1), "C must be at least 0, got -1.0"),
        (lambda: LinearDecay(until=0), "until must be in (0, 1], got 0.0"),
        (lambda: Softmax(end=0), "end must be greater than 0, got 0.0"),
        (lambda: UpperConfidence(-1), "c must be at least 0, got -1.0"),
    ],
)  # fmt: skip
def test_a_bad_field_is_told_when_it_is_made(make: Any, message: str) -> None:
    with pytest.raises((TypeError, ValueError)) as problem:
        make()
    assert str(problem.value) == message


def test_missing_and_unknown_fields_are_told_as_python_does() -> None:
    with pytest.raises(TypeError, match="stiffness"):
        Spring()  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="stifness"):
        Spring(stifness=1.0)  # type: ignore[call-arg]


def test_a_validated_named_tuple_compiles_and_travels_from_a_notebook() -> None:
    assert compile_loop(pull, Spring(2.0), 0.5)(Spring(2.0), 0.5) == Spring(2.0).pull(0.5) == -2.0

    @validated
    class Local(NamedTuple):
        gain: Positive

    again = pickle.loads(cloudpickle.dumps(Local))  # noqa: S301 (our own)
    assert again(2).gain == 2.0
    with pytest.raises(ValueError, match=r"^gain must be greater than 0, got 0\.0$"):
        again(0)


class Curious(QLearning):
    """A plugin's extension of a built-in agent."""

    __slots__ = ()

    @classmethod
    @extends(QLearning.create, bins=3, omit=["goal"], explore=Softmax(2.0), discount=0.5)
    def create(cls, agent: QLearning, *, hope: NonNegative = 1.0, rng: Any = None) -> "Curious":
        """With hope."""
        agent.values[:] += hope + (0.0 if rng is None else rng.random())
        return cls(*agent)


def test_extended_parameters_are_its_own_then_the_parents_without_what_is_omitted() -> None:
    declared, free = parameters_of(Curious)
    parents, _ = parameters_of(QLearning)
    assert list(declared) == ["hope", *(name for name in parents if name != "goal")]
    assert not free
    assert declared["hope"].rule() == "float at least 0"
    changed = {"bins": 3, "discount": 0.5, "explore": Softmax(2.0)}
    for name in parents.keys() - {"goal"}:
        assert declared[name].rule() == parents[name].rule()
        assert declared[name].default == changed.get(name, parents[name].default)


def test_the_parent_is_created_with_its_parameters_and_handed_over() -> None:
    agent: Any = Curious.create(Hill(), hope=2, step_size=0.25)
    assert type(agent) is Curious
    assert (agent.cells.size, agent.update.discount, agent.policy) == (9, 0.5, Softmax(2.0))
    assert agent.update.step_size == HarmonicRate(0.25, 1.0, 0.0)
    assert np.all(agent.values == 2.0)
    assert Entrant("c", Curious, bins=2).create(Hill(), np.random.default_rng(1)).cells.size == 4


def test_both_draw_from_the_generator_that_is_given_one_after_the_other() -> None:
    agent: Any = Curious.create(Hill(), initial_values=(0.0, 1.0), hope=0.0, rng=np.random.default_rng(1))
    rng = np.random.default_rng(1)
    assert np.array_equal(agent.values, rng.random((9, 3)) + rng.random())


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"hope": -1.0}, r"^hope must be at least 0, got -1\.0$"),
        ({"discount": 2}, r"^discount must be in \[0, 1\], got 2\.0$"),
        ({"goal": "zero"}, r"^parameter of Curious must be one of .*, got 'goal'"),
    ],
)
def test_bad_parameter_of_either_is_refused_by_name(given: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Curious.create(Hill(), **given)


def test_an_omitted_parameter_may_have_another_default_but_no_unknown_one() -> None:
    def parent(task: Any, *, gain: float = 1.0, drag: "Probability" = 0.5) -> tuple[float, float]:
        return gain, drag

    def create(cls: Any, pair: tuple[float, float], *, count: Count = 2) -> Any:
        return pair * count

    doubled = extends(parent, omit=["gain"], gain=3.0)(create)
    assert doubled(Spring, None) == (3.0, 0.5, 3.0, 0.5)
    assert doubled(Spring, None, drag=1, count=1) == (3.0, 1.0)
    with pytest.raises(TypeError, match=r"^defaults must be those of inherited parameters, got \['four'\]$"):
        extends(parent, four=4)


def test_a_class_that_calls_the_create_of_its_base_may_have_parameters_of_its_own() -> None:
    class Mine(QLearning):
        __slots__ = ()

        @classmethod
        def create(cls, task: Any, *, extra: float = 1.0, **others: Any) -> Any:
            return super().create(task, **others), extra

    agent, extra = Mine.create(Hill(), bins=3, extra=2.0)
    assert (type(agent), agent.cells.size, extra) == (Mine, 9, 2.0)


def test_inherits_works_on_until_it_is_gone_and_says_so() -> None:
    def parent(task: Any, *, one: int = 1, two: int = 2, rng: Any = None) -> None: ...

    with pytest.warns(DeprecationWarning, match=r"gone in 0\.4: use agents\.parameters\.extends"):
        taken = inherits(parent, two=5)

    class Old:
        @classmethod
        @validated
        @taken
        def create(cls, task: Any, *, three: int = 3, rng: Any = None, **inherited: Any) -> Any:
            return three, inherited

    defaults = {name: parameter.default for name, parameter in parameters_of(Old)[0].items()}
    assert defaults == {"three": 3, "one": 1, "two": 5}
    assert Old.create(None, one=7) == (3, {"one": 7, "two": 5})
    with (
        pytest.warns(DeprecationWarning, match="extends"),
        pytest.raises(TypeError, match=r"^defaults must be those of inherited parameters, got \['four'\]$"),
    ):
        inherits(parent, four=4)(Old.create)
