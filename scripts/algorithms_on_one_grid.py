"""Which algorithm suits one grid? Q-learning and SARSA beside drivers that do not learn.

    python scripts/algorithms_on_one_grid.py --bins 20 30 --out runs/algorithms.sqlite

prints the mean and standard deviation of each over the replicates, and keeps the results.
"""

import argparse

from agents import MomentumAgent, QLearning, RandomAgent, Sarsa
from arena import Entrant, Evaluation, Tournament, Training, run


def main() -> None:
    """Parse, run, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--episodes", type=int, default=4000, help="of training")
    parser.add_argument("--replicates", type=int, default=5)
    parser.add_argument("--bins", type=int, nargs=2, default=[20, 30], metavar=("N_P", "N_V"))
    parser.add_argument("--out", help="results file; continued if it is there")
    parser.add_argument("--jobs", type=int, default=-1)
    arguments = parser.parse_args()

    tournament = Tournament(
        (
            Entrant("q-learning", QLearning, bins=tuple(arguments.bins)),
            Entrant("sarsa", Sarsa, bins=tuple(arguments.bins)),
            Entrant("momentum", MomentumAgent),
            Entrant("random", RandomAgent),
        ),
        training=Training(episodes=arguments.episodes),
        evaluation=Evaluation(episodes=200),
        replicates=arguments.replicates,
        name="algorithms",
    )
    with run(tournament, out=arguments.out, n_jobs=arguments.jobs) as results:
        frame = results.frame()
    scores = frame.groupby("entrant", sort=False)[["accuracy", "mean_length", "iterations"]]
    print(scores.agg(["mean", "std"]).round(1).to_string())


if __name__ == "__main__":
    main()
