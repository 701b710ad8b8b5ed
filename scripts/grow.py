"""Tournaments that change while they grow: is the end of each history that of a run from scratch?

    python scripts/grow.py

plays histories of edits on one results file: more and fewer replicates, entrants that come, go, are renamed
and renamed back, parameters and code that are edited and taken back, files of two machines that are joined.
After each the digest must be that of the same tournament run from scratch. Printed is a Markdown table with
how many runs were driven, and how many a tool would have driven that begins anew each time.
"""

import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from agents import MomentumAgent, RandomAgent, Sarsa, registry
from arena import Entrant, Evaluation, Tournament, Training, load_plugin, run
from arena.execution.runner import preview
from arena.results import digest
from arena.results.editing import drop, merge, prune

CODE = '''
"""An agent that is edited."""


class Pusher:
    """Pushes right in a share of the steps."""

    def __init__(self, share: float = {share}):
        self.share = share

    def act(self, observation, progress, rng):
        return 2 if rng.random() < self.share else 0

    def learn(self, observation, action, reward, next_observation, terminated):
        pass

    def greedy(self, observation):
        return 2 if observation[1] >= 0.0 else 0  # {comment}
'''


@dataclass
class Machine:
    """A folder with a results file of a tournament that changes.

    Attributes:
        folder: where it works.
        entrants: by name, the agent and its parameters.
        replicates: of the tournament.
        driven, anew: runs that were driven, and that would be if each change began anew.
    """

    folder: Path
    entrants: dict[str, tuple[type[Any], dict[str, Any]]] = field(
        default_factory=lambda: {"sarsa": (Sarsa, {"bins": 6}), "momentum": (MomentumAgent, {})}
    )
    replicates: int = 2
    driven: int = 0
    anew: int = 0

    @property
    def file(self) -> Path:
        """The results file."""
        return self.folder / "grown.sqlite"

    @property
    def tournament(self) -> Tournament:
        """As it is now."""
        entrants = tuple(Entrant(name, agent, **given) for name, (agent, given) in self.entrants.items())
        return Tournament(
            entrants,
            training=Training(3, 120),
            evaluation=Evaluation(2, 120),
            replicates=self.replicates,
            seed=5,
            name="grown",
        )

    def go(self, replicates: range | None = None, file: Path | None = None) -> None:
        """Run what is missing."""
        out = file or self.file
        self.driven += len(preview(self.tournament, out, replicates).missing)
        self.anew += len(replicates or range(self.replicates)) * len(self.entrants)
        run(self.tournament, out, n_jobs=1, driver="pettingzoo", replicates=replicates).close()

    def edit(self, share: float = 0.7, comment: str = "") -> None:
        """Write the plugin, and load it."""
        path = self.folder / "pusher.py"
        path.write_text(CODE.format(share=share, comment=comment), encoding="utf-8")
        with registry.isolated():
            self.entrants["pusher"] = load_plugin(path)["pusher"], {}

    def is_fresh(self) -> bool:
        """Whether the file lacks nothing, and has the digest of a run from scratch."""
        if preview(self.tournament, self.file).missing:
            return False
        with run(self.tournament, self.file, n_jobs=1, driver="pettingzoo") as grown:
            ours = digest(grown)
        with run(self.tournament, n_jobs=1, driver="pettingzoo") as fresh:
            return digest(fresh) == ours


def more(machine: Machine) -> None:
    """Replicates are added, twice."""
    for machine.replicates in (3, 5):
        machine.go()


def fewer(machine: Machine) -> None:
    """Replicates are taken away, then wanted again."""
    for machine.replicates in (4, 1, 4):
        machine.go()


def added(machine: Machine) -> None:
    """An entrant comes."""
    machine.entrants["random"] = RandomAgent, {}
    machine.go()


def removed(machine: Machine) -> None:
    """An entrant goes."""
    del machine.entrants["momentum"]
    machine.go()


def removed_and_back(machine: Machine) -> None:
    """An entrant goes and comes back, at another place."""
    gone = machine.entrants.pop("sarsa")
    machine.go()
    machine.entrants["sarsa"] = gone
    machine.go()


def renamed_and_back(machine: Machine) -> None:
    """An entrant is renamed: its random numbers are others; then renamed back."""
    machine.entrants["rummery"] = machine.entrants.pop("sarsa")
    machine.go()
    machine.entrants["sarsa"] = machine.entrants.pop("rummery")
    machine.go()


def parameters(machine: Machine) -> None:
    """A parameter is changed, changed again, and taken back."""
    for bins in (7, 8, 6):
        machine.entrants["sarsa"] = Sarsa, {"bins": bins}
        machine.go()


def code(machine: Machine) -> None:
    """A plugin's code is edited, and taken back."""
    for share, comment in ((0.7, "first"), (0.2, "second"), (0.7, "first")):
        machine.edit(share, comment)
        machine.go()


def all_at_once(machine: Machine) -> None:
    """An entrant comes, another goes, parameters, code and the number of replicates change."""
    machine.edit()
    machine.go()
    del machine.entrants["momentum"]
    machine.entrants |= {"random": (RandomAgent, {}), "sarsa": (Sarsa, {"bins": 5})}
    machine.edit(0.1)
    machine.replicates = 4
    machine.go()


def pruned(machine: Machine) -> None:
    """What is not needed is removed, then wanted again."""
    machine.entrants["sarsa"] = Sarsa, {"bins": 9}
    machine.go()
    prune(machine.file)
    machine.entrants["sarsa"] = Sarsa, {"bins": 6}
    machine.go()


def dropped(machine: Machine) -> None:
    """An entrant is dropped from the file and from the tournament."""
    drop(machine.file, ["sarsa"])
    del machine.entrants["sarsa"]
    machine.go()


def merged(machine: Machine) -> None:
    """Two machines share the replicates, a third file has one more entrant; all are joined."""
    parts = [machine.folder / f"part-{number}.sqlite" for number in range(3)]
    machine.replicates = 6
    for number, part in enumerate(parts[:2]):
        machine.go(range(3 * number, 3 * number + 3), part)
    machine.entrants["random"] = RandomAgent, {}
    machine.go(range(2), parts[2])
    machine.file.unlink()
    merge(parts, machine.file)
    machine.go()


HISTORIES: tuple[Callable[[Machine], None], ...] = (
    *(more, fewer, added, removed, removed_and_back, renamed_and_back),
    *(parameters, code, all_at_once, pruned, dropped, merged),
)


def main() -> int:
    """Play them all; 1 if one ended otherwise."""
    print("| history | runs driven | anew each time | digest of a run from scratch |")
    print("|---|---:|---:|---|")
    failed = 0
    for history in HISTORIES:
        with tempfile.TemporaryDirectory() as folder:
            machine = Machine(Path(folder))
            machine.go()
            history(machine)
            fresh = machine.is_fresh()
        failed += not fresh
        said = (history.__doc__ or "").strip().rstrip(".")
        print(f"| {said} | {machine.driven} | {machine.anew} | {'yes' if fresh else 'NO'} |", flush=True)
    return bool(failed)


if __name__ == "__main__":
    sys.exit(main())
