"""Which grid suits one algorithm? A tournament of SARSA on several grids.

    python scripts/grids_of_one_algorithm.py --episodes 4000 --replicates 10

prints accuracy, length and iterations by the number of cells along position and velocity.
"""

import argparse

from agents import Sarsa
from arena import Evaluation, Tournament, Training, run, sweep


def main() -> None:
    """Parse, run, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--episodes", type=int, default=4000, help="of training")
    parser.add_argument("--replicates", type=int, default=5)
    parser.add_argument("--bins", type=int, nargs="+", default=[10, 20, 30], help="along each dimension")
    parser.add_argument("--jobs", type=int, default=-1)
    arguments = parser.parse_args()

    grids = [(position, velocity) for position in arguments.bins for velocity in arguments.bins]
    tournament = Tournament(
        tuple(sweep("sarsa", Sarsa, over={"bins": grids})),
        training=Training(episodes=arguments.episodes),
        evaluation=Evaluation(episodes=200),
        replicates=arguments.replicates,
        name="grids",
    )
    with run(tournament, n_jobs=arguments.jobs) as results:
        frame = results.frame()
    means = frame.groupby("bins")[["accuracy", "mean_length", "iterations"]].mean()
    print(means.round(1).to_string())


if __name__ == "__main__":
    main()
