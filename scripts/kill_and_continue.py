"""Kill a tournament at random moments and continue it until it is done: are the bits the same?

    python scripts/kill_and_continue.py --kills 200

starts ``arena run`` on a small tournament, kills the process (SIGKILL, where there is one) at a random
moment, starts it again, and so on until it is finished; then the digest of its results file must be that
of an uninterrupted run. That is repeated until there were as many kills as asked for.
"""

import argparse
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

RACE = """
name = "race"
replicates = 8
[training]
episodes = 1500
max_steps = 1000
[evaluation]
episodes = 50
[[entrants]]
agent = "sarsa"
sweep = { bins = [[8, 8], [10, 10], [12, 12]] }
[[entrants]]
agent = "q-learning"
parameters = { bins = 9 }
"""


def start(folder: Path, file: str) -> subprocess.Popen[bytes]:
    """The tournament, begun or continued, in a process of its own."""
    command = [sys.executable, "-m", "arena", "run", "race.toml", "--jobs", "2", "--no-report", "--out", file]
    with (folder / "said").open("wb") as said:
        return subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=said)


def digest(folder: Path, file: str) -> str:
    """What ``arena digest`` says of the file."""
    command = [sys.executable, "-m", "arena", "digest", file]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout


def main() -> int:
    """Parse, kill, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0, help="of the moments")
    arguments = parser.parse_args()
    rng = random.Random(arguments.seed)  # noqa: S311
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "race.toml").write_text(RACE)
        began = time.monotonic()
        if start(folder, "whole.sqlite").wait():
            raise SystemExit((folder / "said").read_text())
        duration = time.monotonic() - began
        expected = digest(folder, "whole.sqlite")
        kills = tournaments = equal = 0
        while kills < arguments.kills:
            file, finished = f"{tournaments}.sqlite", False
            while not finished:
                process = start(folder, file)
                try:
                    code = process.wait(rng.uniform(0.1, 1.1) * duration)
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait()
                    kills += 1
                else:
                    if code:
                        raise SystemExit((folder / "said").read_text())
                    finished = True
            tournaments += 1
            equal += digest(folder, file) == expected
    print(f"{kills} kills, {equal} of {tournaments} tournaments with the digest of an uninterrupted one")
    return equal != tournaments


if __name__ == "__main__":
    sys.exit(main())
