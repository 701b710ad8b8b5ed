"""``arena new-agent``: what it writes runs, passes and is short."""

import ast
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from agents import registry
from arena import Entrant, Evaluation, Tournament, Training, load_plugin, run
from arena.cli import main
from arena.plugins.template import AGENT, TEST, write
from arena.testing import findings
from arena.testing.checks import CHECKS
from arena.testing.timing import seconds_per_step

METHODS = ["create", "act", "learn", "greedy"]


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, isolated_registry: None) -> None:
    """An empty current folder; what a test registers, no other finds."""
    monkeypatch.chdir(tmp_path)


def test_both_files_are_written_and_the_next_step_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new-agent", "my-agent", "--folder", "deep/down"]) == 0
    agent, test = Path("deep/down/my_agent.py"), Path("deep/down/test_my_agent.py")
    assert capsys.readouterr() == (f"wrote {agent} and {test}; next: arena check {agent}\n", "")
    assert sorted(Path("deep/down").iterdir()) == [agent, test]


def test_the_agent_holds_to_the_contract_compiled() -> None:
    assert main(["new-agent", "my-agent"]) == 0
    ((name, agent),) = load_plugin("my_agent.py").items()
    assert (name, agent.__name__) == ("my-agent", "MyAgent")
    assert {one.status for one in findings(Entrant(name, agent))} == {"ok"}


def test_the_agent_learns_to_drive() -> None:
    main(["new-agent", "my-agent"])
    entrant = Entrant("it", load_plugin("my_agent.py")["my-agent"])
    tournament = Tournament((entrant,), training=Training(1000), evaluation=Evaluation(100), replicates=2)
    with run(tournament, n_jobs=1) as results:
        frame = results.frame()
    assert set(frame.driver) == {"compiled"}
    assert frame.accuracy.mean() > 80.0


@pytest.mark.system
def test_its_test_passes_where_its_author_runs_it() -> None:
    assert main(["new-agent", "my-agent"]) == 0
    command = [sys.executable, "-m", "pytest", "-q", "-W", "error"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stdout
    assert re.search(rf"^{len(CHECKS)} passed in ", done.stdout, re.MULTILINE)
    code = Path("my_agent.py").read_text().replace("        best = 0\n", "        best = 3\n")
    Path("my_agent.py").write_text(code)
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 1
    assert "FAILED test_my_agent.py::test_contract[my-agent-actions_are_valid]" in done.stdout


def test_the_command_checks_the_new_agent(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new-agent", "my-agent"]) == 0
    capsys.readouterr()
    assert main(["check", "my_agent.py"]) == 0
    printed = capsys.readouterr()
    assert printed.err == ""
    assert printed.out.count("  ok      ") == len(CHECKS)


@pytest.mark.parametrize("there", ["my_agent.py", "test_my_agent.py"])
def test_a_file_that_is_there_is_left_alone(there: str, capsys: pytest.CaptureFixture[str]) -> None:
    Path(there).write_text("precious")
    assert main(["new-agent", "my-agent"]) == 2
    assert capsys.readouterr() == ("", f"arena: {there} is there already\n")
    assert [(path.name, path.read_text()) for path in Path().iterdir()] == [(there, "precious")]


def test_a_second_call_changes_nothing() -> None:
    assert main(["new-agent", "my-agent"]) == 0
    before = {path: path.read_bytes() for path in Path().iterdir()}
    assert main(["new-agent", "my-agent"]) == 2
    assert {path: path.read_bytes() for path in Path().iterdir()} == before


@pytest.mark.parametrize(
    "name",
    [
        "",
        "-",
        "My-agent",
        "my_agent",
        "my agent",
        "my--agent",
        "my-agent-",
        "2fast",
        "é",
        "../up",
        "a/b",
        "my.py",
    ],
)
def test_a_bad_name_is_refused(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new-agent", "--", name]) == 2
    told = capsys.readouterr()
    rule = "NAME must be lower-case words joined by dashes, such as my-agent, got"
    assert told == ("", f"arena: {rule} {name!r}\n")
    assert list(Path().iterdir()) == []


@pytest.mark.parametrize("name", ["sarsa", "q-learning", "random", "numpy", "agents"])
def test_a_name_that_would_hide_another_is_refused(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new-agent", name]) == 2
    rule = "NAME must not be that of another agent or of a Python module, got"
    assert capsys.readouterr() == ("", f"arena: {rule} {name!r}\n")
    assert list(Path().iterdir()) == []


def test_a_folder_that_cannot_be_made_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    Path("file").write_text("")
    assert main(["new-agent", "my-agent", "--folder", "file"]) == 2
    told = capsys.readouterr().err
    assert told.startswith("arena: ")
    assert told.count("\n") == 1


@pytest.mark.parametrize("name", ["grid", "named-tuple", "probability", "step-size", "none", "true"])
def test_a_name_that_the_agent_needs_for_itself_is_refused(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["new-agent", name]) == 2
    rule = "NAME must not be that of a class which the agent needs, got"
    assert capsys.readouterr() == ("", f"arena: {rule} {name!r}\n")


@pytest.mark.parametrize(
    ("name", "class_name", "called"),
    [("a-b", "AB", "ab"), ("my-agent-2", "MyAgent2", "my-agent2"), ("x-1-y", "X1Y", "x1-y")],
)
def test_a_name_that_a_class_cannot_have_is_refused_with_the_one_that_it_would_have(
    name: str, class_name: str, called: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["new-agent", name]) == 2
    told = f"NAME must be what its class is called, which for {class_name} is {called}, got {name!r}"
    assert capsys.readouterr() == ("", f"arena: {told}\n")
    assert main(["new-agent", called]) == 0


@settings(max_examples=200, deadline=None)
@given(st.lists(st.from_regex("[a-z0-9]{1,3}|none|sarsa|grid|[a-zA-Z_]{1,4}", fullmatch=True), max_size=4))
def test_an_agent_is_called_as_it_was_asked_for_or_refused(words: list[str]) -> None:
    name = "-".join(words)
    with tempfile.TemporaryDirectory() as folder:
        refused = ""
        try:
            file, _ = write(name, Path(folder))
        except ValueError as error:
            refused = str(error)
        if refused:
            assert re.fullmatch(f"NAME must .*, got {name!r}", refused)
            assert list(Path(folder).iterdir()) == []
        else:
            assert list(load_plugin(file)) == [name]
            registry.forget(f"plugin {os.path.realpath(file)}")


def test_the_author_s_part_is_twenty_lines_of_code_at_most() -> None:
    module = ast.parse(AGENT.format(title="It", class_name="It", module="it"))
    (it,) = (node for node in module.body if isinstance(node, ast.ClassDef))
    methods = [node for node in it.body if isinstance(node, ast.FunctionDef)]
    assert [method.name for method in methods] == METHODS
    lines = {
        line
        for method in methods
        for statement in method.body
        for line in range(statement.lineno, (statement.end_lineno or statement.lineno) + 1)
    }
    assert 0 < len(lines) <= 20


def test_the_agent_explains_itself_and_its_test_is_complete() -> None:
    for method in METHODS:
        before = AGENT.partition(f"    def {method}(")[0].splitlines()
        assert any(line.startswith("    # ") for line in before[-4:]), method
    compile(TEST.format(class_name="It", module="it"), "test_it.py", "exec")


@pytest.mark.timing
def test_a_step_takes_at_most_half_as_long_again_as_the_built_in_q_learning_s() -> None:
    main(["new-agent", "my-agent"])
    entrant = Entrant("it", load_plugin("my_agent.py")["my-agent"])
    ratios = []
    for _ in range(8):  # the machine may be busy with something else
        step, reference = seconds_per_step(entrant, seconds=0.3)
        ratios.append(step / reference)
        if min(ratios) <= 1.5:
            break
    print(f"ratios {', '.join(f'{ratio:.2f}' for ratio in ratios)}")
    assert min(ratios) <= 1.5
