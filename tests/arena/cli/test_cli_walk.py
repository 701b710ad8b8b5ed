"""``arena walk``, as users run it."""

import json
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from paths import ROOT

from arena import random_walk
from arena.cli import main
from envs import Hill, Integrator

NEAR = """
[hill]
goal_position = -0.35
integrator = "explicit"
"""
STEEP = "[hill]\nthrust = 0.0\n"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with near.toml (short walks) and steep.toml (a goal out of reach)."""
    monkeypatch.chdir(tmp_path)
    Path("near.toml").write_text(NEAR)
    Path("steep.toml").write_text(STEEP)
    return tmp_path


def told(capsys: pytest.CaptureFixture[str], *arguments: str, code: int = 0) -> str:
    """What the command prints on stdout."""
    assert main(["walk", "--jobs", "1", *arguments]) == code
    printed = capsys.readouterr()
    assert printed.err == ""
    return printed.out


def test_json_is_the_walk_of_the_hill_s_own_integrator(capsys: pytest.CaptureFixture[str]) -> None:
    found = json.loads(told(capsys, "--hill", "near.toml", "--episodes", "30", "--seed", "4", "--json"))
    hill = Hill(goal_position=-0.35, integrator="explicit")
    walk = random_walk(30, hill, 4, n_jobs=1)
    assert {key: found[key] for key in walk.to_dict()} == walk.to_dict()
    assert list(found["summaries"]) == ["explicit", "semi-implicit"]
    other = random_walk(30, hill._replace(integrator=Integrator.SEMI_IMPLICIT), 4, n_jobs=1)
    assert found["summaries"]["explicit"]["mean"] == walk.lengths.mean()
    assert found["summaries"]["semi-implicit"]["least"] == other.lengths.min()
    assert len(found["fits"]) == 6


def test_an_integrator_alone_and_files(capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--hill", "near.toml", "--episodes", "30", "--integrator", "semi-implicit"]
    text = told(capsys, *options, "--out", "walk.json", "--figure", "walk.svg")
    assert "explicit" not in text.replace("semi-implicit", "")
    assert "paper" not in text.replace("the paper suggests", "")
    assert json.loads(Path("walk.json").read_text()) == json.loads(told(capsys, *options, "--json"))
    assert Path("walk.svg").read_text().startswith("<?xml")


def test_the_paper_s_hill_is_shown_beside_the_paper(capsys: pytest.CaptureFixture[str]) -> None:
    text = told(capsys, "--episodes", "50")
    rows = dict(re.findall(r"^ ?(\w[\w ,]*?)  +(\S.*?) *$", text, re.MULTILINE))
    assert rows["longest episode, steps"].split()[-1] == "324,776"
    assert rows["least velocity"].split()[-1] == "-0.06588"
    assert re.search(r"^semi-implicit: .* may have been made so\.$", text, re.MULTILINE)
    assert re.search(r"^explicit, Eq\. \(6\) as printed: .* were not made so\.$", text, re.MULTILINE)
    assert "rejected" in text or "may be log-normal" in text


def test_a_goal_out_of_reach_ends_at_the_limit_and_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    options = [
        "--hill",
        "steep.toml",
        "--episodes",
        "3",
        "--max-steps",
        "500",
        "--integrator",
        "semi-implicit",
    ]
    text = told(capsys, *options)
    assert "the goal was never reached; all 3 episodes were given up at the limit of 500 steps" in text
    assert "distribution " not in text.splitlines()[-2]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--episodes", "0"], "episodes must be at least 1, got 0"),
        (["--episodes", "x"], "Invalid value for '--episodes': "),
        (["--seed", "-1"], "seed must be at least 0, got -1"),
        (["--max-steps", "0"], "max_steps must be at least 1, got 0"),
        (["--jobs", "0"], "--jobs must not be 0: give a number of workers, or -1 for one a core"),
        (
            ["--hill", "high"],
            "hill must be one of paper, as-run, constrained, or a file that ends in .toml, got 'high'",
        ),
        (["--hill", "none.toml"], "there is no file none.toml"),
        (["--hill", "empty.toml"], "empty.toml: hill must be a table, got None"),
        (["--hill", "bad.toml"], "bad.toml: mass must be a finite number greater than 0, got -1.0"),
        (["--hill", "typo.toml"], "typo.toml: key of hill must be one of"),
        (["--hill", "broken.toml"], "broken.toml is not a TOML file"),
        (["--integrator", "euler"], "integrator must be one of explicit, semi-implicit, got 'euler'"),
        (["--figure", "f.gif"], "--figure must end in one of .png, .svg, .pdf, got 'f.gif'"),
        (["--out", "."], "--out must be a file in a folder that exists, got '.'"),
        (["--out", "no/o.json"], "--out must be a file in a folder that exists, got"),
        (["--figure", "no/f.png"], "--figure must be a file in a folder that exists, got"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(
    options: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("empty.toml").write_text("seed = 1\n")
    Path("bad.toml").write_text("[hill]\nmass = -1.0\n")
    Path("typo.toml").write_text("[hill]\nmas = 1.0\n")
    Path("broken.toml").write_text("[hill\n")
    assert main(["walk", "--episodes", "1", *options]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith(f"arena: {message}")
    assert printed.err.count("\n") == 1


def interrupted_at_once(*_: Any) -> Iterator[Any]:
    raise KeyboardInterrupt


def test_an_interruption_leaves_what_was_finished_and_says_so(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(_: int, function: Any, tasks: list[Any]) -> Iterator[Any]:
        yield function(*tasks[0])
        raise KeyboardInterrupt

    monkeypatch.setattr("arena.walks.series.parallel_map_unordered", interrupted)
    assert main(["walk", "--hill", "near.toml", "--episodes", "60", "--out", "walk.json", "--json"]) == 130
    printed = capsys.readouterr()
    assert printed.err == "arena: interrupted after 25 of 60 episodes (explicit)\n"
    assert len(json.loads(printed.out)["lengths"]) == 25
    assert json.loads(printed.out)["fits"] == []
    assert json.loads(Path("walk.json").read_text()) == json.loads(printed.out)


def test_an_interruption_of_the_fits_leaves_the_walks(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("arena.walks.distributions.parallel_map_unordered", interrupted_at_once)
    assert main(["walk", "--hill", "near.toml", "--episodes", "20", "--jobs", "1", "--json"]) == 130
    printed = capsys.readouterr()
    assert printed.err == "arena: interrupted while distributions were fitted\n"
    assert len(json.loads(printed.out)["lengths"]) == 20


def test_an_interruption_before_anything_was_finished(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("arena.walks.series.parallel_map_unordered", interrupted_at_once)
    assert main(["walk", "--episodes", "60", "--out", "walk.json"]) == 130
    printed = capsys.readouterr()
    assert (printed.out, printed.err) == ("", "arena: interrupted after 0 of 60 episodes (semi-implicit)\n")
    assert not Path("walk.json").exists()


@pytest.mark.docs
def test_the_page_shows_what_the_command_prints(capsys: pytest.CaptureFixture[str]) -> None:
    printed = "\n".join(line.rstrip() for line in told(capsys).splitlines())
    page = (ROOT / "docs" / "walk.md").read_text()
    shown = re.search(r"```text\n(.*?)\n```", page, re.DOTALL)
    assert shown is not None
    assert shown[1] == printed
    example = re.search(r"```python\n(.*?)```\n\n```\n(.*?)```", page, re.DOTALL)
    assert example is not None
    command = [sys.executable, "-c", example[1]]
    assert subprocess.run(command, capture_output=True, text=True, check=True).stdout == example[2]


@pytest.mark.docs
def test_the_page_on_physics_shows_what_the_script_prints() -> None:
    command = [sys.executable, str(ROOT / "scripts" / "energies.py"), "--out", "energies.png"]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert printed in (ROOT / "docs" / "physics.md").read_text()
    assert Path("energies.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.system
@pytest.mark.skipif(sys.platform == "win32", reason="sends POSIX signals")
def test_ctrl_c_reaches_all_workers() -> None:
    command = [sys.executable, "-m", "arena", "walk", "--episodes", "100000", "--jobs", "2", "--json"]
    before = signal.signal(
        signal.SIGINT, signal.default_int_handler
    )  # where it is ignored, children ignore it
    try:
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            time.sleep(25)
            process.send_signal(signal.SIGINT)
            printed, said = process.communicate(timeout=120)
    finally:
        signal.signal(signal.SIGINT, before)
    assert process.returncode == 130
    finished = len(json.loads(printed)["lengths"])
    assert said == f"arena: interrupted after {finished} of 100000 episodes (semi-implicit)\n"
    assert finished > 25
