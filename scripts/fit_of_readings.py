"""How well does each reading of the paper's protocol fit its Table 2?

    python scripts/fit_of_readings.py --replicates 10

runs the paper's tournament under each reading and prints a Markdown table (docs/readings.md). ``chance`` is
how far one replicate is from the mean of the others: no reading can be expected to be nearer to the paper's.
"""

import argparse

from arena import paper, run
from arena.reproduction import compare
from arena.tournament.readings import READINGS


def main() -> None:
    """Parse, run, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--replicates", type=int, default=2)
    parser.add_argument("--readings", nargs="+", choices=READINGS, default=list(READINGS))
    parser.add_argument("--jobs", type=int, default=-1)
    arguments = parser.parse_args()
    if arguments.replicates < 2:
        parser.error(f"--replicates must be at least 2, got {arguments.replicates}")
    print(
        "| reading | what differs | correlation | mean | root mean square | chance | chi² / 32 | accuracy |"
    )
    print("|---|---|---:|---:|---:|---:|---:|---:|")
    for reading in arguments.readings:
        tournament = paper(replicates=arguments.replicates, reading=reading)
        with run(tournament, n_jobs=arguments.jobs) as results:
            found = compare(results)
        assert found is not None  # noqa: S101 (the tournament is the paper's)
        print(
            f"| `{reading}` | {READINGS[reading].description} | {found.iterations_correlation:.3f} "
            f"| {found.iterations_difference:+.1f}% | {found.iterations_error:.1f}% "
            f"| {found.iterations_chance:.1f}% | {found.iterations_chi_square:.1f} "
            f"| {found.mean_accuracy:.1f}% |",
            flush=True,
        )


if __name__ == "__main__":
    main()
