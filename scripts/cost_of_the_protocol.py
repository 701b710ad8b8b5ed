"""What did the protocol of its program cost the paper? Accuracy and length with two of its parts put right.

    python scripts/cost_of_the_protocol.py --replicates 10

runs the paper's tournament under the reading ``as-run``, then with a grid of n cells in place of n edges,
with a goal that nothing follows, and with both. The mean over the 16 grids of each replicate is what is
averaged; a Markdown table has the means with their 95% intervals (docs/paper.md).
"""

import argparse
from typing import Any

import numpy as np

from agents import QLearning, Sarsa
from arena import Tournament, Training, run, sweep
from arena.statistics.intervals import mean_interval
from arena.tournament.builtin import PAPER_BINS

PUT_RIGHT: dict[str, dict[str, Any]] = {
    "as it was run": {},
    "n cells": {"binning": "uniform"},
    "a goal that nothing follows": {"goal": "terminal"},
    "both": {"binning": "uniform", "goal": "terminal"},
}


def row(
    name: str, parameters: dict[str, Any], training: Training, replicates: int, seed: int, jobs: int
) -> str:
    """One line of the table."""
    agents = {"q-learning": QLearning, "sarsa": Sarsa}
    entrants = [
        entrant
        for label, agent in agents.items()
        for entrant in sweep(label, agent, over={"bins": PAPER_BINS}, **parameters)
    ]
    tournament = Tournament(
        tuple(entrants), training=training, replicates=replicates, seed=seed, name="cost", reading="as-run"
    )
    cells = [name]
    with run(tournament, n_jobs=jobs) as results:
        frame = results.frame()
    for label in agents:
        of = frame[frame.agent == label].groupby("replicate")
        for score, digits in (("accuracy", 1), ("mean_length", 1), ("iterations", 0)):
            mean, half = mean_interval(of[score].apply(np.nanmean))
            cells.append(f"{mean:,.{digits}f} ± {half:,.{digits}f}")
    return f"| {' | '.join(cells)} |"


def main() -> None:
    """Parse, run, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--replicates", type=int, default=10)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--episodes", type=int, default=Training.episodes, help="fewer to try it out")
    parser.add_argument("--jobs", type=int, default=-1)
    arguments = parser.parse_args()
    if arguments.replicates < 2:
        parser.error(f"--replicates must be at least 2, got {arguments.replicates}")
    scores = ("accuracy", "length", "iterations")
    heads = [f"{agent}: {score}" for agent in ("Q-learning", "SARSA") for score in scores]
    print(f"| protocol | {' | '.join(heads)} |")
    print("|---|" + "---:|" * len(heads))
    for name, parameters in PUT_RIGHT.items():
        numbers = arguments.replicates, arguments.seed, arguments.jobs
        print(row(name, parameters, Training(arguments.episodes), *numbers), flush=True)


if __name__ == "__main__":
    main()
