"""Mistakes in a plugin are told in one sentence; in a tournament only its entrants fail."""

import json
import sys
from pathlib import Path

import pytest
from bits import bits_of
from broken_plugins import BROKEN, DRIVER
from plugin_files import RACE, RUN, from_file, python

from agents.registry import all_agents
from arena import load_plugin, run
from arena.cli import main
from arena.tournament import load_tournament

pytestmark = pytest.mark.usefixtures("folder")


def break_it(kind: str) -> str:
    """Write ``bad.py``; what the user is told of it."""
    content, message = BROKEN[kind]
    if content is not None:
        Path("bad.py").write_bytes(content)
    return message.replace("FOLDER", str(Path.cwd()))


@pytest.mark.parametrize("kind", BROKEN)
def test_a_broken_file_on_the_command_line_is_one_line_and_exit_code_2(
    kind: str, capsys: pytest.CaptureFixture[str]
) -> None:
    message = break_it(kind)
    assert main(["run", "race.toml", "--plugin", "bad.py"]) == 2
    assert capsys.readouterr() == ("", f"arena: {message}\n")
    assert not Path("runs").exists()
    assert main(["check", "bad.py"]) == 2
    assert capsys.readouterr() == ("", f"arena: {message}\n")


@pytest.mark.parametrize("kind", BROKEN)
def test_a_broken_file_in_a_tournament_makes_only_its_entrants_fail(
    kind: str, caplog: pytest.LogCaptureFixture
) -> None:
    expected = from_file()
    message = break_it(kind)
    caplog.clear()
    name = "dqn-driver" if kind == "two classes of one name" else "driver"
    Path("race.toml").write_text(f"plugins = ['bad.py', 'speedy.py']\n{RACE}[[entrants]]\nagent = '{name}'\n")
    with run(load_tournament("race.toml"), n_jobs=1) as results:
        runs = {one["entrant"]: one for one in results.runs}
        scores, arrays = bits_of(results)
    assert caplog.messages[0] == message
    assert not [line for line in caplog.messages if "Unavailable" in line]
    assert runs[name]["status"] == "failed"
    assert runs[name]["error"] == f"agent {name!r} is not available: {message}"
    others = {key: found for key, found in arrays.items() if key[0] != name}
    assert ([row for row in scores if row[0] != name], others) == expected


def test_a_folder_is_no_plugin(capsys: pytest.CaptureFixture[str]) -> None:
    Path("bad.py").mkdir()
    assert main(["run", "race.toml", "--plugin", "bad.py"]) == 2
    told = capsys.readouterr().err
    assert told.startswith("arena: plugin bad.py cannot be read: ")
    assert told.count("\n") == 1


def test_two_files_with_one_name_are_told_apart(capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("one.py", "two.py"):
        Path(name).write_text(DRIVER)
    here = Path.cwd()
    taken = f"has a name that is taken: plugin {here}/one.py"
    message = f"plugin two.py: agent 'driver' of plugin {here}/two.py {taken}"
    assert main(["run", "race.toml", "--plugin", "one.py", "--plugin", "two.py"]) == 2
    assert capsys.readouterr() == ("", f"arena: {message}\n")
    assert main(["agents", "--plugin", "one.py", "--plugin", "two.py", "--json"]) == 0
    out, err = capsys.readouterr()
    assert err == f"arena: {message}\n"
    assert json.loads(out)["driver"]["origin"] == f"plugin {here}/one.py"


def test_one_file_may_be_named_twice(capsys: pytest.CaptureFixture[str]) -> None:
    Path("link.py").symlink_to("speedy.py")
    Path("race.toml").write_text(f'plugins = ["speedy.py", "./speedy.py", "link.py"]\n{RACE}')
    assert main([*RUN, "--plugin", "speedy.py", "--jobs", "1", "--strict"]) == 0


def test_a_file_of_which_one_agent_is_bad_registers_none() -> None:
    break_it("the name of a built-in agent")
    with pytest.raises(ValueError, match="name that is taken"):
        load_plugin("bad.py")
    assert "driver" not in all_agents()[0]


def test_the_line_of_a_mistake_in_an_imported_module_is_that_of_the_import(folder: Path) -> None:
    (folder / "mistaken_helper.py").write_text("\n\n\nclass\n")
    Path("bad.py").write_text(f"import sys\nsys.path.insert(0, {str(folder)!r})\nimport mistaken_helper\n")
    try:
        with pytest.raises(ValueError, match=r"^plugin bad\.py, line 3: SyntaxError: invalid syntax$"):
            load_plugin("bad.py")
    finally:
        sys.path.remove(str(folder))


def test_a_file_with_a_byte_order_mark_is_read() -> None:
    Path("marked.py").write_bytes(b"\xef\xbb\xbf" + DRIVER.encode())
    assert list(load_plugin("marked.py")) == ["driver"]


@pytest.mark.system
def test_what_the_user_sees_of_a_broken_file_has_no_traceback() -> None:
    message = break_it("a package that is not installed")
    done = python("-m", "arena", "run", "race.toml", "--plugin", "bad.py")
    assert (done.returncode, done.stdout, done.stderr) == (2, "", f"arena: {message}\n")
    Path("race.toml").write_text(f"plugins = ['bad.py', 'speedy.py']\n{RACE}[[entrants]]\nagent = 'driver'\n")
    done = python("-m", "arena", *RUN, "--jobs", "1")
    assert done.returncode == 0
    assert done.stderr.splitlines()[0] == message
    assert "Traceback" not in done.stdout + done.stderr
    assert "driver replicate 0 failed: agent 'driver' is not available: plugin bad.py" in done.stdout
    assert python("-m", "arena", *RUN, "--jobs", "1", "--strict").returncode == 1
