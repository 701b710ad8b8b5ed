"""The command ``arena``, as users run it."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from arena import load
from arena.cli import main

RACE = """
name = "race"
replicates = 2
[training]
episodes = 5
max_steps = 100
[evaluation]
episodes = 5
max_steps = 150
[[entrants]]
agent = "sarsa"
name = "<b>sarsa[/]"
parameters = { bins = 5 }
[[entrants]]
agent = "momentum"
"""


@pytest.fixture
def race(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """The name of a small tournament's file, in the current folder."""
    monkeypatch.chdir(tmp_path)
    Path("race.toml").write_text(RACE)
    return "race.toml"


def arena(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    """The real command in a process of its own."""
    command = [sys.executable, "-m", "arena", *arguments]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=120, check=False)


def test_run_keeps_results_and_prints_them_and_show_prints_the_same(tmp_path: Path, race: str) -> None:
    done = arena("run", race, "--jobs", "2", cwd=tmp_path)
    assert done.returncode == 0
    assert done.stderr == ""  # quiet: it is no terminal
    assert "Tournament race: 2 entrants, 2 replicates, seed 0." in done.stdout
    assert "Reading of the paper: literal" in done.stdout
    assert "<b>sarsa[/]" in done.stdout
    assert re.search(r"1-2 +momentum +\d+\.\d ± \d+\.\d +100\.0 ", done.stdout)
    shown = arena("show", "runs/race.sqlite", cwd=tmp_path)
    assert (shown.returncode, shown.stdout, shown.stderr) == (0, done.stdout, "")


def test_json_is_one_object_on_stdout(race: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", race, "--jobs", "1", "--json", "--out", "deep/r.sqlite"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert [one["entrant"] for one in told["runs"]] == ["<b>sarsa[/]"] * 2 + ["momentum"] * 2
    assert told["runs"][0]["parameters"]["bins"] == 5
    assert told["runs"][0]["agent"] == "sarsa"
    assert "paper" not in told
    assert main(["show", "deep/r.sqlite", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == told


def test_a_finished_tournament_is_only_printed(race: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", race, "--jobs", "1"]) == 0
    first, before = capsys.readouterr().out, Path("runs/race.sqlite").read_bytes()
    assert main(["run", race, "--jobs", "1"]) == 0
    assert capsys.readouterr().out == first
    assert Path("runs/race.sqlite").read_bytes() == before


def test_options_override_the_file(race: str) -> None:
    options = ["--replicates", "1", "--seed", "9", "--driver", "pettingzoo", "--reading", "state-visits"]
    assert main(["run", race, "--jobs", "1", *options]) == 0
    with load("runs/race.sqlite") as results:
        assert results.config["seed"] == 9
        assert results.config["reading"] == "state-visits"
        assert results.frame().driver.tolist() == ["pettingzoo"] * 2


def test_the_built_in_quick_tournament_runs(race: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "quick", "--replicates", "1", "--jobs", "1"]) == 0
    assert "random" in capsys.readouterr().out
    assert Path("runs/quick.sqlite").exists()


def test_a_small_paper_prints_both_tables(race: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "paper", "--replicates", "1", "--jobs", "2"]) == 0
    text = capsys.readouterr().out
    assert "Table 1" in text
    assert "Table 2" in text
    assert re.search(r"10 x 10 .* 80\.10 .* 169\.75", text)
    assert re.search(r"Accuracy above 73% in \d+ of 32 cells", text)
    assert main(["show", "runs/paper.sqlite", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert len(told["paper"]["cells"]) == 32


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run"], "Missing argument 'paper|quick|field|FILE.toml'"),
        (
            ["run", "papr"],
            "tournament must be one of paper, quick, field, or a file that ends in .toml, got 'papr'",
        ),
        (["run", "none.toml"], "there is no tournament file none.toml"),
        (["run", "bad.toml"], "bad.toml is not a TOML file"),
        (["run", "zero.toml"], "zero.toml: entrant 'sarsa': bins must be at least 1, got 0"),
        (["run", "unknown.toml"], "unknown.toml: agent must be one of"),
        (["run", "nan.toml"], "nan.toml: mass must be a finite number greater than 0, got nan"),
        (["run", "race.toml", "--jobs", "0"], "--jobs must not be 0"),
        (["run", "race.toml", "--replicates", "0"], "race.toml: replicates must be at least 1, got 0"),
        (["run", "race.toml", "--seed", "-1"], "race.toml: seed must be at least 0, got -1"),
        (["run", "race.toml", "--driver", "fast"], "Invalid value for '--driver'"),
        (["run", "race.toml", "--reading", "x"], "race.toml: reading must be one of"),
        (["run", "race.toml", "--out", "other.txt"], "other.txt is not a results file of the arena"),
        (["run", "race.toml", "--out", "."], "there is no results file ."),
        (["run", "race.toml", "--out", "other.txt/r.sqlite"], "cannot write the results file"),
        (["show", "none.sqlite"], "there is no results file none.sqlite"),
        (["show", "other.txt"], "other.txt is not a results file of the arena"),
        (["show"], "Missing argument 'FILE'"),
        (["fly"], "No such command 'fly'"),
        (["run", "race.toml", "--fast"], "No such option"),
    ],
)
def test_bad_input_is_one_clear_line_and_exit_code_2(
    race: str, capsys: pytest.CaptureFixture[str], arguments: list[str], message: str
) -> None:
    Path("bad.toml").write_text("[[[")
    Path("zero.toml").write_text("[[entrants]]\nagent = 'sarsa'\nparameters = { bins = 0 }")
    Path("unknown.toml").write_text("[[entrants]]\nagent = 'dqn'")
    Path("nan.toml").write_text("[hill]\nmass = nan\n[[entrants]]\nagent = 'sarsa'")
    Path("other.txt").write_text("precious")
    before = {path: path.read_bytes() for path in Path().rglob("*") if path.is_file()}
    assert main(arguments) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.startswith("arena: ")
    assert message in told.err
    assert told.err.count("\n") == 1
    assert {path: path.read_bytes() for path in Path().rglob("*") if path.is_file()} == before


@pytest.mark.parametrize("option", [["--jobs", "two"], ["--jobs=two"]])
def test_what_typer_refuses_is_named_once(
    race: str, capsys: pytest.CaptureFixture[str], option: list[str]
) -> None:
    assert main(["run", race, *option]) == 2
    told = capsys.readouterr().err  # of the words between, each version of Typer has its own
    assert re.fullmatch(r"arena: Invalid value for '--jobs': .*\bint(eger)?\b.*\n", told)
    assert told.count("'two'") == 1


def test_a_mistake_of_ours_is_no_bad_input(
    race: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*_: object) -> None:
        raise TypeError("unsupported operand type(s) for +: 'NoneType' and 'int'")

    assert main(["run", race, "--jobs", "1"]) == 0
    capsys.readouterr()
    monkeypatch.setattr("arena.results.results.Results.__init__", broken)
    assert main(["show", "runs/race.sqlite"]) == 70
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.startswith("Traceback")
    assert "arena: this is a mistake of the arena; please report it with the lines above" in told.err


def test_another_tournament_s_file_is_not_overwritten(race: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", race, "--jobs", "1"]) == 0
    before = Path("runs/race.sqlite").read_bytes()
    capsys.readouterr()
    assert main(["run", race, "--seed", "1"]) == 2
    assert "holds another tournament (its seed is 0, not 1)" in capsys.readouterr().err
    assert Path("runs/race.sqlite").read_bytes() == before


def test_a_tournament_s_name_is_no_path(race: str) -> None:
    Path("up.toml").write_text(RACE.replace('"race"', '"../up/../../race 1"'))
    assert main(["run", "up.toml", "--jobs", "1", "--replicates", "1"]) == 0
    assert sorted(path.suffix for path in Path("runs").iterdir()) == [".html", ".sqlite"]
    assert {path.stem for path in Path("runs").iterdir()} == {"-up-..-..-race-1"}


def test_help_names_the_commands_and_is_no_error(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == 0
    text = capsys.readouterr().out
    assert "run" in text
    assert "show" in text


def test_a_closed_pipe_is_no_error(tmp_path: Path, race: str) -> None:
    assert main(["run", race, "--jobs", "1"]) == 0
    reader, writer = os.pipe()
    os.close(reader)
    command = [sys.executable, "-m", "arena", "show", "runs/race.sqlite"]
    done = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, text=True, check=False)
    os.close(writer)
    assert "Traceback" not in done.stderr


WORDS = ["run", "show", "digest", "verify", "race.toml", "none.toml", "--jobs", "1", "0", "-1", "--out", "x"]
WORDS += [
    "--seed",
    "--driver",
    "fast",
    "--json",
    "--reading",
    "--replicates",
    "-",
    "",
    "\0",
    "--",
    "\ud800",
    ".",
]


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(arguments=st.lists(st.sampled_from(WORDS) | st.text(max_size=4), max_size=5))
def test_no_command_line_ends_in_a_traceback(arguments: list[str], race: str) -> None:
    assert main(arguments) in (0, 1, 2)
