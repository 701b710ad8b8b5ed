"""What figures draw: the data in them, not their pixels."""

import io
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from made_up_results import made_up
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import LogNorm, to_hex
from matplotlib.figure import Figure

from agents import MomentumAgent, QLearning, RandomAgent, Sarsa
from agents.algorithms.sarsa_lambda import SarsaLambda
from arena import Entrant, Evaluation, Results, Tournament, Training, run, sweep
from arena.analysis import leaderboard, moving_average, scores_of
from arena.analysis.policy_map import FINE
from arena.figures import (
    draw_intervals,
    draw_learning,
    draw_pairs,
    draw_phase,
    draw_policy,
    draw_ranks,
    draw_regret,
    draw_sweep,
    draw_value,
    draw_visits,
)
from arena.figures.style import LINES
from arena.results import UnknownPolicyError
from arena.statistics.intervals import probability_of_improvement

NOISE = [0.0, 3.0, 1.0, 4.0, 2.0, 6.0, 5.0, 7.0]
STEPS = {
    "slow": [130.0 + n for n in NOISE],
    "fast": [100.0 + n for n in NOISE],
    "same": [101.0 + n for n in NOISE[::-1]],
}


@pytest.fixture(scope="module")
def results() -> Iterator[Results]:
    entrants = (
        *sweep("sarsa", Sarsa, over={"bins": [(5, 6), (7, 6), (7, 8)]}),
        Entrant("of another kind", Sarsa, bins=(4, 4), discount=0.5),
        Entrant("edges", QLearning, bins=((-1.2, -0.7, -0.2, 0.6), (-1.0, 0.0, 0.03, 1.0))),
        Entrant("tiles", SarsaLambda, tilings=2, tiles=4),
        Entrant("momentum", MomentumAgent),
        Entrant("random", RandomAgent),
    )
    tournament = Tournament(
        entrants, training=Training(52, 130), evaluation=Evaluation(5, 300), replicates=2, seed=3
    )
    with run(tournament, driver="pettingzoo", n_jobs=1) as found:
        yield found


@pytest.fixture(scope="module")
def board() -> Iterator[Results]:
    with made_up(STEPS) as found:
        yield found


def mesh(axes: Axes, number: int = 0) -> Any:
    """What a map shows, a row a velocity."""
    meshes = [one for one in axes.collections if isinstance(one, QuadMesh)]
    return np.ma.asarray(meshes[number].get_array())


def test_the_learning_curve_is_the_mean_and_the_band_all_replicates(results: Results) -> None:
    axes: Any = draw_learning(results, ["momentum", "sarsa 5x6"])
    curves = [-moving_average(results.arrays("momentum", r)["lengths"]) for r in (0, 1)]
    line, other = axes.lines
    assert np.allclose(line.get_ydata(), np.mean(curves, axis=0))
    assert list(line.get_xdata()) == list(range(50, 53))
    corners = axes.collections[0].get_paths()[0].vertices[:, 1]
    assert corners.min() == np.min(curves)
    assert corners.max() == np.max(curves) > corners.min()
    assert line.get_color() != other.get_color()
    assert line.get_linestyle() != other.get_linestyle()
    assert "mean of 50 episodes" in axes.get_ylabel()
    with pytest.raises(ValueError, match=f"at most {len(LINES)} to be told apart, got 8"):
        draw_learning(results, ["sarsa 5x6"] * 8)
    with pytest.raises(ValueError, match="window must be at most the 52 training episodes, got 53"):
        draw_learning(results, ["sarsa 5x6"], window=53)


def test_the_policy_is_drawn_cell_by_cell(results: Results) -> None:
    given: Any = Figure().add_subplot()
    agent = results.trained("sarsa 5x6", 1)
    drawn: Any = draw_policy(agent, given)
    assert drawn is given
    best = results.arrays("sarsa 5x6", 1)["values"].argmax(axis=1).reshape(5, 6)
    assert np.array_equal(mesh(given), best.T)
    x, v = np.linspace(-1.2, 0.6, 6), np.linspace(-0.07, 0.07, 7)
    assert np.allclose(drawn.collections[0].get_coordinates()[0, :, 0], x)
    assert np.allclose(drawn.collections[0].get_coordinates()[:, 0, 1], v)
    never = results.arrays("sarsa 5x6", 1)["visits"].sum(axis=1) == 0
    hatched = next(one for one in given.collections if one.get_hatch())
    assert len(hatched.get_paths()) == never.sum() > 0
    named = [text.get_text() for text in given.figure.legends[0].get_texts()]
    assert named == ["thrust left", "no thrust", "thrust right", "never visited"]


def test_cells_that_are_no_even_grid_are_drawn_where_they_are(results: Results) -> None:
    axes: Any = draw_policy(results.trained("edges"))
    assert np.allclose(axes.collections[0].get_coordinates()[0, :, 0], [-1.2, -0.7, -0.2, 0.6])
    assert np.allclose(axes.collections[0].get_coordinates()[:, 0, 1], [-0.07, 0.0, 0.03, 0.07])
    assert mesh(axes).shape == (3, 3)


def test_agents_without_cells_are_asked_on_a_fine_grid(results: Results) -> None:
    axes: Any = draw_policy(results.trained("momentum"))
    assert np.array_equal(mesh(axes), np.repeat([0, 2], FINE[1] // 2)[:, None].repeat(FINE[0], axis=1))
    assert "asked on a fine grid" in axes.get_title()
    with pytest.raises(UnknownPolicyError, match="'random' drives by chance"):
        draw_policy(results.trained("random"))


def test_visits_have_one_scale_and_add_up(results: Results) -> None:
    panels: Any = draw_visits(results.trained("sarsa 7x8")).axes[:4]
    counts = results.arrays("sarsa 7x8", 0)["visits"].reshape(7, 8, 3)
    expected = [*np.moveaxis(counts, 2, 0), counts.sum(axis=2)]
    for axes, count in zip(panels, expected, strict=True):
        assert np.array_equal(mesh(axes).filled(0), count.T)
    norms = {id(one.norm) for axes in panels for one in axes.collections if isinstance(one, QuadMesh)}
    assert len(norms) == 1
    assert isinstance(panels[0].collections[-1].norm, LogNorm)
    with pytest.raises(UnknownPolicyError, match="'tiles' counts no visits"):
        draw_visits(results.trained("tiles"))


def test_values_are_steps_to_go(results: Results) -> None:
    agent = results.trained("sarsa 5x6")
    flat, _, surface = draw_value(agent).axes
    assert surface.name == "3d"
    arrays = results.arrays("sarsa 5x6", 0)
    best, never = -arrays["values"].max(axis=1), arrays["visits"].sum(axis=1) == 0
    assert np.array_equal(np.ma.getmaskarray(mesh(flat)), never.reshape(5, 6).T)
    assert np.allclose(mesh(flat).compressed(), best.reshape(5, 6).T[~never.reshape(5, 6).T])
    tiles = results.trained("tiles")
    shown = mesh(draw_value(tiles).axes[0])
    active = np.zeros(tiles.agent.features.active, np.int64)
    tiles.agent.features.fill((-1.2 + 1.8 / FINE[0] * 10.5, -0.07 + 0.14 / FINE[1] * 20.5), active)
    assert shown[20, 10] == pytest.approx(-tiles.agent.weights[active].sum(axis=0).max())
    with pytest.raises(UnknownPolicyError, match="'momentum' has no values"):
        draw_value(results.trained("momentum"))


def test_drives_are_drawn_over_the_policy(results: Results) -> None:
    agent = results.trained("momentum")
    axes: Any = draw_phase(agent, starts=[-0.5, -0.45])
    for line, start in zip((axes.lines[0], axes.lines[2]), (-0.5, -0.45), strict=True):
        assert np.array_equal(np.transpose(line.get_data()), agent.drive(start))
    steps = len(agent.drive(-0.5)) - 1
    assert axes.lines[0].get_label() == f"from -0.50: {steps} steps"
    assert len(draw_phase(agent).lines) == 2 * 5 + 1


def test_regret_is_drawn_over_the_starts(results: Results) -> None:
    arrays = results.arrays("momentum", 0)
    starts, fewest = np.array([-0.5, -0.6, -0.4, -0.45, -0.55]), np.full(5, 90)
    axes: Any = draw_regret(results, ["momentum"], 0, starts, fewest)
    order = np.argsort(starts)
    reached = arrays["test_reached"][order]
    x, y = axes.lines[0].get_data()
    assert np.array_equal(x, starts[order][reached])
    assert np.array_equal(y, (arrays["test_lengths"] - 90)[order][reached])
    assert axes.get_ylim()[0] <= 0
    axes = draw_regret(results, ["random"], 0, starts, fewest)
    assert list(axes.lines[1].get_ydata()) == [300 - 90] * 5
    assert "crosses: not at the goal in 300 steps" in axes.get_title()


def test_a_sweep_shows_the_mean_on_each_grid(results: Results) -> None:
    scores = scores_of(results)
    figure = draw_sweep(results, scores)
    panel = figure.axes[2]
    assert panel.get_title() == "sarsa: iterations"
    assert [label.get_text() for label in panel.get_yticklabels()] == ["5", "7"]
    names = {(5, 6): "sarsa 5x6", (7, 6): "sarsa 7x6", (7, 8): "sarsa 7x8"}
    for i, j in np.ndindex(2, 2):
        n_p, n_v = (5, 7)[i], (6, 8)[j]
        shown = mesh(panel)[i, j]
        if (n_p, n_v) in names:
            row = scores.entrants.index(names[n_p, n_v])
            assert shown == scores.values["iterations"][row].mean()
            assert f"{shown:,.0f}" in [text.get_text() for text in panel.texts]
        else:
            assert shown is np.ma.masked


def test_a_sweep_needs_entrants_that_differ_only_in_their_grids(board: Results) -> None:
    with pytest.raises(ValueError, match="differ in nothing but their grids, got none"):
        draw_sweep(board, scores_of(board))


def test_intervals_are_those_of_the_leaderboard(board: Results) -> None:
    standings = leaderboard(board)
    axes: Any = draw_intervals(standings)
    assert [label.get_text() for label in axes.get_yticklabels()] == ["fast  1-2", "same  1-2", "slow  3"]
    means, middles = axes.containers
    assert list(means[0].get_xdata()) == [one.scores["steps"].value for one in standings.standings]
    ends = means[2][0].get_segments()
    for (left, right), one in zip(ends, standings.standings, strict=True):
        assert (left[0], right[0]) == pytest.approx(one.scores["steps"][1:])
    assert list(middles[0].get_xdata()) == [one.interquartile.value for one in standings.standings]


def test_places_and_pairs_are_those_of_the_leaderboard(board: Results) -> None:
    standings, scores = leaderboard(board), scores_of(board)
    shown = mesh(draw_ranks(standings))
    assert np.array_equal(shown, [one.shares for one in standings.standings])
    axes: Any = draw_pairs(scores, standings)
    order = [one.entrant for one in standings.standings]
    for i, row in enumerate(order):
        for j, column in enumerate(order):
            pair = probability_of_improvement(-np.array(STEPS[row]), -np.array(STEPS[column]))
            assert mesh(axes)[i, j] == pytest.approx(pair.value)
    dots = set(zip(*np.array(axes.lines[0].get_data()).tolist()))
    assert dots == {(0, 2), (1, 2), (2, 0), (2, 1)}


def test_names_are_text_and_colours_differ(board: Results) -> None:
    with made_up({"$x$ <b>": NOISE, "_hidden": NOISE}) as odd, warnings.catch_warnings():
        warnings.simplefilter("error")
        axes: Any = draw_pairs(scores_of(odd), leaderboard(odd))
        axes.figure.savefig(io.BytesIO(), format="svg")
        assert {label.get_text() for label in axes.get_xticklabels()} == {"$x$ <b>", "_hidden"}
    assert len({to_hex(color) for color in LINES}) == len(LINES)
