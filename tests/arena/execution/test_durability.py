"""Nothing lost: killed at any moment and continued, the bits are those of an uninterrupted run."""

import json
import re
import runpy
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from paths import ROOT

from arena import load
from arena.cli import main
from arena.results import digest

RACE = runpy.run_path(str(ROOT / "scripts" / "kill_and_continue.py"))["RACE"]
POSIX = pytest.mark.skipif(sys.platform == "win32", reason="sends POSIX signals")


@pytest.fixture
def race(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The results file of a race.toml in the current folder."""
    monkeypatch.chdir(tmp_path)
    Path("race.toml").write_text(RACE)
    return tmp_path / "runs" / "race.sqlite"


@pytest.fixture
def interruptible() -> Iterator[None]:
    """Ctrl-C reaches the children even of a suite in the background, where shells let it be ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def start(*options: str) -> subprocess.Popen[bytes]:
    """The command in the background; what it says of errors goes to the file ``said``."""
    command = [sys.executable, "-m", "arena", "run", "race.toml", "--jobs", "2", "--no-report", *options]
    with Path("said").open("wb") as said:
        return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=said)


def digest_of(file: str) -> str:
    with load(file) as results:
        return digest(results)


@pytest.mark.system
def test_killed_at_twenty_random_moments_and_continued_the_digest_is_that_of_an_uninterrupted_run() -> None:
    command = [sys.executable, str(ROOT / "scripts" / "kill_and_continue.py"), "--kills", "20"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=900)
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.match(r"2\d kills, (\d+) of \1 tournaments", done.stdout)


@POSIX
@pytest.mark.usefixtures("interruptible")
@pytest.mark.system
def test_an_interrupted_run_says_how_to_continue(race: Path) -> None:
    Path("race.toml").write_text(RACE.replace("replicates = 8", "replicates = 20"))
    process = start("--seed", "3")
    while not race.exists():
        assert process.poll() is None, Path("said").read_text()
        time.sleep(0.05)
    time.sleep(0.2)
    process.send_signal(signal.SIGINT)
    assert process.wait(60) == 130
    told = Path("said").read_text()
    line = next(line for line in told.splitlines() if line.startswith("arena:"))
    assert line == (
        f"arena: interrupted; what was finished is in {Path('runs/race.sqlite')}; "
        "to continue: arena run race.toml --jobs 2 --no-report --seed 3"
    )
    assert "Traceback" not in told
    process = start("--seed", "3")
    assert process.wait(120) == 0


@pytest.mark.system
def test_a_second_process_on_one_file_is_refused(race: Path) -> None:
    Path("race.toml").write_text(RACE.replace("replicates = 8", "replicates = 300"))
    process = start()
    while not race.exists():
        assert process.poll() is None, Path("said").read_text()
        time.sleep(0.05)
    second = start()
    assert second.wait(60) == 2
    assert "race.sqlite: another process is writing it" in Path("said").read_text()
    process.kill()
    process.wait(10)


def test_digests_ignore_what_may_differ_and_nothing_else(
    race: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, driver in (("a", "compiled"), ("b", "pettingzoo")):
        small = ["--replicates", "1", "--jobs", "1", "--driver", driver, "--out", f"{name}.sqlite"]
        text = re.sub("episodes = 1500|episodes = 50", "episodes = 3", RACE)
        Path("race.toml").write_text(text)
        assert main(["run", "race.toml", "--no-report", *small]) == 0
    before = digest_of("a.sqlite")
    assert digest_of("b.sqlite") == before
    capsys.readouterr()
    for change in (
        "UPDATE runs SET iterations = iterations + 1 WHERE entrant = 'q-learning'",
        "UPDATE runs SET accuracy = 3.0 WHERE entrant = 'q-learning'",
        "UPDATE arrays SET npz = (SELECT npz FROM arrays WHERE entrant = 'q-learning')",
        "DELETE FROM runs WHERE entrant = 'q-learning'",
    ):
        shutil.copy("a.sqlite", "c.sqlite")
        connection = sqlite3.connect("c.sqlite")
        connection.execute(change)
        connection.commit()
        connection.close()
        assert digest_of("c.sqlite") != before
        if change.startswith("UPDATE"):
            assert main(["verify", "c.sqlite"]) == 1
            assert re.match(r"replicate 0 of '.*' differs in \w+", capsys.readouterr().out)
    assert main(["verify", "a.sqlite", "--runs", "2"]) == 0
    assert capsys.readouterr().out == "no difference\n"


@pytest.mark.system
def test_failures_are_told_by_the_exit_code_if_asked_or_if_nothing_finished(
    race: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    endless = RACE.replace("episodes = 1500", "episodes = 1_000_000").partition("[[entrants]]")[0]
    Path("race.toml").write_text("time_limit = 2.0\n" + endless + '[[entrants]]\nagent = "sarsa"\n')
    arguments = ["run", "race.toml", "--replicates", "1", "--jobs", "1", "--no-report"]
    assert main(arguments) == 1
    assert (
        "sarsa replicate 0 failed: the worker died: the time limit of 2 s is over" in capsys.readouterr().out
    )
    with load(race) as results:
        assert json.dumps(results.to_dict())
        assert {one["status"] for one in results.runs} == {"failed"}
