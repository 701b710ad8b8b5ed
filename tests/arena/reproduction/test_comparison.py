"""Our tables beside the paper's."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from arena import Evaluation, Results, Training, paper, quick, run
from arena.reproduction import compare, fit, published
from arena.reproduction.goodness import chi_square, chi_square_spread
from arena.results.store import Store
from arena.statistics.intervals import correlation, mean_interval
from arena.tournament.outcome import Outcome, Status


def test_the_published_tables_are_the_paper_s() -> None:
    tables = published()
    assert len(tables) == 32
    assert tables["sarsa", 20, 30] == (99.9, 140.99, 1215110.0)
    assert tables["q-learning", 20, 20] == (100.0, 157.97, 1156701.0)
    keys = [key[1:] for key in tables if key[0] == "sarsa"]
    # Section 4.3: "a positive correlation (0.983) between the number of iterations"
    iterations = [[tables[a, *key][2] for key in keys] for a in ("q-learning", "sarsa")]
    assert correlation(*iterations) == pytest.approx(0.983, abs=5e-4)
    assert correlation([tables["sarsa", *k][0] for k in keys], iterations[1]) == pytest.approx(
        -0.33, abs=5e-3
    )


def pretend(factor: float) -> Results:
    """Results whose every run is the paper's cell, iterations times ``factor``, replicates 1 apart."""
    tournament = paper(replicates=3)
    store = Store.create(None, tournament.to_dict())
    for one in tournament.runs:
        key = (
            "sarsa" if "sarsa" in one.entrant.name else "q-learning",
            *one.entrant.parameters["bins"],
        )
        accuracy, length, iterations = published()[key]
        name, replicate = one.entrant.name, one.replicate
        length += replicate - 1
        store.add(
            Outcome(name, replicate, "compiled", Status.FINISHED, accuracy, length, int(iterations * factor))
        )
    return Results(store)


def test_a_perfect_reproduction_is_seen_as_one() -> None:
    with pretend(1.0) as results:
        found = compare(results)
    assert found is not None
    assert found.accurate_cells == 32
    assert found.mean_accuracy == pytest.approx(found.paper_mean_accuracy)
    assert found.iterations_correlation == pytest.approx(1.0)
    assert found.iterations_difference == pytest.approx(0.0)
    for cell in found.cells:
        assert cell.mean_length[0] == pytest.approx(cell.paper_mean_length)
        assert cell.mean_length[1] == pytest.approx(4.3026527 / math.sqrt(3.0))  # t(0.975, 2) s / sqrt(3)
        assert cell.accuracy[1] == pytest.approx(0.0, abs=1e-9)


def test_a_tenth_less_is_seen_as_such() -> None:
    with pretend(0.9) as results:
        found = compare(results)
    assert found is not None
    assert found.iterations_correlation == pytest.approx(1.0)
    assert found.iterations_difference == pytest.approx(-10.0, abs=0.01)
    assert found.iterations_error == pytest.approx(10.0, abs=0.01)
    assert found.to_dict()["cells"][0]["algorithm"] == "q-learning"


def test_a_fit_by_hand() -> None:
    ours = np.array([[90.0, 110.0], [200.0, 200.0], [40.0, 60.0]])  # means 100, 200, 50
    found = fit(ours, [110.0, 200.0, 40.0])
    assert found.correlation == pytest.approx(np.corrcoef([100, 200, 50], [110, 200, 40])[0, 1])
    assert found.difference == pytest.approx((-100.0 / 11.0 + 0.0 + 25.0) / 3.0)
    assert found.error == pytest.approx(math.sqrt(((100.0 / 11.0) ** 2 + 25.0**2) / 3.0))
    # The replicates' distances from each other are 20 of 110 and 90, none, and 20 of 60 and 40.
    both = [math.sqrt(((20.0 / a) ** 2 + (20.0 / b) ** 2) / 3.0) for a, b in ((110.0, 60.0), (90.0, 40.0))]
    assert found.chance == pytest.approx(100.0 * np.mean(both))
    # Deviations are 10 sqrt(2), 0, 10 sqrt(2): the paper's distances of 10, any, 10 count 1/2, nothing, 1/2.
    assert found.chi_square == pytest.approx(1.0 / 2.0)
    assert chi_square_spread(ours) == pytest.approx([2.0, 2.0])
    assert chi_square(ours, [100.0, 201.0, 50.0]) == pytest.approx(0.0)
    assert math.isnan(chi_square(np.ones((2, 3)), [1.0, 2.0]))


def test_a_fit_while_runs_are_missing() -> None:
    found = fit(np.array([[100.0, math.nan], [math.nan, math.nan], [50.0, 50.0]]), [110.0, 200.0, 40.0])
    assert found.difference == pytest.approx((-100.0 / 11.0 + 25.0) / 2.0)
    assert math.isnan(found.chance)
    assert math.isnan(found.chi_square)
    assert math.isnan(fit(np.ones((3, 1)), [1.0, 1.0, 2.0]).chance)


def test_numbers_that_there_are_not_are_left_out_of_the_chi_square() -> None:
    whole = np.array([[1.0, 2.0, 3.0], [5.0, 7.0, 9.0]])
    with_unknown = np.vstack([whole, [math.nan] * 3, [4.0, math.nan, math.nan]])
    assert chi_square(with_unknown, [4.0, 5.0, 1.0, 1.0]) == chi_square(whole, [4.0, 5.0])
    assert chi_square_spread(with_unknown).tolist() == chi_square_spread(whole).tolist()


@given(st.integers(2, 8), st.integers(0, 2**32))
def test_replicates_are_about_as_far_from_each_other_as_their_deviation(count: int, seed: int) -> None:
    ours = np.random.default_rng(seed).normal(100.0, 3.0, (500, count))
    assert chi_square_spread(ours).mean() == pytest.approx(count / (count - 1), rel=1e-9)


def test_other_tournaments_are_not_compared() -> None:
    store = Store.create(None, quick().to_dict())
    with Results(store) as results:
        assert compare(results) is None


def test_mean_intervals() -> None:
    mean, half = mean_interval([1.0, 2.0, 3.0, math.nan])
    assert mean == 2.0
    assert half == pytest.approx(4.3026527 / math.sqrt(3.0))
    assert mean_interval([5.0])[0] == 5.0
    assert math.isnan(mean_interval([5.0])[1])
    assert all(map(math.isnan, mean_interval([])))
    rng = np.random.default_rng(0)
    covered = [abs(m) <= h for m, h in (mean_interval(rng.normal(size=5)) for _ in range(2000))]
    assert abs(np.mean(covered) - 0.95) < 4 * math.sqrt(0.95 * 0.05 / 2000)


def test_correlations() -> None:
    assert correlation([1, 2, 3], [2, 4, 6]) == pytest.approx(1.0)
    assert correlation([1, 2, math.nan, 3], [3, 2, 7, 1]) == pytest.approx(-1.0)
    assert math.isnan(correlation([1, 1], [2, 3]))
    assert math.isnan(correlation([1], [2]))


@pytest.mark.statistical
def test_the_paper_at_its_word_is_reproduced_in_shape_only() -> None:
    tournament = paper(replicates=2, reading="literal")
    assert tournament.training == Training()
    assert tournament.evaluation == Evaluation()
    with run(tournament, n_jobs=2) as results:
        found = compare(results)
    assert found is not None
    assert found.accurate_cells >= 30
    assert 0.7 < found.iterations_correlation < 0.9
    assert -15.0 < found.iterations_difference < -5.0


@pytest.mark.statistical
@pytest.mark.parametrize("seed", [0, 1])
def test_the_paper_comes_out_as_near_as_chance_lets_it(seed: int) -> None:
    with run(paper(replicates=10, seed=seed), n_jobs=2) as results:
        found = compare(results)
    assert found is not None
    assert found.iterations_correlation >= 0.99
    assert found.iterations_error <= 1.2
    assert 0.7 < found.iterations_chance < 1.3
