"""The model of counts."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from agents.models.cell_model import SUCCESSORS, CellModel


@given(
    steps=st.lists(
        st.tuples(st.integers(0, 5), st.floats(-4, 4), st.integers(0, SUCCESSORS - 1)),
        min_size=1,
        max_size=60,
    ),
    discount=st.floats(0, 1),
)
def test_model_expects_the_mean_of_what_it_saw(steps: list[tuple[int, float, int]], discount: float) -> None:
    worth = np.sin(np.arange(SUCCESSORS))
    model = CellModel.empty(SUCCESSORS - 1, 2)
    for step in steps:
        model.observe(*step)
    for pair in {pair for pair, _, _ in steps}:
        seen = [reward + discount * worth[cell] for which, reward, cell in steps if which == pair]
        assert model.expected(pair, worth, discount) == pytest.approx(np.mean(seen), rel=1e-9, abs=1e-9)
        assert model.tries[pair] == len(seen)
    assert_chains_hold(model, {(pair, cell) for pair, _, cell in steps})


@pytest.mark.parametrize("seed", range(20))
def test_model_that_is_full_forgets_the_rarest(seed: int) -> None:
    rng, model = np.random.default_rng(seed), CellModel.empty(15, 1)
    counts: list[dict[int, int]] = [{}, {}, {}]  # by pair, in the order of their places
    forgotten = 0
    for _ in range(60):
        pair, cell = int(rng.integers(3)), int(rng.geometric(0.15)) % 12
        model.observe(pair, 0.0, cell)
        seen = counts[pair]
        if cell not in seen and len(seen) == SUCCESSORS:
            rarest = min(seen, key=lambda one: seen[one])
            counts[pair] = seen = {cell if one == rarest else one: n for one, n in seen.items()}
            seen[cell] = 0
            forgotten += 1
        seen[cell] = seen.get(cell, 0) + 1
    for pair, seen in enumerate(counts):
        assert model.successors[pair][model.counts[pair] > 0].tolist() == list(seen)
        assert model.counts[pair][model.counts[pair] > 0].tolist() == list(seen.values())
        assert model.tries[pair] == sum(seen.values())
    assert_chains_hold(model, {(pair, cell) for pair, seen in enumerate(counts) for cell in seen})
    assert forgotten > 0


def assert_chains_hold(model: CellModel, expected: set[tuple[int, int]]) -> None:
    """The links to each cell are those of the pairs that lead there, each once."""
    found = []
    for cell in range(len(model.first)):
        link = model.first[cell]
        while link >= 0:
            assert model.successors.ravel()[link] == cell
            assert model.counts.ravel()[link] > 0
            found.append((link // SUCCESSORS, cell))
            link = model.next_link[link]
    assert sorted(found) == sorted(expected)
