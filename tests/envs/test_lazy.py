"""Packages that import what they offer when it is asked for, as their users see them."""

import pickle

import pytest
from fresh import output_of

import arena


def test_a_name_is_imported_once_and_then_an_ordinary_attribute() -> None:
    code = "import arena; print('quick' in vars(arena)); f = arena.quick; print(vars(arena)['quick'] is f)"
    assert output_of(code).split() == ["False", "True"]


def test_public_packages_are_attributes_and_others_are_not() -> None:
    code = "import arena; print(arena.figures.race.__module__, hasattr(arena, 'execution'))"
    assert output_of(code) == "arena.figures.film False\n"


def test_a_name_that_is_not_there_is_told_as_python_tells_it() -> None:
    with pytest.raises(AttributeError, match=r"^module 'arena' has no attribute 'paperr'$"):
        getattr(arena, "paperr")  # noqa: B009 (type checkers know that it is not there)
    with pytest.raises(ImportError, match=r"^cannot import name 'paperr' from 'arena'"):
        exec("from arena import paperr")  # noqa: S102 (as above)


def test_what_is_listed_are_the_names_before_any_is_imported_and_after() -> None:
    code = "import arena; print(*dir(arena)); from arena import *; print(*dir(arena))"
    before, after = (set(line.split()) for line in output_of(code).splitlines())
    assert {*arena.__all__, "tournament"} <= before <= after


@pytest.mark.parametrize("name", arena.__all__)
def test_what_is_public_can_be_pickled(name: str) -> None:
    value = getattr(arena, name)
    assert pickle.loads(pickle.dumps(value)) is value  # noqa: S301 (our own)
