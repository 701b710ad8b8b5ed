"""Figures of Sutton & Barto (2018) on the Mountain Car: 10.2, 10.3, 10.4 and that panel of 12.14.

    python scripts/sutton_barto.py 10.4 --runs 100 --out figure.png

prints the numbers, with standard errors over the runs, and draws them. The car is the book's: the goal is
at the right bound, 0.5; starts are uniform in [-0.6, -0.4); epsilon is 0, the discount 1.

An episode is cut off after LIMIT steps. The first ones with a small alpha may be longer; those of weights
that diverge have no end; and, about once in thousands, a greedy car trembles for ever in the valley, where
the actions take turns at being the best. A run whose weights are no longer numbers has failed in the arena:
here it counts as LIMIT steps in each episode. The table tells how many runs failed and how many episodes,
theirs included, were cut off.
"""

import argparse
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from agents.algorithms.sarsa_lambda import SarsaLambda
from agents.algorithms.semi_gradient_sarsa import SemiGradientSarsa
from arena import Entrant, Evaluation, Results, Tournament, Training, run
from envs import Hill

HILL = Hill(max_position=0.5)
LIMIT = 5000
SHOWN = (1, 2, 5, 10, 20, 50, 100, 200, 300, 400, 500)  # episodes that the tables of curves show

TEN_FOUR = {  # n: alpha times the number of tilings; larger ones diverge
    1: np.arange(0.2, 1.61, 0.1),
    2: np.arange(0.1, 1.61, 0.1),
    4: np.arange(0.1, 1.61, 0.1),
    8: np.arange(0.1, 1.01, 0.1),
    16: np.arange(0.1, 0.71, 0.1),
}
TRACES: dict[str, dict[str, Any]] = {
    "accumulating": {"traces": "accumulating"},
    "replacing": {"traces": "replacing"},
    "clearing": {"traces": "replacing", "clear_others": True},
}
TILES: dict[str, Any] = {"tilings": 10, "tiles": 9}
LAMBDAS = (0.0, 0.2, 0.4, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99, 1.0)
ALPHAS = (0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4, 1.6, 1.8)


class Point(NamedTuple):
    """One number of a figure: the mean over the runs and its standard error."""

    curve: str
    x: float
    mean: float
    error: float
    failed: int
    cut: int
    note: str = ""


class Figure(NamedTuple):
    """What a figure shows, and how it is drawn."""

    points: Callable[[int, int, int], Iterator[Point]]
    x: str
    scale: str
    window: tuple[float, float]


def learning_curves(
    settings: dict[str, dict[str, float]], runs: int, jobs: int, seed: int
) -> Iterator[Point]:
    """Steps of each of the first 500 episodes."""
    entrants = [Entrant(name, SemiGradientSarsa, **setting) for name, setting in settings.items()]
    for name, lengths, failed in raced(entrants, 500, runs, jobs, seed):
        for episode in range(1, lengths.shape[1] + 1):
            yield point(name, episode, lengths[:, episode - 1 : episode], failed)


def figure_10_2(runs: int, jobs: int, seed: int) -> Iterator[Point]:
    """One-step Sarsa with three step sizes."""
    settings = {f"alpha {alpha}/8": {"step_size": alpha} for alpha in (0.1, 0.2, 0.5)}
    return learning_curves(settings, runs, jobs, seed)


def figure_10_3(runs: int, jobs: int, seed: int) -> Iterator[Point]:
    """One-step against eight-step Sarsa."""
    settings = {
        "n=1, alpha 0.5/8": {"n": 1, "step_size": 0.5},
        "n=8, alpha 0.3/8": {"n": 8, "step_size": 0.3},
    }
    return learning_curves(settings, runs, jobs, seed)


def figure_10_4(runs: int, jobs: int, seed: int) -> Iterator[Point]:
    """Mean steps of the first 50 episodes by n and step size."""
    entrants = [
        Entrant(f"n={n} {alpha:.1f}", SemiGradientSarsa, n=n, step_size=float(alpha))
        for n, alphas in TEN_FOUR.items()
        for alpha in alphas
    ]
    for name, lengths, failed in raced(entrants, 50, runs, jobs, seed):
        curve, alpha = name.split()
        yield point(curve, float(alpha), lengths, failed)


def figure_12_14(runs: int, jobs: int, seed: int) -> Iterator[Point]:
    """Mean steps of the first 20 episodes by lambda and kind of trace, each with its best step size."""
    entrants = [
        Entrant(f"{kind} {decay} {alpha}", SarsaLambda, **given, trace_decay=decay, step_size=alpha, **TILES)
        for kind, given in TRACES.items()
        for decay in LAMBDAS
        for alpha in ALPHAS
    ]
    found: dict[tuple[str, float], list[Point]] = {}
    for name, lengths, failed in raced(entrants, 20, runs, jobs, seed):
        kind, decay, alpha = name.split()
        one = point(kind, float(decay), lengths, failed, f"alpha {alpha}/10")
        found.setdefault((kind, float(decay)), []).append(one)
    for points in found.values():
        yield min(points, key=lambda one: one.mean)


FIGURES = {
    "10.2": Figure(figure_10_2, "episode", "log", (100, 1000)),
    "10.3": Figure(figure_10_3, "episode", "log", (100, 1000)),
    "10.4": Figure(figure_10_4, "alpha x number of tilings (8)", "linear", (210, 310)),
    "12.14": Figure(figure_12_14, "lambda", "linear", (200, 500)),
}


def raced(
    entrants: list[Entrant], episodes: int, runs: int, jobs: int, seed: int
) -> Iterator[tuple[str, NDArray[np.int64], int]]:
    """Race all; each one's name, its steps by run and episode, and how many of its runs failed."""
    training = Training(episodes, LIMIT)
    tournament = Tournament(tuple(entrants), HILL, training, Evaluation(1, 1), replicates=runs, seed=seed)
    with run(tournament, n_jobs=jobs) as results:
        for entrant in entrants:
            yield entrant.name, *steps_of(results, entrant.name, (runs, episodes))


def steps_of(results: Results, name: str, shape: tuple[int, int]) -> tuple[NDArray[np.int64], int]:
    """Steps by run and episode, LIMIT in those that failed, and how many did."""
    lengths = np.full(shape, LIMIT)
    failed = 0
    for replicate, row in enumerate(lengths):
        found = results.arrays(name, replicate)
        failed += "lengths" not in found
        row[:] = found.get("lengths", LIMIT)
    return lengths, failed


def point(curve: str, x: float, lengths: NDArray[np.int64], failed: int, note: str = "") -> Point:
    """The point for the steps by run and episode."""
    steps = lengths.mean(axis=1)
    error = steps.std(ddof=1) / np.sqrt(len(steps)) if len(steps) > 1 else np.nan
    return Point(curve, x, float(steps.mean()), float(error), failed, int((lengths == LIMIT).sum()), note)


def draw(name: str, points: list[Point], path: str) -> None:
    """Draw the curves with their standard errors into the file ``path``."""
    import matplotlib as mpl

    mpl.use("agg")
    import matplotlib.pyplot as plt

    figure, (_, axes) = FIGURES[name], plt.subplots(figsize=(8, 5.5), layout="constrained")
    for curve in dict.fromkeys(one.curve for one in points):
        x, mean, error = np.array([one[1:4] for one in points if one.curve == curve]).T
        (line,) = axes.plot(x, mean, label=curve, marker="." if len(x) < 100 else "", linewidth=1)
        axes.fill_between(x, mean - error, mean + error, alpha=0.25, color=line.get_color(), linewidth=0)
    axes.set(xlabel=figure.x, ylabel="steps per episode", yscale=figure.scale, ylim=figure.window)
    axes.set_title(f"After Sutton & Barto (2018), Figure {name}")
    axes.legend()
    plt.savefig(path, dpi=120)


def main() -> None:
    """Parse, race, print, draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("figure", choices=FIGURES)
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--jobs", type=int, default=-1)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", help="file to draw the figure into")
    arguments = parser.parse_args()
    figure = FIGURES[arguments.figure]
    points = list(figure.points(arguments.runs, arguments.jobs, arguments.seed))
    print(f"{'curve':>20} {figure.x:>30} {'steps':>8} {'error':>7} {'failed':>6} {'cut':>6}")
    for one in points:
        if figure.x != "episode" or one.x in SHOWN:
            row = f"{one.curve:>20} {one.x:30g} {one.mean:8.1f} {one.error:7.1f} {one.failed:6} {one.cut:6}"
            print(f"{row} {one.note}".rstrip())
    if arguments.out:
        draw(arguments.figure, points, arguments.out)


if __name__ == "__main__":
    main()
