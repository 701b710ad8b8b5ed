"""Annotations as rules: what is accepted satisfies them, what is not is told in one sentence."""

import math
import re
import tomllib
import typing
from collections.abc import Callable, Mapping
from typing import (
    Annotated,
    Any,
    Generic,
    Literal,
    NamedTuple,
    NewType,
    Protocol,
    Self,
    TypedDict,
    TypeVar,
    get_args,
    get_origin,
)

import numpy as np
import pytest
from annotated_types import Ge, Gt, Interval, Le, Lt, MultipleOf
from hypothesis import given, settings
from hypothesis import strategies as st

from agents import HarmonicRate, LinearDecay, QLearning, Softmax, UpperConfidence
from agents.parameters import parameters_of
from agents.parameters.annotations import rule, settle
from arena import Entrant
from envs.foundation.checks import Validated, number


class Part(NamedTuple):
    """A part of an agent, as a table in a file."""

    gain: Any
    offset: Any = 0.0


class Spring(NamedTuple):
    """Its fields have types, bounds and defaults."""

    stiffness: Annotated[float, Gt(0)]
    rest: float = -0.5
    turns: Annotated[int, Interval(ge=1, le=9)] | None = None
    reach: float = math.inf


class Bounded(Validated, Spring):  # type: ignore[misc]  # both have _make
    """A part with a rule of its own."""

    __slots__ = ()

    def __new__(cls, stiffness: float = 1.0, rest: float = 0.0) -> Self:
        number("rest", rest, -1, stiffness)
        return super().__new__(cls, stiffness, rest)


T = TypeVar("T")


class Pair(NamedTuple, Generic[T]):
    """A generic part."""

    one: T
    other: int = 0


class Quiet(Protocol):
    """Cannot be looked for at run time."""


class Table(TypedDict):
    """Cannot be looked for either."""

    gain: float


@st.composite
def bounded(draw: st.DrawFn) -> Any:
    """A number with bounds of every kind; some leave no number at all."""
    base, (a, b) = draw(st.sampled_from([int, float])), sorted(draw(st.tuples(*[st.integers(-3, 3)] * 2)))
    below = draw(st.sampled_from([None, Ge(a), Gt(a)]))
    above = draw(st.sampled_from([None, Le(b), Lt(b)]))
    either: Any = [bound for bound in (below, above) if bound] or [Interval(ge=a, lt=b)]
    return Annotated[base, *either] if draw(st.booleans()) else Annotated[base | None, *either]


leaves = st.sampled_from([int, float, bool, str, None, Part]) | bounded()
leaves |= st.sampled_from([Literal["bold", "shy"], Literal[1, 2], Literal["bold", 1]])
annotations = st.recursive(
    leaves,
    lambda inner: (
        inner.map(lambda one: tuple[one, ...])  # type: ignore[valid-type]
        | inner.map(lambda one: typing.Sequence[one])  # type: ignore[valid-type]
        | st.tuples(inner, inner).map(lambda two: tuple[two[0], two[1]])  # type: ignore[valid-type]
        | st.tuples(inner, inner).map(lambda two: typing.Union[two[0], two[1]])  # noqa: UP007
    ),
    max_leaves=4,
)
values = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-4, 4)
    | st.integers()
    | st.floats(-4, 4)
    | st.floats()
    | st.sampled_from(["bold", "shy", "", "4", np.float64(0.5), np.int64(2), np.float64("nan"), Part(1)]),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.lists(inner, max_size=3).map(tuple)
        | st.dictionaries(st.sampled_from(["gain", "offset", "other"]), inner, max_size=3)
    ),
    max_leaves=4,
)


def satisfies(value: Any, annotation: Any) -> bool:
    """Whether a value is what an annotation says, written down anew."""
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        kind, *bounds = arguments
        found = satisfies(value, kind) and (value is None or all(_holds(value, one) for one in bounds))
    elif origin in (typing.Union, type(int | None)):
        found = any(satisfies(value, one) for one in arguments)
    elif origin is Literal:
        found = any(type(value) is type(one) and value == one for one in arguments)
    elif origin is not None:  # a list, of any number of one kind, or of as many as there are kinds
        fixed = origin is tuple and arguments[-1] is not Ellipsis
        kinds = arguments if fixed else arguments[:1] * len(value if type(value) is tuple else ())
        found = type(value) is tuple and len(value) == len(kinds) and all(map(satisfies, value, kinds))
    elif annotation is Any:
        found = True
    elif annotation in (None, type(None)):
        found = value is None
    else:
        found = type(value) is annotation and (annotation is not float or bool(np.isfinite(value)))
    return found


def _holds(value: Any, bound: Any) -> bool:
    if isinstance(bound, Interval):
        return all(_holds(value, one) for one in bound)
    return bool(
        {
            Ge: lambda: value >= bound.ge,
            Gt: lambda: value > bound.gt,
            Le: lambda: value <= bound.le,
            Lt: lambda: value < bound.lt,
        }[type(bound)]()
    )


@settings(max_examples=600, deadline=None)
@given(annotation=annotations, value=values)
def test_what_is_accepted_satisfies_the_annotation_and_what_is_not_is_one_sentence(
    annotation: Any, value: Any
) -> None:
    assert rule(annotation)
    try:
        settled = settle("gear", value, annotation)
    except (TypeError, ValueError) as problem:
        told = str(problem)
        assert re.match(r"(field of )?gear(\.\w+)* must ", told), told
        assert "got " in told
        assert not satisfies(value, annotation)
    else:
        assert satisfies(settled, annotation)
        assert satisfies(settle("gear", settled, annotation), annotation)


@given(value=values)
def test_a_table_becomes_the_named_tuple_with_all_its_fields(value: Any) -> None:
    for annotation in (Part, Part | None, float | Part):
        if isinstance(value, Mapping):
            if {"gain"} <= value.keys() <= {"gain", "offset"}:
                parts = {key: settle("gear", part, Any) for key, part in value.items()}  # lists as tuples
                assert settle("gear", value, annotation) == Part(**parts)
            else:
                with pytest.raises(
                    (TypeError, ValueError), match=r"gear must (have the field|be one of) gain"
                ):
                    settle("gear", value, annotation)


@pytest.mark.parametrize("bound", [MultipleOf(2), Ge(0)])
def test_a_bound_that_would_not_be_looked_at_is_refused(bound: Any) -> None:
    kind: Any = int if isinstance(bound, MultipleOf) else tuple[int, ...]
    with pytest.raises(
        TypeError, match=r"^gear must be a number with bounds Ge, Gt, Le, Lt or Interval, got"
    ):
        settle("gear", 3, Annotated[kind, bound])


def test_notes_in_an_annotation_are_no_bounds() -> None:
    assert settle("gear", 3, Annotated[int, "how fast", Ge(1)]) == 3
    assert rule(Annotated[int, "how fast", Ge(1)]) == "int at least 1"
    assert rule(Annotated[str, "how fast"]) == "str"


EITHER = Softmax | UpperConfidence | None
SPRING = {
    "stiffness = 0": (Spring, "gear.stiffness must be greater than 0, got 0.0"),
    "stiffness = 'x'": (Spring, "gear.stiffness must be a number, got 'x'"),
    "stiffness = 1; rest = inf": (Spring, "gear.rest must be a finite number, got inf"),
    "stiffness = 1; turns = 0.5": (Spring, "gear.turns must be int in [1, 9] or nothing, got 0.5"),
    "stiffness = 1; turns = 10": (Spring | None, "gear.turns must be in [1, 9], got 10"),
    "stiffness = 1; rest = 2": (Bounded, "gear.rest must be in [-1, 1], got 2.0"),
    "start = 2": (LinearDecay | float, "gear.start must be in [0, 1], got 2.0"),
    "end = 'x'": (LinearDecay, "gear.end must be a number, got 'x'"),
    "until = 0": (LinearDecay, "gear.until must be in (0, 1], got 0.0"),
    "A = 2; B = 1": (HarmonicRate, "gear.B must be a finite number of at least 2, got 1.0"),
    "end = 0": (EITHER, "gear.end must be greater than 0, got 0.0"),
    "c = -1": (EITHER, "gear.c must be at least 0, got -1.0"),
    "rst = 1": (
        Spring,
        "field of gear must be one of reach, rest, stiffness, turns, got 'rst'; did you mean 'rest'?",
    ),
    "cc = 1": (EITHER, "field of gear must be one of c, end, start, got 'cc'; did you mean 'c'?"),
    "strat = 1": (
        LinearDecay | float,
        "field of gear must be one of end, start, until, got 'strat'; did you mean 'start'?",
    ),
}


@pytest.mark.parametrize("fields", SPRING)
def test_a_wrong_field_of_a_table_is_one_sentence_with_its_whole_name(fields: str) -> None:
    kind, message = SPRING[fields]
    table = tomllib.loads(fields.replace("; ", "\n"))
    with pytest.raises((TypeError, ValueError), match=f"^{re.escape(message)}$"):
        settle("gear", table, kind)


def test_the_fields_of_a_named_tuple_given_in_python_are_looked_at() -> None:
    wrong: Any = Spring("x")  # type: ignore[arg-type]  # that is the point
    for kind in (Spring, Spring | None, float | Spring):
        with pytest.raises(TypeError, match=r"^gear\.stiffness must be a number, got 'x'$"):
            settle("gear", wrong, kind)
    with pytest.raises(ValueError, match=r"^gear\.turns must be in \[1, 9\], got 0$"):
        settle("gear", Spring(1.0, turns=0), Spring)
    turns: Any = np.int64(3)
    settled = settle("gear", Spring(np.float64(2), turns=turns), Spring | None)
    assert settled == Spring(2.0, turns=3)  # and the reach, at its default, may be what it is
    assert [type(part) for part in settled] == [float, float, int, float]
    with pytest.raises(ValueError, match=r"^entrant 'q': epsilon\.start must be in \[0, 1\], got 7\.0$"):
        Entrant("q", QLearning, epsilon={"start": 7})


def test_what_is_right_is_left_as_it_is() -> None:
    for value in (Spring(2.0), LinearDecay(0.5, 0.1), HarmonicRate(), Softmax(), UpperConfidence()):
        assert settle("gear", value, type(value)) is value


def test_a_generic_named_tuple_is_one() -> None:
    assert settle("gear", {"one": 1.5, "other": 2}, Pair[float]) == Pair(1.5, 2)
    assert isinstance(settle("gear", Pair(1.5, 2), Pair[float] | None), Pair)
    assert rule(Pair[float]) == "Pair"
    with pytest.raises(TypeError, match=r"^gear\.other must be an integer, got 'x'$"):
        settle("gear", {"one": 1.5, "other": "x"}, Pair[float])


def test_types_that_cannot_be_looked_for_take_anything() -> None:
    for kind in (Quiet, Table, dict[str, int], Callable[[int], int]):
        assert settle("gear", {"gain": 1}, kind) == {"gain": 1}


def test_a_new_type_has_the_bounds_of_what_it_is_made_of() -> None:
    speed = NewType("speed", Annotated[float, Ge(0)])
    with pytest.raises(ValueError, match=r"^gear must be at least 0, got -1\.0$"):
        settle("gear", -1, speed)
    with pytest.raises(ValueError, match=r"^gear must be in \[0, 3\], got 4\.0$"):
        settle("gear", 4, Annotated[speed, Le(3)])


def test_a_name_for_type_checkers_only_takes_no_bounds_away() -> None:
    class Agent:
        @classmethod
        def create(cls, task: "Unknown", *, gain: "Annotated[float, Ge(0)]" = 1.0) -> None:  # type: ignore[name-defined]  # noqa: F821
            pass

    declared, _ = parameters_of(Agent)
    assert declared["gain"].rule() == "float at least 0"


def test_a_list_of_several_kinds_names_them_all() -> None:
    assert rule(tuple[int, int]) == rule(tuple[int, ...]) == "list of int"
    assert rule(tuple[int, str]) == "list of int, str"
