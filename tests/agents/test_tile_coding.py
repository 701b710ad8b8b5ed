import copy
import math
import pickle
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from agents import Grid
from agents.discretization import TileCoding
from envs import Hill
from envs.compilation import compile_loop

Features = NDArray[np.int64]
BOOK = TileCoding.over(Hill(max_position=0.5))


@st.composite
def codings(draw: st.DrawFn) -> TileCoding:
    dimensions = draw(st.integers(1, 3))
    low = draw(st.lists(st.floats(-1e6, 1e6), min_size=dimensions, max_size=dimensions))
    high = [a + draw(st.floats(1e-3, 1e6)) for a in low]
    tiles = draw(st.lists(st.integers(1, 6), min_size=dimensions, max_size=dimensions))
    return TileCoding(low, high, draw(st.integers(1, 20)), tiles)


def filled(coding: TileCoding | Grid, observation: Any) -> list[int]:
    active = np.full(coding.active, -1, np.int64)
    coding.fill(observation, active)
    return active.tolist()


def inside(coding: TileCoding, places: list[int]) -> list[float]:
    """The middle of a cell of the lattice that all edges lie on: 1/tilings of a tile along each dimension."""
    units = [coding.tilings * n for n in coding.tiles]
    return [a + (b - a) * (k + 0.5) / n for a, b, k, n in zip(coding.low, coding.high, places, units)]


# Two tilings of [0, 4] with tiles of length 2: the first one's are [0, 2), [2, 4), [4, ...), features 0 to
# 2; the second one's are displaced by half a tile: [-1, 1), [1, 3), [3, 5), features 3 to 5.
@pytest.mark.parametrize(
    ("x", "features"),
    [
        (0.0, [0, 3]),
        (0.99, [0, 3]),
        (1.0, [0, 4]),
        (2.0, [1, 4]),
        (2.99, [1, 4]),
        (3.0, [1, 5]),
        (4.0, [2, 5]),
        (-7.0, [0, 3]),
        (9.0, [2, 5]),
        (math.nan, [0, 3]),
    ],
)
def test_tilings_of_a_line(x: float, features: list[int]) -> None:
    coding = TileCoding([0.0], [4.0], tilings=2, tiles=2)
    assert coding.size == 6
    assert filled(coding, (x,)) == features


# Four tilings of the unit square with one tile (two, displaced) along each dimension. In quarters of a tile
# they are displaced by (0, 0), (1, 3), (2, 6 mod 4 = 2), (3, 9 mod 4 = 1); a tiling has four features.
@pytest.mark.parametrize(
    ("x", "y", "features"),
    [
        (0.0, 0.0, [0, 4, 8, 12]),
        (0.25, 0.25, [0, 4 + 1, 8, 12 + 2]),
        (0.25, 0.0, [0, 4, 8, 12 + 2]),
        (0.5, 0.5, [0, 4 + 1, 8 + 3, 12 + 2]),
        (0.75, 0.5, [0, 4 + 3, 8 + 3, 12 + 2]),
        (1.0, 1.0, [3, 4 + 3, 8 + 3, 12 + 3]),
    ],
)
def test_displacement_is_1_and_3_along_the_two_dimensions(x: float, y: float, features: list[int]) -> None:
    assert filled(TileCoding([0, 0], [1, 1], tilings=4, tiles=1), (x, y)) == features


def test_book_has_eight_tilings_of_nine_by_nine() -> None:
    assert TileCoding([-1.2, -0.07], [0.5, 0.07], 8, (8, 8)) == BOOK
    assert (BOOK.active, BOOK.size) == (8, 8 * 9 * 9)
    corner = BOOK.size - 1  # the last tile of the last tiling
    assert filled(BOOK, (0.5, 0.07))[-1] == filled(BOOK, (math.inf, math.inf))[-1] == corner


def test_tiles_may_differ_along_the_dimensions() -> None:
    coding = TileCoding([0, 0], [2, 3], tilings=1, tiles=(2, 3))
    assert coding.size == 3 * 4
    assert [filled(coding, (x, y)) for x, y in ((0, 0), (0, 2.5), (1, 0), (2, 3))] == [[0], [2], [4], [11]]


@settings(deadline=None)
@given(st.data(), codings())
def test_one_feature_of_each_tiling_is_active_whatever_the_observation(
    data: st.DataObject, coding: TileCoding
) -> None:
    observation = [data.draw(st.floats() | st.floats(a, b)) for a, b in zip(coding.low, coding.high)]
    block = math.prod(n + 1 for n in coding.tiles)
    assert [feature // block for feature in filled(coding, observation)] == list(range(coding.tilings))
    assert coding.size == coding.tilings * block


@settings(deadline=None)
@given(st.data(), codings())
def test_tile_of_each_tiling_is_that_of_the_displaced_grid(data: st.DataObject, coding: TileCoding) -> None:
    places = [data.draw(st.integers(0, n * coding.tilings - 1)) for n in coding.tiles]
    expected = []
    for t in range(coding.tilings):
        shifts = [t * (2 * d + 1) % coding.tilings for d in range(len(places))]
        tile = [(k + shift) // coding.tilings for k, shift in zip(places, shifts)]
        expected.append(
            int(np.ravel_multi_index((t, *tile), (coding.tilings, *(n + 1 for n in coding.tiles))))
        )
    assert filled(coding, inside(coding, places)) == expected


@settings(deadline=None)
@given(st.data(), st.sampled_from([1, 2, 4, 8, 16]), st.integers(1, 3))
def test_neighbours_differ_in_one_tile_along_each_dimension(
    data: st.DataObject, tilings: int, dimensions: int
) -> None:
    coding = TileCoding([0.0] * dimensions, [1.0] * dimensions, tilings, 3)
    places = [data.draw(st.integers(0, 3 * tilings - 2)) for _ in range(dimensions)]
    moved = [data.draw(st.booleans()) for _ in range(dimensions)]
    neighbour = [k + step for k, step in zip(places, moved)]
    pairs = zip(filled(coding, inside(coding, places)), filled(coding, inside(coding, neighbour)))
    different = sum(a != b for a, b in pairs)
    # With a power of two all tilings are displaced differently, so that one edge is crossed at a time.
    assert different <= sum(moved)
    assert (different > 0) == any(moved)


def test_car_at_rest_is_right_of_the_edge_at_velocity_zero() -> None:
    assert filled(BOOK, (-0.5, 0.0)) == filled(BOOK, (-0.5, -0.0)) == filled(BOOK, (-0.5, 1e-9))
    assert filled(BOOK, (-0.5, 0.0)) != filled(BOOK, (-0.5, -1e-9))


def fill_each(coding: TileCoding, observations: Any, rows: Features) -> None:
    for i in range(rows.shape[0]):
        coding.fill(observations[i], rows[i])


def test_compiled_and_interpreted_features_are_the_same() -> None:
    rng = np.random.default_rng(0)
    odd = [math.nan, math.inf, -math.inf, 1e308, -1e308, 0.0, 0.5, 0.07, -0.07, -1.2]
    observations = np.array(
        [(x, v) for x in odd for v in odd] + list(rng.uniform((-1.3, -0.08), (0.6, 0.08), (200, 2)))
    )
    compiled, interpreted = np.zeros((2, len(observations), 8), np.int64)
    arguments = (BOOK, observations, compiled)
    compile_loop(fill_each, *arguments)(*arguments)
    with np.errstate(over="ignore"):
        fill_each(BOOK, observations, interpreted)
    assert np.array_equal(compiled, interpreted)
    assert len(np.unique(compiled)) > 300


def test_grid_is_a_coding_with_one_active_feature() -> None:
    grid = Grid.over(Hill(), (20, 30))
    assert grid.active == 1
    assert filled(grid, (-0.5, 0.01)) == [grid.encode((-0.5, 0.01))]


@pytest.mark.parametrize(
    ("name", "bad"),
    [("tilings", bad) for bad in (0, -1, 1.5, "8", True)]
    + [("tiles", bad) for bad in (0, (8, 0), (8,), (8, 8, 8), 2.0, ("8", "8"), True)]
    + [("low", bad) for bad in ((0.0,), (), (0.0, math.nan), (0.0, "0"), 0.0)]
    + [("high", bad) for bad in ((1.0,), (1.0, 0.0), (1.0, -1.0), (1.0, math.inf), (1.0, None))],
)
def test_bad_argument_is_refused_by_name(name: str, bad: Any) -> None:
    arguments = {"low": (0.0, 0.0), "high": (1.0, 1.0), "tilings": 8, "tiles": 8, name: bad}
    with pytest.raises((TypeError, ValueError), match=rf"^({name}|low and high) must "):
        TileCoding(**arguments)


def test_range_must_not_overflow() -> None:
    with pytest.raises(ValueError, match=r"^high - low must be a finite number"):
        TileCoding([-1e308], [1e308])


def test_copies_are_equal_and_cannot_be_told_apart() -> None:
    one, other = TileCoding([0, 0], [1, 2], 4, (3, 5)), TileCoding([0, 0], [1, 2], 4, (5, 3))
    for same in (pickle.loads(pickle.dumps(one)), copy.deepcopy(one), other._replace(tiles=(3, 5))):  # noqa: S301
        assert same == one
        assert hash(same) == hash(one)
        assert np.array_equal(same.features, one.features)
    assert one != other
    with pytest.raises(ValueError, match=r"^tiles must "):
        one._replace(tiles=(3, 0))
