import copy
import math
import pickle
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from agents import Grid
from envs import Hill
from envs.compilation import compile_loop

Floats = NDArray[np.float64]
BOUNDS = st.floats(-1e6, 1e6) | st.integers(-40, 40).map(lambda tenths: tenths / 10)
PAPER = Grid.over(Hill(), (20, 30))


@st.composite
def grids(draw: st.DrawFn) -> Grid:
    dimensions = draw(st.integers(1, 3))
    bounds = [sorted(draw(st.tuples(BOUNDS, BOUNDS))) for _ in range(dimensions)]
    assume(all(high - low > 1e-9 * max(abs(low), abs(high), 1e-9) for low, high in bounds))
    low, high = zip(*bounds)
    return Grid(low, high, draw(st.lists(st.integers(1, 50), min_size=dimensions, max_size=dimensions)))


def interesting_values(low: float, high: float, bins: int) -> st.SearchStrategy[float]:
    """Edges and the floats next to them, what is between and outside."""
    edges = st.integers(0, bins).map(
        lambda k: float(Fraction(low) + k * (Fraction(high) - Fraction(low)) / bins)
    )
    nearby = st.builds(math.nextafter, edges, st.sampled_from([-math.inf, math.inf]))
    return edges | nearby | st.floats(low, high) | st.floats(allow_nan=False) | st.sampled_from([0.0, -0.0])


def exact_index(x: float, low: float, high: float, bins: int) -> int:
    if math.isinf(x):
        return bins - 1 if x > 0 else 0
    index = math.floor((Fraction(x) - Fraction(low)) * bins / (Fraction(high) - Fraction(low)))
    return min(max(index, 0), bins - 1)


def encode_each(grid: Grid, observations: Floats, cells: NDArray[np.int64]) -> None:
    for i in range(len(cells)):
        cells[i] = grid.encode(observations[i])


@settings(deadline=None)
@given(st.data(), grids())
def test_encode_is_the_papers_equation_in_exact_arithmetic(data: st.DataObject, grid: Grid) -> None:
    axes = list(zip(grid.low, grid.high, grid.bins))
    observation = [data.draw(interesting_values(*axis)) for axis in axes]
    indices = [exact_index(x, *axis) for x, axis in zip(observation, axes)]
    assert grid.encode(observation) == np.ravel_multi_index(indices, grid.bins)


@settings(deadline=None)
@given(st.data(), grids())
def test_encode_grows_with_each_value(data: st.DataObject, grid: Grid) -> None:
    observation = [data.draw(interesting_values(*axis)) for axis in zip(grid.low, grid.high, grid.bins)]
    d = data.draw(st.integers(0, len(observation) - 1))
    greater = list(observation)
    greater[d] = data.draw(st.floats(min_value=observation[d]))
    assert grid.encode(greater) >= grid.encode(observation)


@pytest.mark.parametrize("bins", [2, 20, 30, 150])
def test_car_at_rest_is_in_the_cell_whose_lower_edge_is_zero(bins: int) -> None:
    grid = Grid([-0.07], [0.07], bins)
    assert grid.edges[0, bins // 2] == 0.0
    assert grid.encode([0.0]) == grid.encode([-0.0]) == bins // 2
    assert grid.encode([-5e-324]) == bins // 2 - 1


def test_cells_are_numbered_with_the_last_dimension_fastest() -> None:
    assert PAPER.size == 600
    assert [PAPER.encode(x) for x in ([-1.2, -0.07], [-1.2, 0.07], [-1.1, -0.07], [0.6, 0.07])] == [
        0,
        29,
        30,
        599,
    ]


def test_edges_are_the_least_values_of_the_cells() -> None:
    grid = Grid([0.0, -1.0], [1.0, 1.0], (4, 2))
    assert grid.edges.tolist()[0][:4] == [0.0, 0.25, 0.5, 0.75]
    assert grid.edges.tolist()[1][:2] == [-1.0, 0.0]
    assert grid.edges.shape == (2, 5)
    assert np.isnan(grid.edges).tolist() == [[False] * 4 + [True], [False] * 2 + [True] * 3]
    with pytest.raises(ValueError, match="read-only"):
        grid.edges[0, 0] = 1.0


def test_grids_are_equal_by_their_bounds_and_bins() -> None:
    grid, same, other = (Grid.over(Hill(), bins) for bins in ((20, 20), 20, (20, 30)))
    assert grid == same
    assert hash(grid) == hash(same)
    assert not grid == other  # noqa: SIM201 (the operator itself is tested)
    assert not grid == (grid.low, grid.high, grid.bins)  # noqa: SIM201


def test_grids_are_unequal_when_they_are_not_equal() -> None:
    grid, same, other = (Grid.over(Hill(), bins) for bins in ((20, 20), 20, (20, 30)))
    assert grid != other
    assert not grid != same  # noqa: SIM202


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda grid: pickle.loads(pickle.dumps(grid))])  # noqa: S301
def test_grid_survives_copying(copied: Any) -> None:
    grid = copied(PAPER)
    assert type(grid) is Grid
    assert grid == PAPER
    assert grid.scale == PAPER.scale
    np.testing.assert_array_equal(grid.edges, PAPER.edges)


@pytest.mark.parametrize(
    ("error", "bins", "message"),
    [
        (ValueError, 0, "bins must be at least 1, got 0"),
        (ValueError, (3, -1), "bins must be at least 1, got -1"),
        (TypeError, 1.5, r"bins must be an integer, got 1\.5"),
        (TypeError, True, "bins must be an integer, got True"),
        (TypeError, "x", "bins must be an integer, got 'x'"),
        (TypeError, (3, None), "bins must be an integer, got None"),
        (ValueError, (3,), r"bins must have 2 numbers, one a dimension, got \(3,\)"),
        (ValueError, (3, 3, 3), r"bins must have 2 numbers, one a dimension, got \(3, 3, 3\)"),
    ],
)
def test_bad_bins_are_refused_in_one_sentence(error: type[Exception], bins: Any, message: str) -> None:
    with pytest.raises(error, match=f"^{message}$"):
        Grid.over(Hill(), bins)


def test_bins_too_fine_for_floats_are_refused() -> None:
    with pytest.raises(
        ValueError, match=r"^bins must leave cells that floats can tell apart, got 100 in \[1\.0"
    ):
        Grid([1.0], [1.0 + 1e-15], 100)


@pytest.mark.parametrize(
    ("error", "low", "high", "message"),
    [
        (ValueError, [0.0], [0.0], "high must be .* greater than 0, got 0.0"),
        (ValueError, [0.0], [math.inf], "high must be .*, got inf"),
        (ValueError, [math.nan], [1.0], "low must be .*, got nan"),
        (TypeError, ["0"], [1.0], "low must be a number, got '0'"),
        (ValueError, [0.0], [1.0, 2.0], "low and high must have one value a dimension"),
        (ValueError, [], [], "low and high must have one value a dimension"),
    ],
)
def test_bad_bounds_are_refused_in_one_sentence(
    error: type[Exception], low: list[Any], high: list[Any], message: str
) -> None:
    with pytest.raises(error, match=f"^{message}"):
        Grid(low, high, 3)


@pytest.mark.parametrize("dimensions", [1, 2, 3])
def test_compiled_encode_equals_the_interpreted_one(dimensions: int) -> None:
    grid = Grid([-1.2, -0.07, 0.0][:dimensions], [0.6, 0.07, 1.0][:dimensions], [20, 30, 7][:dimensions])
    rng = np.random.default_rng(1)
    edges = [row[np.isfinite(row)] for row in grid.edges]
    at_edges = np.stack([rng.choice(row, 1000) for row in edges], axis=1)
    wild = rng.choice([-math.inf, math.inf, math.nan, 0.0, -0.0, 1e300, -1e300, 0.3], (1000, dimensions))
    inside = rng.uniform(grid.low, grid.high, (1000, dimensions))
    observations = np.concatenate([at_edges, np.nextafter(at_edges, -math.inf), inside, wild])
    interpreted, compiled = np.zeros((2, len(observations)), np.int64)
    encode_each(grid, observations, interpreted)
    compile_loop(encode_each, grid, observations, compiled)(grid, observations, compiled)
    assert compiled.tolist() == interpreted.tolist()
    assert (interpreted.min(), interpreted.max()) == (0, grid.size - 1)


def test_replacing_a_part_of_a_grid_makes_the_rest_anew() -> None:
    replaced = Grid([0.0], [1.0], 2)._replace(bins=(9,))
    assert replaced == Grid([0.0], [1.0], 9)
    assert replaced.edges.shape == (1, 10)
