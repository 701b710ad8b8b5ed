"""What README and docs say is executed, and what they show is what the commands print."""

import ast
import json
import re
import runpy
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from broken_plugins import BROKEN
from paths import ROOT

from arena.tournament import from_dict
from arena.tournament.readings import READINGS

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
SESSION = ROOT / "docs" / "plugins.md"  # its blocks build on one another


def succeed(*arguments: str, cwd: Path) -> str:
    """What a Python process prints that ends well and in time."""
    command = [sys.executable, *arguments]
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stderr
    return done.stdout


def blocks(language: str, pages: list[Path] = PAGES) -> list[object]:
    """The code blocks of the pages in ``language``, as parameters of a test."""
    return [
        pytest.param(code, id=f"{page.name}-{number}")
        for page in pages
        if page != SESSION
        for number, code in enumerate(re.findall(rf"```{language}\n(.*?)```", page.read_text(), re.DOTALL))
    ]


@pytest.mark.docs
@pytest.mark.parametrize("code", blocks("python", PAGES[:1]))
def test_python_examples_of_the_readme_run_as_scripts(code: str, tmp_path: Path) -> None:
    (tmp_path / "example.py").write_text(code)
    succeed("-W", "error::DeprecationWarning:__main__", "example.py", cwd=tmp_path)


@pytest.mark.docs
@pytest.mark.parametrize("code", blocks("python", PAGES[1:]))
def test_python_examples_of_the_docs_run(code: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("example.py").write_text(code)
    runpy.run_path("example.py", run_name="__main__")  # starting Python and its workers would take longer


@pytest.mark.parametrize("code", blocks("toml"))
def test_toml_examples_are_tournaments(code: str) -> None:
    assert from_dict(tomllib.loads(code)).runs


@pytest.mark.docs
def test_the_page_on_plugins_is_a_session_that_goes_as_it_says(tmp_path: Path) -> None:
    done = {"toml": 0, "python": 0, "console": 0}
    shutil.copy(ROOT / "tests" / "support" / "stand_ins" / "stable_baselines3.py", tmp_path)
    for language, code in re.findall(r"```(\w+)\n(.*?)```", SESSION.read_text(), re.DOTALL):
        done[language] += 1
        name = re.match(r"# ([\w.]+)\n", code)
        if language == "console":
            converse(code, tmp_path)
        elif name and name[1] == "pyproject.toml":
            package = tomllib.loads((ROOT / "tests" / "plugin_package" / "pyproject.toml").read_text())
            offered = package["project"]["entry-points"]["arena.agents"].items()
            assert tomllib.loads(code)["project"]["entry-points"]["arena.agents"].items() <= offered
        elif name:
            (tmp_path / name[1]).write_text(code)
        else:
            (tmp_path / "example.py").write_text(code)
            succeed("-W", "error::DeprecationWarning:__main__", "example.py", cwd=tmp_path)
    assert min(done.values()) > 2


def converse(console: str, cwd: Path) -> None:
    """Run the commands after each ``$``; they print what the block says, ``...`` being anything."""
    code = 0
    for command, expected in re.findall(r"^\$ (.*)\n((?:(?!\$ ).*\n)*)", console, re.MULTILINE):
        if command == "echo $?":
            printed = f"{code}\n"
        else:
            done = subprocess.run(
                [sys.executable, "-m", *command.split()],
                cwd=cwd,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                timeout=300,
                check=False,
            )
            code, printed = done.returncode, done.stdout
        pattern = "".join(
            r"(.*\n)*" if line == "..." else re.escape(line).replace(r"\.\.\.", ".*") + r" *\n"
            for line in expected.splitlines()
        )
        assert re.fullmatch(pattern, printed), f"$ {command}\n{printed}"


def test_the_page_on_plugins_tells_every_kind_of_broken_file() -> None:
    rows = re.findall(r"^\| (.*) \| `(.*)` \|$", SESSION.read_text(), re.MULTILINE)
    assert dict(rows) == {kind: message for kind, (_, message) in BROKEN.items()}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)#]+)", page.read_text()):
        assert target.startswith("http") or (page.parent / target).exists(), target


def test_the_table_of_clients_is_of_the_tests_that_there_are() -> None:
    table = (ROOT / "docs" / "clients.md").read_text().split("<!-- table")[1].split("<!-- end")[0]
    rows = re.findall(r"^\| \| (.*?) \| (works|\[theirs\]\(.*?#L(\d+)\).*) \|$", table, re.MULTILINE)
    expected = []
    for path in sorted((ROOT / "tests" / "clients").glob("test_*.py")):
        for test in ast.parse(path.read_text()).body:
            if isinstance(test, ast.FunctionDef) and test.name.startswith("test_"):
                lines = [one.lineno for one in test.decorator_list if "theirs" in ast.unparse(one)]
                what = " ".join((ast.get_docstring(test) or "").split()).replace("``", "`")
                expected.append((what, str(min(one.lineno for one in test.decorator_list)) if lines else ""))
    assert [(what, line) for what, _, line in rows] == expected


def test_every_reading_is_documented() -> None:
    text = (ROOT / "docs" / "readings.md").read_text()
    for name, reading in READINGS.items():
        assert f"| `{name}` | {reading.description} |" in text


@pytest.mark.docs
@pytest.mark.parametrize(
    ("script", "arguments", "expected"),
    [
        ("grids_of_one_algorithm.py", "--episodes 5 --replicates 1 --bins 4 5 --jobs 1", "(5, 4)"),
        ("algorithms_on_one_grid.py", "--episodes 5 --replicates 2 --bins 4 4 --jobs 2", "momentum"),
        ("bench_learning.py", "--episodes 30 --repeats 1", "QLearning: "),
        ("bench_walk.py", "--episodes 2 --part 1 --repeats 1", "million steps a second"),
        (
            "bench_envs.py",
            "--seconds 0.01 --repeats 1 --cars 2 --vectors 3",
            "| vector | Gymnasium's sync vector | ratio |",
        ),
        ("measured_coverage.py", "--trials 3 --parts mean", "| mean, Student's t | normal | 5 | 95.0% |"),
        ("fit_of_readings.py", "--replicates 2 --readings literal --jobs 2", "| `literal` | zero table"),
        ("elimination.py", "--replicates 2 --rows SARSA any --episodes 9", "| SARSA draws a' anew | 2 | "),
        ("cost_of_the_protocol.py", "--replicates 2 --episodes 9", "| a goal that nothing follows | "),
    ],
)
def test_scripts_run(script: str, arguments: str, expected: str, tmp_path: Path) -> None:
    assert expected in succeed(str(ROOT / "scripts" / script), *arguments.split(), cwd=tmp_path)


@pytest.mark.docs
def test_the_readme_shows_what_the_command_prints(tmp_path: Path) -> None:
    output = succeed("-m", "arena", "run", "paper", cwd=tmp_path)
    printed = "\n".join(line.rstrip() for line in output.splitlines())
    shown = re.search(r"```text\n(.*?)\n```", (ROOT / "README.md").read_text(), re.DOTALL)
    assert shown is not None
    assert shown.group(1) == printed


@pytest.mark.timing
def test_the_learning_loop_keeps_up_with_one_written_by_hand() -> None:
    for name, row in json.loads(succeed("scripts/bench_learning.py", "--json", cwd=ROOT)).items():
        assert row["ratio"] <= 1.5, name


@pytest.mark.timing
def test_the_environments_keep_up_with_bare_dictionaries_and_leave_gymnasium_s_vector_behind() -> None:
    output = succeed("scripts/bench_envs.py", "--seconds=0.2", "--vectors=64", cwd=ROOT)
    rows = [line.strip("| ").split(" | ") for line in output.splitlines() if re.match(r"\| \d", line)]
    for cars, _, _, ratio, *_ in rows[:4]:
        assert float(ratio) >= 0.5, cars  # 0.8 and more on an idle machine
    assert float(rows[4][3]) > 20  # 60


@pytest.mark.system
def test_the_paper_s_tournament_stays_under_a_gibibyte(tmp_path: Path) -> None:
    code = """
import os, threading
from arena import paper, run

def tree():
    total, todo = 0, [os.getpid()]
    while todo:
        pid = todo.pop()
        try:
            with open(f"/proc/{pid}/smaps_rollup") as f:
                total += next(int(line.split()[1]) for line in f if line.startswith("Pss:"))
            for task in os.listdir(f"/proc/{pid}/task"):
                with open(f"/proc/{pid}/task/{task}/children") as f:
                    todo += map(int, f.read().split())
        except (OSError, StopIteration):
            pass
    return total / 1024

peak, over = 0.0, threading.Event()

def watch():
    global peak
    while not over.wait(0.2):
        peak = max(peak, tree())

if __name__ == "__main__":
    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    run(paper(replicates=2), "r.sqlite").frame()
    over.set()
    watcher.join()
    print(peak)
"""
    if not Path("/proc/self/smaps_rollup").exists():
        pytest.skip("the memory of all processes together is read from Linux's /proc")
    (tmp_path / "watched.py").write_text(code)
    peak = float(succeed("watched.py", cwd=tmp_path))
    print(f"peak memory {peak:.0f} MiB")
    assert 100 < peak < 1024
