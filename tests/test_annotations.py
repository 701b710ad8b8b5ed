"""Annotations as rules: what is accepted satisfies them, what is not is told in one sentence."""

import re
import typing
from collections.abc import Mapping
from typing import Annotated, Any, Literal, NamedTuple, get_args, get_origin

import numpy as np
import pytest
from annotated_types import Ge, Gt, Interval, Le, Lt, MultipleOf
from hypothesis import given, settings
from hypothesis import strategies as st

from agents.annotations import rule, settle


class Part(NamedTuple):
    """A part of an agent, as a table in a file."""

    gain: Any
    offset: Any = 0.0


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
        assert re.match(r"(field of )?gear must ", told), told
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
                assert settle("gear", value, annotation) == Part(**value)
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
