"""What keeping results costs: the same tournament with and without a results file, side by side in one run.

    python scripts/bench_store.py --pairs 5

Pairs of runs of the paper's tournament, in alternating order; prints the median of their ratios.
"""

import argparse
import statistics
import tempfile
import time
from pathlib import Path

from arena import paper, run


def seconds(replicates: int, out: Path | None) -> float:
    """How long the paper's tournament takes, with or without a file."""
    began = time.perf_counter()
    run(paper(replicates=replicates), out).close()
    return time.perf_counter() - began


def main() -> None:
    """Parse, measure, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--replicates", type=int, default=3)
    arguments = parser.parse_args()
    seconds(1, None)  # compiles, starts the workers
    ratios = []
    with tempfile.TemporaryDirectory() as folder:
        for pair in range(arguments.pairs):
            file = Path(folder) / f"{pair}.sqlite"
            order = [file, None] if pair % 2 else [None, file]
            took = {out: seconds(arguments.replicates, out) for out in order}
            ratios.append(took[file] / took[None])
    print("with / without a file:", ", ".join(f"{ratio:.3f}" for ratio in ratios))
    print(f"median {statistics.median(ratios):.3f}")


if __name__ == "__main__":
    main()
