"""The paper's Figures 1 and 2: what is drawn."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from arena import random_walk
from arena.figures import draw_hill, draw_lengths
from arena.figures.walks import save_figure
from arena.reproduction import study
from arena.walks.distributions import fit_all
from envs import Hill

HILL = Hill(omega=2.0, min_position=-1.5, goal_position=0.3, min_start=-0.9, max_start=-0.7)


@pytest.fixture
def axes() -> Axes:
    return Figure().add_subplot()


def drawn(axes: Axes) -> dict[str, np.ndarray]:
    """Points of the lines, by label, shape (points, 2)."""
    return {str(line.get_label()): np.asarray(line.get_xydata()) for line in axes.get_lines()}


def test_the_hill_is_drawn_with_car_goal_and_starts(axes: Axes) -> None:
    assert draw_hill(axes, HILL) is axes
    lines = drawn(axes)
    for label in ("y = sin 2x", "starts", "car", "goal"):
        assert lines[label][:, 1] == pytest.approx(np.sin(2.0 * lines[label][:, 0]))
    assert lines["y = sin 2x"][[0, -1], 0].tolist() == [-1.5, 0.6]
    assert lines["starts"][[0, -1], 0] == pytest.approx([-0.9, -0.7])
    assert lines["car"][0, 0] == pytest.approx(-0.8)
    assert lines["goal"][0, 0] == 0.3
    assert "units of length" in axes.get_xlabel()
    assert "units of length" in axes.get_ylabel()


def test_the_lengths_are_drawn_in_80_bins_with_the_fits_to_scale(axes: Axes) -> None:
    lengths = np.random.default_rng(1).exponential(1000.0, 3000)
    fits = fit_all(lengths, bootstraps=1)
    assert draw_lengths(axes, lengths, fits) is axes
    heights = [bar.get_height() for bar in axes.patches]  # type: ignore[attr-defined]
    expected, edges = np.histogram(lengths, 80)
    assert heights == expected.tolist()
    for fit in fits:
        x, y = drawn(axes)[fit.family.name].T
        inside = np.diff(fit.family.law.cdf([lengths.min(), lengths.max()], *fit.parameters))[0]
        assert np.trapezoid(y, x) / (edges[1] - edges[0]) == pytest.approx(3000 * inside, rel=0.02)
    assert "steps" in axes.get_xlabel()
    assert len({(line.get_color(), str(line.get_linestyle())) for line in axes.get_lines()}) == 6


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_both_are_saved(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"walk{suffix}"
    save_figure(study([random_walk(5, HILL, n_jobs=1)], 1), path)
    start = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}[suffix]
    assert path.read_bytes().startswith(start)
