"""A plugin file with two agents, edits of it, a race between them, and ways to run it."""

import subprocess
import sys
from pathlib import Path
from typing import Any

from bits import bits_of

from arena import Entrant, Evaluation, Results, Tournament, Training, load_plugin, run

# Two agents of one behaviour, one compiled, one not; what they learn shows every part of the code.
PLUGIN = """
from typing import Annotated, Literal, NamedTuple

import numpy as np
from annotated_types import Interval

GAIN = 1.0


def grown(value):
    return value + 0.25


class Speedy(NamedTuple):
    memory: np.ndarray
    step_size: float

    @classmethod
    def create(
        cls,
        task,
        *,
        step_size: Annotated[float, Interval(gt=0, le=1)] = 0.5,
        bins: tuple[int, int] = (3, 4),
        mood: Literal["bold", "shy"] = "bold",
    ):
        return cls(np.zeros(task.n_actions), step_size)

    def act(self, observation, progress, rng):
        return int(rng.random() * 3)

    def learn(self, observation, action, reward, next_observation, next_action, terminated):
        self.memory[action] += self.step_size * grown(GAIN + next_observation[0])

    def greedy(self, observation):
        return 2 if observation[1] >= 0.0 else 0


class Plodding:
    def __init__(self):
        self.memory = np.zeros(3)

    act = Speedy.act
    greedy = Speedy.greedy

    def learn(self, observation, action, reward, next_observation, next_action, terminated):
        self.memory[action] += 0.5 * grown(GAIN + next_observation[0])
"""
EDITS = {
    "a method": ("0.5 * grown", "2.5 * grown"),
    "a helper function": ("value + 0.25", "value + 0.75"),
    "a constant": ("GAIN = 1.0", "GAIN = 3.0"),
}
RACE = """
name = "race"
replicates = 2
seed = 7
[training]
episodes = 6
max_steps = 120
[evaluation]
episodes = 5
max_steps = 150
[[entrants]]
agent = "speedy"
[[entrants]]
agent = "plodding"
"""

RUN = ("run", "race.toml", "--no-report")
"""The command of a race without a page, which takes longer than the race."""

RUN_IT = """
from arena import *
tournament = Tournament(
    (Entrant("speedy", Speedy), Entrant("plodding", Plodding)),
    training=Training(6, 120), evaluation=Evaluation(5, 150), replicates=2, seed=7, name="race",
)
run(tournament, out, n_jobs=2).close()
"""
NOTEBOOK = """
import json, pathlib, sys
for number, cell in enumerate(json.loads(pathlib.Path("cells.json").read_text())):
    exec(compile(cell, f"<cell {number}>", "exec"), vars(sys.modules["__main__"]))
"""


def write_files() -> None:
    """Put the plugin and the race into the current folder."""
    Path("speedy.py").write_text(PLUGIN)
    Path("race.toml").write_text(RACE)


def python(*arguments: str) -> subprocess.CompletedProcess[str]:
    """A process of its own, in the current folder."""
    return subprocess.run(
        [sys.executable, *arguments], capture_output=True, text=True, timeout=180, check=False
    )


def race_between(**agents: Any) -> Tournament:
    """What the file ``race.toml`` describes, with these agents under these names."""
    return Tournament(
        tuple(Entrant(name, agent) for name, agent in agents.items()),
        training=Training(episodes=6, max_steps=120),
        evaluation=Evaluation(episodes=5, max_steps=150),
        replicates=2,
        seed=7,
        name="race",
    )


def bits(results: Results) -> Any:
    """Scores and arrays of all runs, which must not have failed."""
    with results:
        assert [one.get("error", "") for one in results.runs] == [""] * len(results.runs)
        return bits_of(results)


def from_file(n_jobs: int = 1) -> Any:
    """The bits of the race with the agents of ``speedy.py``, loaded now."""
    return bits(run(race_between(**load_plugin("speedy.py")), n_jobs=n_jobs))
