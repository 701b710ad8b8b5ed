"""Long runs go on from their middle, to the bit."""

import logging
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hand_made_agents import Leaky, Scripted, race_of

from agents import MomentumAgent, QLearning, RandomAgent, Sarsa
from arena import Entrant, load, run
from arena.execution.checkpoint import Checkpoint, file_of, savable
from arena.execution.worker import DRIVERS
from arena.results import digest
from arena.tournament import Conditions, Run
from arena.tournament.outcome import Outcome
from envs import Hill

AGENTS = {
    "q": Entrant("q", QLearning, bins=4),
    "episodes": Entrant("episodes", Sarsa, bins=4, count_visits="episode"),
    "random": Entrant("random", RandomAgent),
    "allocates": Entrant("allocates", Leaky),
}


def race(driver: str, conditions: Conditions, one: Run) -> Outcome:
    (outcome,) = DRIVERS[driver](conditions, [one])
    return outcome


@pytest.mark.parametrize("entrant", AGENTS.values(), ids=AGENTS)
@pytest.mark.parametrize(
    "drivers", [("compiled", "compiled"), ("pettingzoo",) * 2, ("compiled", "pettingzoo")]
)
@pytest.mark.parametrize("moment", [1, 3])
def test_a_run_that_is_interrupted_goes_on_to_the_same_bits(
    entrant: Entrant, drivers: tuple[str, str], moment: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tournament = race_of(entrant)
    one = tournament.runs[0]
    expected = race(drivers[0], tournament.conditions, one)
    conditions = replace(tournament.conditions, checkpoints=str(tmp_path / "c"), checkpoint_seconds=0.0)
    save, saved = Checkpoint.save, []

    def save_and_stop(self: Checkpoint, done: int) -> None:
        save(self, done)
        saved.append(done)
        if len(saved) == moment:
            raise KeyboardInterrupt

    monkeypatch.setattr(Checkpoint, "save", save_and_stop)
    with pytest.raises(KeyboardInterrupt):
        race(drivers[0], conditions, one)
    before = len(saved)
    found = race(drivers[1], conditions, one)
    assert saved[:before] == list(range(saved[0], saved[0] + moment))  # after each episode
    assert min(saved[before:]) >= saved[before - 1]  # it did not begin anew
    assert found.arrays == expected.arrays
    assert (found.accuracy, found.iterations) == (expected.accuracy, expected.iterations)


def test_checkpoints_that_are_damaged_or_another_run_s_are_not_used(tmp_path: Path) -> None:
    tournament = race_of(AGENTS["q"])
    conditions = replace(tournament.conditions, checkpoints=str(tmp_path), checkpoint_seconds=0.0)
    path = file_of(conditions, tournament.runs[0])
    assert path is not None
    array = np.arange(3.0)
    Checkpoint(path, "mine", (array, np.random.default_rng(0))).save(5)
    other = np.zeros(3)
    assert Checkpoint(path, "other", (other, np.random.default_rng(1))).restore() == 0
    assert other.sum() == 0.0
    rng = np.random.default_rng(1)
    assert Checkpoint(path, "mine", (other, rng)).restore() == 5
    assert other.tolist() == [0.0, 1.0, 2.0]
    assert rng.random() == np.random.default_rng(0).random()
    path.write_bytes(path.read_bytes()[:100])
    assert Checkpoint(path, "mine", (other, rng)).restore() == 0


def test_what_can_be_saved() -> None:
    hill = Hill()
    for agent in (QLearning.create(hill), RandomAgent.create(hill), MomentumAgent.create(hill)):
        assert savable(agent)
    assert not savable(Scripted())


def test_an_agent_that_cannot_be_saved_is_said_to_start_anew(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    tournament = race_of(Entrant("plain", Scripted))

    class Stop(Exception):
        pass

    def stop(finished: int, _total: int) -> None:
        if finished == 1:
            raise Stop

    with pytest.raises(Stop):
        run(tournament, tmp_path / "r.sqlite", n_jobs=2, progress=stop)
    caplog.clear()
    with caplog.at_level(logging.WARNING, "arena"):
        run(tournament, tmp_path / "r.sqlite", n_jobs=1).close()
    assert "plain cannot be saved in the middle: its unfinished runs start anew" in caplog.messages


LONG = """
import sys
from agents import QLearning, Sarsa
from arena import Entrant, Evaluation, Tournament, Training, run

if __name__ == "__main__":
    entrants = (Entrant("q", QLearning, bins=4), Entrant("s", Sarsa, bins=4))
    long = Tournament(entrants, training=Training(20_000, 500), evaluation=Evaluation(20), replicates=1)
    run(long, sys.argv[1], n_jobs=2, checkpoint_seconds=0.1)
"""


@pytest.mark.system
def test_a_killed_tournament_goes_on_in_the_middle_of_its_runs(tmp_path: Path) -> None:
    (tmp_path / "long.py").write_text(LONG)

    def start(file: str) -> subprocess.Popen[bytes]:
        return subprocess.Popen([sys.executable, "long.py", file], cwd=tmp_path)

    assert start("whole.sqlite").wait(120) == 0
    assert not (tmp_path / "whole.sqlite.checkpoints").exists()
    process, folder = start("part.sqlite"), tmp_path / "part.sqlite.checkpoints"
    while not list(folder.glob("*.npz")):
        assert process.poll() is None
        time.sleep(0.01)
    process.kill()
    process.wait(10)
    assert start("part.sqlite").wait(120) == 0
    assert not folder.exists()
    with load(tmp_path / "whole.sqlite") as whole, load(tmp_path / "part.sqlite") as part:
        assert digest(part) == digest(whole)
