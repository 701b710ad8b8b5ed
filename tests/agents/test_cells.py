"""Cells other than those of a uniform grid: given edges, quantiles, clusters."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from agents import Grid, QLearning
from agents.discretization import EdgeGrid, Voronoi, make_cells
from agents.discretization.cells import Cells, _visited
from envs import Hill

HILL = Hill()
finite = st.floats(-10, 10)
edges = st.lists(finite, min_size=2, max_size=9, unique=True).map(lambda found: tuple(sorted(found)))


def random() -> np.random.Generator:
    return np.random.default_rng(1)


def visited() -> NDArray[np.float64]:
    """The observations from which cells are made that are given ``random()``."""
    return _visited(HILL, random())


def all_of(cells: Cells, observations: NDArray[np.float64]) -> NDArray[np.int64]:
    return np.array([cells.encode(one) for one in observations])


@given(rows=st.lists(edges, min_size=1, max_size=3), data=st.data())
def test_edge_grid_is_searchsorted(rows: list[tuple[float, ...]], data: st.DataObject) -> None:
    grid = EdgeGrid.from_edges(rows)
    assert grid.bins == tuple(len(row) - 1 for row in rows)
    assert grid.size == np.prod(grid.bins)
    point = [data.draw(finite | st.sampled_from(row) | st.sampled_from([-np.inf, np.inf])) for row in rows]
    places = [int(np.searchsorted(row[1:-1], x, side="right")) for row, x in zip(rows, point, strict=True)]
    assert grid.encode(point) == np.ravel_multi_index(places, grid.bins)


def test_edges_of_a_uniform_grid_make_the_same_cells() -> None:
    grid = make_cells(HILL, (20, 30), "uniform", None)
    assert grid == Grid.over(HILL, (20, 30))
    rows = [tuple(map(float, row[:n])) for row, n in zip(grid.edges, grid.bins)]  # type: ignore[union-attr]
    same = make_cells(HILL, [(*row, high) for row, high in zip(rows, HILL.high)], "uniform", None)
    points = random().uniform(HILL.low, HILL.high, (2000, 2))
    assert np.array_equal(all_of(grid, points), all_of(same, points))


@given(
    bins=st.tuples(st.integers(1, 60), st.integers(1, 60)),
    share=st.tuples(st.floats(0, 1), st.floats(0, 1)),
    data=st.data(),
)
def test_digitize_is_numpy_s_to_the_bit(
    bins: tuple[int, int], share: tuple[float, float], data: st.DataObject
) -> None:
    cells = make_cells(HILL, bins, "digitize", None)
    assert cells.size == bins[0] * bins[1]
    numbers, point = [], []
    for low, high, n, part in zip(HILL.low, HILL.high, bins, share, strict=True):
        edges = np.linspace(low, high, n)
        edge = data.draw(st.sampled_from(list(edges)))
        x = data.draw(st.sampled_from([low + part * (high - low), edge, np.nextafter(edge, -1.0)]))
        x = min(max(x, low), high)
        numbers.append(int(np.digitize(x, edges)) - 1)
        point.append(float(x))
    assert divmod(cells.encode(point), bins[1]) == tuple(numbers)


def test_digitizing_leaves_one_cell_less_with_rest_in_the_middle_of_one() -> None:
    cells = make_cells(HILL, 20, "digitize", None)
    at_rest = [cells.encode((-0.5, v)) for v in (-0.0036, 0.0, 0.0036)]
    assert len(set(at_rest)) == 1
    assert cells.encode((HILL.max_position, HILL.max_velocity)) == 20 * 20 - 1
    below = np.nextafter(HILL.high, -1.0).tolist()
    assert cells.encode(below) == 18 * 20 + 18


def test_quantile_bins_hold_about_equally_many() -> None:
    cells, seen = make_cells(HILL, (6, 9), "quantile", random()), visited()
    assert isinstance(cells, EdgeGrid)
    assert cells.bins == (6, 9)
    both = np.stack(np.unravel_index(all_of(cells, seen), cells.bins), axis=1)
    for found, n in zip(both.T, cells.bins):
        counts = np.bincount(found, minlength=n)
        assert np.abs(counts - len(seen) / n).max() <= 0.02 * len(seen) / n


def test_quantiles_that_coincide_are_one_edge() -> None:
    seen = visited()
    rest = np.mean(seen[:, 0] == HILL.min_position)  # the wall, where many observations are the same
    cells = make_cells(HILL, (1200, 1), "quantile", random())
    assert rest > 2 / 1200
    assert isinstance(cells, EdgeGrid)
    assert cells.bins == (len(np.unique(np.quantile(seen[:, 0], np.linspace(0, 1, 1201)))) - 1, 1)
    assert cells.bins[0] < 1200


def test_voronoi_cell_is_that_of_the_nearest_centre() -> None:
    cells, points = (
        make_cells(HILL, (4, 5), "kmeans", random()),
        random().uniform(HILL.low, HILL.high, (500, 2)),
    )
    assert isinstance(cells, Voronoi)
    assert cells.size == 20
    distances = ((points[:, None] / cells.scale - cells.centres) ** 2).sum(axis=2)
    found = all_of(cells, points)
    assert np.array_equal(found, distances.argmin(axis=1))
    assert len(np.unique(found)) > 10


def test_first_of_equally_near_centres_is_the_cell() -> None:
    assert Voronoi(np.array([[0.0], [2.0], [2.0], [4.0]]), (2.0,)).encode((6.0,)) == 1


def test_clusters_are_where_the_car_has_been() -> None:
    cells, seen = make_cells(HILL, (4, 5), "kmeans", random()), visited()
    assert isinstance(cells, Voronoi)
    assert cells.scale == pytest.approx(seen.std(axis=0))
    points = seen / cells.scale
    nearest = ((points[:, None] - cells.centres) ** 2).sum(axis=2).argmin(axis=1)
    means = np.array([points[nearest == cell].mean(axis=0) for cell in range(20)])
    assert np.abs(means - cells.centres).max() < 0.1  # Lloyd's iteration has nearly settled


@pytest.mark.parametrize("binning", ["quantile", "kmeans"])
def test_learned_cells_come_from_the_generator_given(binning: Any) -> None:
    one, same, other = (make_cells(HILL, (4, 5), binning, np.random.default_rng(seed)) for seed in (1, 1, 2))
    points = random().uniform(HILL.low, HILL.high, (500, 2))
    assert np.array_equal(all_of(one, points), all_of(same, points))
    assert not np.array_equal(all_of(one, points), all_of(other, points))


@pytest.mark.parametrize(
    "cells",
    [
        EdgeGrid.from_edges([(0.0, 1.0, 5.0), (0.0, 2.0, 3.0)]),
        Voronoi(np.array([[0.0, 0.0], [4.0, 4.0]]), (1.0, 1.0)),
    ],
)
def test_cell_is_the_only_active_feature(cells: Cells) -> None:
    active = np.full(1, -1)
    cells.fill((4.0, 2.5), active)
    assert cells.active == 1
    assert active.tolist() == [cells.encode((4.0, 2.5))] == [cells.size - 1]


@pytest.mark.parametrize(
    ("bins", "binning"),
    [
        ([[0.0, 1.0]], "uniform"),
        ([[0.0, 1.0], [1.0]], "uniform"),
        ([[0.0, 1.0], [1.0, 0.0]], "uniform"),
        ([[0.0, 1.0], [0.0, float("nan")]], "uniform"),
        ([[0.0, 1.0], 3], "uniform"),
        ([[0.0, 1.0], [0.0, 1.0]], "quantile"),
        (0, "uniform"),
        ((3, 0), "kmeans"),
        (3, "uniforms"),
    ],
)
def test_bad_bins_are_refused(bins: Any, binning: Any) -> None:
    with pytest.raises((TypeError, ValueError), match=r"^bin(s|ning) must "):
        QLearning.create(HILL, bins=bins, binning=binning)
