"""Agents of an installed package, found by their entry points: see the folder plugin_package."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from paths import ROOT

from arena import load

PACKAGE = ROOT / "tests" / "plugin_package"
ORIGIN = "package example-drivers 1.2.3"
LACKS = "InvalidTypeError: agent must have the methods act, learn, greedy; Mute lacks greedy"
REFUSED = [
    f"agent 'crasher' of {ORIGIN} is broken: RuntimeError: no driver today",
    f"agent 'leaver' of {ORIGIN} is broken: SystemExit: a module should not do this",
    f"agent 'mute' of {ORIGIN} is broken: {LACKS}",
    f"agent 'sarsa' of {ORIGIN} has a name that is taken: built in",
]
RACE = """
replicates = 2
[training]
episodes = 5
max_steps = 100
[evaluation]
episodes = 5
max_steps = 200
[[entrants]]
agent = "pendulum"
name = "calm"
parameters = { whim = 0.0 }
[[entrants]]
agent = "pendulum"
name = "wild"
parameters = { whim = 0.5 }
[[entrants]]
agent = "sarsa"
parameters = { bins = 5 }
"""

pytestmark = pytest.mark.system


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder that the package is installed in."""
    folder = tmp_path_factory.mktemp("installed")
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", str(folder)]
    done = subprocess.run([*pip, str(PACKAGE)], capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    return folder


def arena(installed: Path, cwd: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """The command, in a process that finds the package."""
    environment = os.environ | {"PYTHONPATH": str(installed)}
    command = [sys.executable, "-m", "arena", *arguments]
    return subprocess.run(
        command, cwd=cwd, env=environment, capture_output=True, text=True, timeout=180, check=False
    )


def test_an_installed_agent_is_listed_with_its_origin_and_each_bad_one_is_told_in_one_line(
    installed: Path, tmp_path: Path
) -> None:
    done = arena(installed, tmp_path, "agents", "--json")
    assert done.returncode == 0
    assert done.stderr.splitlines() == [f"arena: {line}" for line in REFUSED]
    told = json.loads(done.stdout)
    assert told["pendulum"] == {
        "origin": ORIGIN,
        "summary": "Pushes the way the car moves, mostly; counts what it does.",
        "source": "A driver that swings: a package's agent, for tests/test_plugin_package.py.",
        "compiles": True,
        "other_parameters": False,
        "parameters": {"whim": {"rule": "float in [0, 1]", "required": False, "default": 0.1}},
    }
    assert told["sarsa"]["origin"] == "built in"
    assert not {"crasher", "leaver", "mute"} & told.keys()


def test_an_installed_agent_passes_the_contract_suite(installed: Path, tmp_path: Path) -> None:
    done = arena(installed, tmp_path, "check", "pendulum")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "ok      compiled is interpreted" in done.stdout
    assert "failed" not in done.stdout


def test_an_installed_agent_races_compiled_on_two_workers(installed: Path, tmp_path: Path) -> None:
    (tmp_path / "race.toml").write_text(RACE)
    done = arena(installed, tmp_path, "run", "race.toml", "--no-report", "--jobs", "2")
    assert (done.returncode, done.stderr) == (0, "")
    for name in ("calm", "wild", "sarsa"):
        assert re.search(rf"^.* {name} +\d.*$", done.stdout, re.MULTILINE)  # the leaderboard's row
    with load(tmp_path / "runs" / "race.sqlite") as results:
        assert set(results.frame().driver) == {"compiled"}
        assert [one["agent"] for one in results.config["entrants"]] == ["pendulum", "pendulum", "sarsa"]
        assert results.arrays("calm")["counts"][1] == 0
        assert results.arrays("wild")["counts"][1] > 0
    verified = arena(installed, tmp_path, "verify", "runs/race.sqlite")
    assert (verified.returncode, verified.stdout) == (0, "no difference\n")


def test_of_a_broken_agent_of_a_package_only_the_entrants_fail(installed: Path, tmp_path: Path) -> None:
    (tmp_path / "race.toml").write_text(RACE.replace("pendulum", "crasher", 1))
    done = arena(installed, tmp_path, "run", "race.toml", "--no-report", "--jobs", "1")
    assert (done.returncode, done.stderr) == (0, f"{REFUSED[0]}\n")
    assert f"calm replicate 0 failed: {REFUSED[0]}" in done.stdout
    with load(tmp_path / "runs" / "race.sqlite") as results:
        assert {one["entrant"] for one in results.runs if one["status"] == "finished"} == {"wild", "sarsa"}
    for command in ("check", "agents"):
        done = arena(installed, tmp_path, command, "crasher")
        assert (done.returncode, done.stdout, done.stderr) == (2, "", f"arena: {REFUSED[0]}\n")
