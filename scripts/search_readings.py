"""Does a search that begins with the paper's text find the reading ``as-run``, or a better one?

    python scripts/search_readings.py

Each answer to what the text leaves open, or what a program may have done otherwise, is an axis: the start,
what n counts and how fast the step size falls with it, the grid, the goal step and its reward, the table at
first, the wall, the end of the positions, when Q-learning draws its action, the end of epsilon's fall. The
search changes, again and again, that one answer which brings our iterations nearest to ten cells of the
paper's Table 2, by their root mean square difference in one replicate; where no change of one helps, that of
two; until neither does. It begins at the text, then at answers that are drawn.

Each end is a line of a Markdown table (docs/readings.md). Choosing the best of many is lucky; so the ends are
run again, all 32 cells, with other seeds and more replicates, and only that is a result. ``chance`` says how
near a perfect reading would come.
"""

import argparse
import math
import random
from collections.abc import Iterator
from functools import cache
from itertools import combinations, product
from typing import Any

from elimination import EarlyQLearning, iterations_of

from agents import HarmonicRate, LinearDecay, QLearning, Sarsa
from arena import Evaluation, Tournament, Training, run, sweep
from arena.reproduction import Fit, fit, published
from arena.tournament.builtin import PAPER_BINS
from envs import Hill

CENTRE = -math.pi / 6.0
STARTS = {"U(-0.6, -0.4)": (-0.6, -0.4)} | {
    f"within {half:g} of -pi/6": (CENTRE - half, CENTRE + half) for half in (0.0, 0.01, 0.05, 0.1)
}
# Of each question the first answer is the text's.
ANSWERS: dict[str, tuple[Any, ...]] = {
    "start": tuple(STARTS),
    "n counts": ("step", "episode", "state"),
    "C": (0.01, 0.0, 0.001, 0.002, 0.005, 0.02),
    "grid": ("n cells", "n edges"),
    "goal": ("terminal", "bootstrap", "zero"),
    "reward of the goal": (-1.0, 0.0),
    "Q-learning draws": ("before", "after"),
    "table": ("0", "U(-2, 0)", "U(-1, 0)", "U(0, 1)", "-1"),
    "wall": ("stops", "does not stop"),
    "positions end at": (0.6, math.pi / 6.0),
    "epsilon falls": ("to the end", "to the half"),
}
Choice = tuple[Any, ...]  # an answer to each question
SEARCHED = 1_000_000  # the seed of the search
MOST_CHANGES = 2  # at once
FEW_BINS = [(10, 10), (10, 40), (20, 20), (40, 10), (40, 40)]


def tournament(
    chosen: Choice, bins: list[tuple[int, int]], replicates: int, seed: int, training: Training
) -> Tournament:
    """The paper's with these grids, under these answers."""
    answers = dict(zip(ANSWERS, chosen, strict=True))
    table = answers["table"]
    low, high = STARTS[answers["start"]]
    parameters: dict[str, Any] = {
        "step_size": HarmonicRate(C=answers["C"]),
        "count_visits": answers["n counts"],
        "goal": answers["goal"],
        "initial_values": tuple(map(float, table[2:-1].split(","))) if table[0] == "U" else float(table),
        "epsilon": LinearDecay(until=0.5 if answers["epsilon falls"] == "to the half" else 1.0),
        "binning": "digitize" if answers["grid"] == "n edges" else "uniform",
    }
    hill = Hill(
        min_start=low,
        max_start=high,
        inelastic_wall=answers["wall"] == "stops",
        max_position=answers["positions end at"],
        goal_reward=answers["reward of the goal"],
    )
    q_learning = QLearning if answers["Q-learning draws"] == "after" else EarlyQLearning
    entrants = (
        *sweep("q-learning", q_learning, over={"bins": bins}, **parameters),
        *sweep("sarsa", Sarsa, over={"bins": bins}, **parameters),
    )
    return Tournament(entrants, hill, training, Evaluation(1, 1), replicates, seed, "search")


def fit_of(
    chosen: Choice, bins: list[tuple[int, int]], replicates: int, seed: int, training: Training
) -> Fit:
    """How near our iterations are to the paper's, under these answers."""
    race = tournament(chosen, bins, replicates, seed, training)
    paper = [row[2] for key, row in published().items() if key[1:] in bins]
    with run(race) as results:
        return fit(iterations_of(race, results), paper)


@cache
def error(chosen: Choice, training: Training) -> float:
    """What the search minimizes."""
    return fit_of(chosen, FEW_BINS, 1, SEARCHED, training).error


def neighbours(chosen: Choice, changes: int) -> Iterator[Choice]:
    """All that differ in so many answers."""
    for places in combinations(range(len(ANSWERS)), changes):
        options = [[a for a in list(ANSWERS.values())[place] if a != chosen[place]] for place in places]
        for answers in product(*options):
            changed = dict(zip(places, answers, strict=True))
            yield tuple(changed.get(place, answer) for place, answer in enumerate(chosen))


def descent(chosen: Choice, training: Training) -> Choice:
    """Where the search ends that begins with these answers."""
    changes = 1
    while changes <= MOST_CHANGES:
        best = min(neighbours(chosen, changes), key=lambda choice: error(choice, training))
        if error(best, training) < error(chosen, training):
            chosen, changes = best, 1
        else:
            changes += 1
    return chosen


def described(chosen: Choice) -> str:
    """The answers that are not the text's."""
    changed = [
        f"{name}: {answer:g}" if isinstance(answer, float) else f"{name}: {answer}"
        for (name, options), answer in zip(ANSWERS.items(), chosen, strict=True)
        if answer != options[0]
    ]
    return "; ".join(changed) or "none"


def main() -> None:
    """Parse, search, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--starts", type=int, default=6, help="of the search; the first is the text")
    parser.add_argument("--replicates", type=int, default=10, help="of the ends, when they are run again")
    parser.add_argument("--episodes", type=int, default=Training.episodes, help="fewer to try it out")
    arguments = parser.parse_args()
    if arguments.replicates < 2:
        parser.error(f"--replicates must be at least 2, got {arguments.replicates}")
    training, rng = Training(arguments.episodes), random.Random(0)  # noqa: S311
    print(
        "| start | end: what is not in the text | in the search | root mean square | correlation | chance |"
    )
    print("|---|---|---:|---:|---:|---:|")
    for number in range(arguments.starts):
        options = ANSWERS.values()
        start = tuple(answers[0] if number == 0 else rng.choice(answers) for answers in options)
        end = descent(start, training)
        found = fit_of(end, PAPER_BINS, arguments.replicates, 0, training)
        print(
            f"| {'drawn' if number else 'the text'} | {described(end)} | {error(end, training):.2f}% "
            f"| {found.error:.2f}% | {found.correlation:.3f} | {found.chance:.2f}% |",
            flush=True,
        )


if __name__ == "__main__":
    main()
