"""Stdout has results only, and neither stream needs to be there, to be wide, or to know all characters."""

import io
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from made_up_results import made_up
from rich.console import Console

from arena.cli import main
from arena.cli.streams import results_apart, stdout
from arena.plugins.source_modules import _imported
from arena.report.fitted import FittedTable
from arena.tournament import load_tournament
from arena.tournament.hills import find_hill

MARK = "\ufeff"
LOUD = """
import atexit, os

def shout(when):
    print("SHOUT λ", when)
    os.write(1, b"SHOUT from C\\n")

class Loud:
    def __init__(self): shout("made")
    def act(self, observation, progress, rng): shout("act"); return 2 if observation[1] >= 0 else 0
    def learn(self, observation, action, reward, next_observation, terminated): shout("learn")
    def greedy(self, observation): shout("greedy"); return 2 if observation[1] >= 0 else 0

shout("imported")
atexit.register(shout, "exit")
"""
RACE = """
plugins = ["loud.py"]
replicates = 2
training = { episodes = 2, max_steps = 20 }
evaluation = { episodes = 2, max_steps = 200 }
entrants = [{ agent = "loud", name = "Loud(λ)" }, { agent = "loud", name = "ε-greedy" }]
"""
QUIET = """
training = { episodes = 2, max_steps = 20 }
evaluation = { episodes = 2, max_steps = 200 }
replicates = 1
entrants = [{ agent = "momentum", name = "λ" }, { agent = "random", name = "ε" }]
"""
RUN = ["run", "quiet.toml", "--jobs", "1", "--out", "again.sqlite"]
SHOWN = {
    "show": ["show", "FILE"],
    "csv": ["show", "FILE", "--csv"],
    "curves": ["curves", "FILE", "--window", "1"],
    "curves-csv": ["curves", "FILE", "--window", "1", "--csv"],
    "compare": ["compare", "FILE", "Sarsa(λ)", "ε-greedy"],
}


def arena(*arguments: str, cwd: Path, **how: object) -> "subprocess.CompletedProcess[str]":
    """The real command; what it prints, unless ``how`` says where to."""
    where = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "env": os.environ | {"PYTHONUTF8": "0"}}
    command = [sys.executable, "-m", "arena", *arguments]
    return subprocess.run(command, cwd=cwd, text=True, timeout=120, check=False, **{**where, **how})  # type: ignore[call-overload, no-any-return]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """With tournaments of agents that print in every way, and of quiet ones."""
    (tmp_path / "loud.py").write_text(MARK + LOUD, encoding="utf-8")
    (tmp_path / "loud.toml").write_text(MARK + RACE, encoding="utf-8")
    (tmp_path / "quiet.toml").write_text(MARK + QUIET, encoding="utf-8")
    return tmp_path


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("streams") / "race.sqlite"
    made_up({"Sarsa(λ)": [120.0, 121.0], "ε-greedy": [140.0, 141.0]}, path).close()
    return str(path)


@pytest.mark.parametrize("encoding", ["ascii", "cp1252"])
@pytest.mark.parametrize("command", SHOWN.values(), ids=SHOWN)
def test_what_the_encoding_lacks_is_replaced(
    command: list[str], encoding: str, file: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    written = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(written, encoding))
    assert main([argument.replace("FILE", file) for argument in command]) == 0
    assert "Sarsa(?)" in written.getvalue().decode(encoding)


def test_a_file_s_name_is_written_as_it_is(
    file: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(written, "ascii"))
    page = tmp_path / "\udcff.html"
    try:
        page.touch()
    except OSError:
        pytest.skip("this file system knows no such names")
    assert main(["report", file, "--out", str(page)]) == 0
    assert written.getvalue().endswith(b"\xff.html" + os.linesep.encode())


@pytest.mark.system
@pytest.mark.parametrize("jobs", ["1", "2"])
def test_a_tournament_runs_whatever_its_agents_print(folder: Path, jobs: str) -> None:
    narrow = os.environ | {"PYTHONIOENCODING": "cp1252"}
    arguments = ["run", "loud.toml", "--json", "--jobs", jobs, "--out", "race.sqlite"]
    done = arena(*arguments, cwd=folder, env=narrow, encoding="cp1252")
    assert done.returncode == 0, done.stderr
    assert {row["entrant"] for row in json.loads(done.stdout)["runs"] if row["status"] == "finished"} == {
        "Loud(λ)",
        "ε-greedy",
    }
    for when in ("imported", "made", "act", "learn", "greedy", "exit"):
        assert f"SHOUT \\u03bb {when}" in done.stderr
    assert "SHOUT from C" in done.stderr


@pytest.mark.system
@pytest.mark.parametrize("command", ["check loud.py --json", "agents --plugin loud.py --json"])
def test_json_stays_json_whatever_agents_print(folder: Path, command: str) -> None:
    done = arena(*command.split(), cwd=folder)
    assert "loud" in str(json.loads(done.stdout))
    assert "SHOUT" in done.stderr


@pytest.mark.system
def test_of_a_file_only_what_was_asked_for_is_on_stdout(folder: Path) -> None:
    assert arena("run", "loud.toml", "--jobs", "1", "--no-report", cwd=folder).returncode == 0
    verified = arena("verify", "runs/loud.sqlite", "--plugin", "loud.py", cwd=folder)
    assert (verified.stdout, "SHOUT" in verified.stderr) == ("no difference\n", True)


def test_meanwhile_print_goes_to_stderr(capsys: pytest.CaptureFixture[str]) -> None:
    with results_apart():
        print("aside")
        print("result", file=stdout())
    assert capsys.readouterr() == ("result\n", "aside\n")


@pytest.mark.system
@pytest.mark.parametrize("both", [False, True], ids=["stdout", "stderr too"])
@pytest.mark.parametrize(
    ("arguments", "code"),
    [(RUN, 0), (["agents", "--json"], 0), (["agents"], 0), (["--help"], 0), (["bogus"], 2)],
    ids=lambda value: value[0] if isinstance(value, list) else "",
)
def test_a_reader_that_has_seen_enough_is_no_failure(
    folder: Path, arguments: list[str], code: int, both: bool
) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    done = arena(*arguments, cwd=folder, stdout=writer, **{"stderr": writer} if both else {})
    os.close(writer)
    assert done.returncode == code
    assert both or "Broken" not in done.stderr
    assert "run" not in arguments or (folder / "again.html").exists()


@pytest.mark.system
@pytest.mark.skipif(os.name == "nt", reason="needs a shell that can close a stream")
@pytest.mark.parametrize("closed", [">&-", "2>&-", "<&- >&- 2>&-"])
def test_a_tournament_runs_without_streams(folder: Path, closed: str) -> None:
    run = ["run", "loud.toml", "--jobs", "2", "--strict", "--out", "again.sqlite"]
    command = ["sh", "-c", f'exec "$0" -m arena "$@" {closed}', sys.executable, *run]
    done = subprocess.run(command, cwd=folder, capture_output=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert (folder / "again.html").exists()
    assert (folder / "again.sqlite").read_bytes().startswith(b"SQLite format 3")
    assert b"Traceback" not in done.stderr


@pytest.mark.parametrize("stream", ["stdin", "stdout", "stderr"])
@pytest.mark.parametrize("closed", [False, True], ids=["None", "closed"])
def test_no_stream_needs_to_be_there(
    stream: str, closed: bool, file: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    nothing = io.StringIO() if closed else None
    if nothing:
        nothing.close()
    monkeypatch.setattr(sys, stream, nothing)
    assert [main(arguments) for arguments in (["show", file], ["--help"], ["bogus"])] == [0, 0, 2]
    assert getattr(sys, stream) is nothing


@pytest.mark.system
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is full")
@pytest.mark.parametrize("command", ["digest FILE", "agents --json", "--help"])
def test_results_that_cannot_be_written_are_told(tmp_path: Path, file: str, command: str) -> None:
    arguments = command.replace("FILE", file).split()
    with Path("/dev/full").open("w") as full:
        done = arena(*arguments, cwd=tmp_path, stdout=full)
        assert (done.returncode, done.stderr.count("\n")) == (2, 1)
        assert "No space left on device" in done.stderr
        assert arena(*arguments, cwd=tmp_path, stdout=full, stderr=full).returncode == 2


@pytest.mark.parametrize("columns", ["0", "1", "30", "40", "50"])
@pytest.mark.parametrize("command", ["show", "curves", "compare"])
def test_names_are_whole_in_any_terminal(
    command: str, columns: str, file: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", columns)
    assert main([argument.replace("FILE", file) for argument in SHOWN[command]]) == 0
    shown = capsys.readouterr().out
    assert "Sarsa(λ)" in shown
    assert "ε-greedy" in shown
    assert "…" not in shown
    assert columns != "0" or command != "show" or "iterations" in shown  # it is the usual width


@pytest.mark.parametrize("columns", ["0", "1", "30"])
def test_parameters_are_told_in_any_terminal(
    columns: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", columns)
    assert main(["agents"]) == 0
    assert "initial_values" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("width", "shown"), [(40, "bcad"), (22, "bca"), (16, "ca"), (14, "ca"), (8, "a"), (1, "a")]
)
def test_a_table_leaves_out_what_is_least_important(width: int, shown: str) -> None:
    table = FittedTable("a", "c", padding=0)
    for name in "bcad":
        table.add_column(name, no_wrap=True)
    table.add_row(*(name * 5 for name in "bcad"))
    console = Console(file=io.StringIO(), width=width, soft_wrap=True)
    with console.capture() as capture:
        console.print(table)
    assert capture.get().split()[: len(shown)] == list(shown)
    assert [word for word in capture.get().split() if len(word) == 5 and word.isalpha()] == [
        name * 5 for name in shown
    ]


def test_a_mark_at_the_beginning_of_a_text_is_none_of_it(folder: Path) -> None:
    assert load_tournament(folder / "quiet.toml").replicates == 1
    (folder / "hill.toml").write_text(f"{MARK}[hill]\nfriction = 0.1\n", encoding="utf-8")
    assert find_hill(str(folder / "hill.toml")).friction == 0.1
    (folder / "own.py").write_text(f"{MARK}import helper\n", encoding="utf-8")
    assert _imported("own", folder / "own.py", 0) == ("helper",)
