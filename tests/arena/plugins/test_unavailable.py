"""Agents that cannot be had now: their entrants fail, the others race, and once they can it goes on."""

import json
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from agents import agent_class, registry
from arena import Results, load, load_plugin, run
from arena.cli import main
from arena.results import digest
from arena.tournament import load_tournament

DRIVER = """
import numpy as np

from agents.parameters import Probability


class Driver:
    def __init__(self, *, whim: Probability = 0.1, bins: tuple[int, int] = (2, 3)):
        self.whim, self.counts = whim, np.zeros(bins)

    def act(self, observation, progress, rng):
        return int(rng.random() * 3) if rng.random() < self.whim else self.greedy(observation)

    def learn(self, observation, action, reward, next_observation, next_action, terminated):
        self.counts[0, 0] += 1

    def greedy(self, observation):
        return 2 if observation[1] >= 0.0 else 0
"""
BROKEN = f"{DRIVER}\nclass\n"
SWEPT = ["driver 4x5 whim=0.0", "driver 4x5 whim=0.5"]
RACE = """
replicates = 2
seed = 7
[training]
episodes = 5
max_steps = 100
[evaluation]
episodes = 5
max_steps = 150
[[entrants]]
agent = "momentum"
[[entrants]]
agent = "driver"
sweep = { bins = [[4, 5]], whim = [0.0, 0.5] }
"""


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, isolated_registry: None) -> Path:
    """An empty current folder; what a test registers, no other finds."""
    monkeypatch.chdir(tmp_path)
    Path("race.toml").write_text(f'plugins = ["bad.py"]\n{RACE}')
    return tmp_path


@pytest.fixture
def package(here: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The module of an installed package that offers the agent ``driver``, which it lacks."""
    info = here / "broken_drivers-1.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: broken-drivers\nVersion: 1\n")
    (info / "entry_points.txt").write_text("[arena.agents]\ndriver = broken_drivers:Driver\n")
    Path("race.toml").write_text(RACE)
    module = here / "broken_drivers.py"
    module.write_text(BROKEN)
    monkeypatch.syspath_prepend(str(here))
    with registry.isolated():
        yield module
    sys.modules.pop("broken_drivers", None)


def race(plugin: str | None, file: str = "race.sqlite") -> Results:
    """Start, or continue, the tournament with this text in ``bad.py``; None is no such file."""
    Path("bad.py").unlink(missing_ok=True)
    if plugin is not None:
        Path("bad.py").write_text(plugin)
    return run(load_tournament("race.toml"), file, n_jobs=1)


def statuses(results: Results) -> dict[str, str]:
    """The status of the runs of each entrant."""
    with results:
        runs = results.frame().groupby("entrant").status
        return {str(name): " and ".join(sorted(set(status))) for name, status in runs}


@pytest.mark.parametrize("plugin", [BROKEN, None, "GAIN = 1.0"], ids=["syntax", "missing", "no agent"])
def test_a_repaired_plugin_continues_its_file_with_what_had_failed(plugin: str | None) -> None:
    with race(DRIVER, "never_broken.sqlite") as results:
        expected = digest(results)
    assert statuses(race(plugin)) == {"momentum": "finished"} | dict.fromkeys(SWEPT, "failed")
    with load("race.sqlite") as results:
        assert results.config["entrants"][1] == {
            "name": SWEPT[0],
            "agent": "driver",
            "parameters": {"bins": [4, 5], "whim": 0.0},
            "unavailable": True,
        }
        kept = results.runs[0]["seconds"]
    with race(DRIVER) as results:
        assert digest(results) == expected
        assert results.runs[0]["seconds"] == kept  # it was not run again
    with load("race.sqlite") as results:
        assert digest(results) == expected


def test_a_plugin_that_breaks_keeps_what_had_finished() -> None:
    with race(DRIVER) as results:
        expected = results.to_dict()
    assert statuses(race(BROKEN)) == dict.fromkeys(["momentum", *SWEPT], "finished")
    with race(BROKEN) as results:
        assert results.to_dict() == expected
    with race(DRIVER) as results:
        assert results.to_dict() == expected


def test_code_of_a_repaired_plugin_is_remembered() -> None:
    race(BROKEN).close()
    race(DRIVER).close()
    with race(DRIVER, "other.sqlite") as results:
        expected = digest(results)
    with race(DRIVER.replace("+= 1", "+= 2")) as results:
        assert digest(results) != expected
    with race(DRIVER) as results:
        assert digest(results) == expected


@pytest.mark.parametrize(
    ("old", "new"),
    [('agent = "driver"', 'agent = "other"'), ("whim = [0.0, 0.5]", "whim = [0.0, 0.6]")],
)
def test_another_agent_or_another_name_is_another_entrant(old: str, new: str) -> None:
    race(BROKEN).close()
    Path("race.toml").write_text(f'plugins = ["bad.py"]\n{RACE.replace(old, new)}')
    code = DRIVER.replace("Driver", "Other") if "other" in new else DRIVER
    with race(code, "fresh.sqlite") as results:
        expected = digest(results)
    with race(code) as results:
        assert digest(results) == expected


def test_files_with_such_entrants_are_shown_and_verified(capsys: pytest.CaptureFixture[str]) -> None:
    race(BROKEN).close()
    capsys.readouterr()
    assert main(["show", "race.sqlite"]) == 0
    out, err = capsys.readouterr()
    assert f"{SWEPT[0]} replicate 0 failed: agent 'driver' is not available: plugin bad.py, line" in out
    assert err == ""
    assert main(["show", "race.sqlite", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["entrants"][2]["unavailable"] is True
    assert main(["verify", "race.sqlite"]) == 0
    assert capsys.readouterr() == ("no difference\n", "")


def test_a_tournament_that_is_only_of_such_entrants_is_told_as_failed(
    capsys: pytest.CaptureFixture[str],
) -> None:
    Path("race.toml").write_text('plugins = ["bad.py"]\n[[entrants]]\nagent = "driver"\n')
    assert main(["run", "race.toml", "--jobs", "1", "--driver", "compiled"]) == 1
    told = capsys.readouterr().out
    assert (
        "driver replicate 9 failed: agent 'driver' is not available: there is no plugin file bad.py" in told
    )


def test_the_same_stand_in_for_the_same_reason() -> None:
    assert load_tournament("race.toml") == load_tournament("race.toml")


# Misspelt names


@pytest.mark.parametrize(
    ("agent", "near"), [("momentm", "momentum"), ("drivr", "driver"), ("speed-seekr", "speed-seeker")]
)
def test_a_misspelt_name_is_refused_also_beside_a_broken_plugin(agent: str, near: str) -> None:
    Path("bad.py").write_text(BROKEN)
    Path("good.py").write_text(DRIVER.replace("Driver", "SpeedSeeker"))
    text = RACE.replace('agent = "driver"', f'agent = "{agent}"')
    Path("race.toml").write_text(f'plugins = ["bad.py", "good.py"]\n{text}')
    with pytest.raises(
        ValueError, match=f"agent must be one of .*{near}.*, got '{agent}'; did you mean '{near}'"
    ):
        load_tournament("race.toml")


@pytest.mark.parametrize("agent", [3, [3], "dri\x1bver"])
def test_a_name_that_is_none_is_refused_also_beside_a_broken_plugin(agent: Any) -> None:
    Path("race.toml").write_text(f'plugins = ["bad.py"]\n[[entrants]]\nagent = {json.dumps(agent)}\n')
    with pytest.raises(ValueError, match=f"agent must be one of .*, got {re.escape(repr(agent))}"):
        load_tournament("race.toml")


def test_each_entrant_is_told_the_file_that_was_to_have_its_agent() -> None:
    Path("bad.py").write_text(BROKEN)
    Path("race.toml").write_text(f'plugins = ["bad.py", "none.py"]\n{RACE}[[entrants]]\nagent = "pilot"\n')
    *_, swept, pilot = load_tournament("race.toml").entrants
    assert swept.unavailable.startswith("agent 'driver' is not available: plugin bad.py, line ")
    assert "none.py" not in swept.unavailable
    assert pilot.unavailable.endswith("; there is no plugin file none.py")


# Installed packages


def test_of_a_broken_package_only_the_entrants_fail_and_they_go_on_once_it_is_repaired(
    package: Path, caplog: pytest.LogCaptureFixture
) -> None:
    line = "agent 'driver' of package broken-drivers 1 is broken: SyntaxError: "
    assert statuses(race(None)) == {"momentum": "finished"} | dict.fromkeys(SWEPT, "failed")
    (warning,) = caplog.messages
    assert warning.startswith(line)
    with load("race.sqlite") as results:
        assert {one["error"] for one in results.runs if one["status"] == "failed"} == {warning}
    with pytest.raises(ValueError, match=f"^{re.escape(line)}"):
        agent_class("driver")
    package.write_text(DRIVER)
    with registry.isolated():  # as in a new process
        assert statuses(race(None)) == dict.fromkeys(["momentum", *SWEPT], "finished")


def test_runs_of_a_package_that_has_broken_cannot_be_verified(
    package: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    package.write_text(DRIVER)
    race(None).close()
    package.write_text(BROKEN)
    sys.modules.pop("broken_drivers")
    with registry.isolated():  # as in a new process
        assert main(["verify", "race.sqlite"]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("arena: agent 'driver' of package broken-drivers 1 is broken: SyntaxError: ")
    assert err.count("\n") == 1


def test_a_misspelt_name_of_a_broken_package_is_refused(package: Path) -> None:
    assert package.exists()
    Path("race.toml").write_text(RACE.replace('agent = "driver"', 'agent = "drivr"'))
    with pytest.raises(ValueError, match=r"got 'drivr'; did you mean 'driver'\?$"):
        load_tournament("race.toml")


def test_a_plugin_may_have_the_name_of_what_is_broken(package: Path) -> None:
    assert package.exists()
    Path("good.py").write_text(DRIVER)
    assert load_plugin("good.py")["driver"] is agent_class("driver")
