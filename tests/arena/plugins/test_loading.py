"""Every way in gets the same bits; names; results files without the plugin."""

import json
import re
from pathlib import Path

import pytest
from broken_plugins import DRIVER
from plugin_files import EDITS, NOTEBOOK, PLUGIN, RACE, RUN, RUN_IT, bits, from_file, python

from agents import agent_class, agent_name
from arena import load, load_plugin

pytestmark = pytest.mark.usefixtures("folder")


def test_a_plugin_file_gets_the_same_bits_on_two_workers_as_in_this_process() -> None:
    assert from_file(n_jobs=2) == from_file(n_jobs=1)


@pytest.mark.system
def test_the_command_line_option_and_the_tournament_file_load_the_same_agents(folder: Path) -> None:
    expected = from_file()
    done = python("-m", "arena", *RUN, "--plugin", "speedy.py", "--jobs", "2", "--out", "a.sqlite")
    assert done.returncode == 0, done.stderr
    assert bits(load("a.sqlite")) == expected
    Path("plugins").mkdir()
    Path("speedy.py").rename("plugins/speedy.py")  # the path is relative to the file that names it
    Path("races").mkdir()
    Path("races/race.toml").write_text(f'plugins = ["../plugins/speedy.py"]\n{RACE}')
    done = python("-m", "arena", "run", "races/race.toml", "--no-report", "--jobs", "2", "--out", "b.sqlite")
    assert done.returncode == 0, done.stderr
    assert bits(load("b.sqlite")) == expected
    with load("a.sqlite") as results:
        assert results.frame().groupby("entrant").driver.first().to_dict() == {
            "speedy": "compiled",
            "plodding": "pettingzoo",
        }


@pytest.mark.system
def test_classes_of_a_script_get_the_same_bits_as_those_of_a_file() -> None:
    expected = from_file()
    Path("script.py").write_text(f"{PLUGIN}\nout = 'r.sqlite'\n{RUN_IT}")  # without a guard for workers
    done = python("script.py")
    assert done.returncode == 0, done.stderr
    assert bits(load("r.sqlite")) == expected


@pytest.mark.system
def test_cells_of_a_notebook_that_are_run_again_get_the_bits_of_the_new_code() -> None:
    cells, expected = [], {}
    for number, edit in enumerate([("", ""), *EDITS.values()]):
        Path("speedy.py").write_text(PLUGIN.replace(*edit))
        expected[f"{number}.sqlite"] = from_file()
        cells += [PLUGIN.replace(*edit), f"out = '{number}.sqlite'", RUN_IT]
    Path("cells.json").write_text(json.dumps(cells))
    Path("notebook.py").write_text(NOTEBOOK)
    done = python("notebook.py")
    assert done.returncode == 0, done.stderr
    assert {name: bits(load(name)) for name in expected} == expected
    assert len({str(found) for found in expected.values()}) == len(expected)


# Names


@pytest.mark.parametrize(
    ("class_name", "expected"),
    [
        ("SpeedSeeker", "speed-seeker"),
        ("DQNAgent", "dqn-agent"),
        ("SB3DQN", "sb3-dqn"),
        ("Driver", "driver"),
        ("TD0", "td0"),
        ("NStepSarsa2", "n-step-sarsa2"),
        ("MyQLearner", "my-q-learner"),
        ("snake_case", "snake-case"),
        ("camelCase", "camel-case"),
    ],
)
def test_an_agent_is_called_as_its_class(class_name: str, expected: str) -> None:
    Path("named.py").write_text(DRIVER.replace("Driver", class_name))
    (name,) = load_plugin("named.py")
    assert name == expected
    assert agent_name(agent_class(expected)) == expected


def test_private_and_imported_classes_are_no_agents_of_the_file() -> None:
    more = "from agents import Sarsa\n\nclass _Base(Driver):\n    pass\n\nAlias = Driver\n"
    Path("named.py").write_text(f"{DRIVER}\n{more}")
    assert list(load_plugin("named.py")) == ["driver"]


# Results files


@pytest.mark.system
def test_a_results_file_is_read_without_the_plugin_and_verified_with_it() -> None:
    Path("speedy.py").write_text(
        f"{PLUGIN}\nopen('was-run', 'w').close()\n".replace("class Plodding", "class _P")
    )
    Path("race.toml").write_text(RACE.partition('[[entrants]]\nagent = "plodding"')[0])
    done = python("-m", "arena", *RUN, "--plugin", "speedy.py", "--jobs", "1")
    assert done.returncode == 0, done.stderr
    file = "runs/race.sqlite"
    Path("was-run").unlink()
    shown = python("-m", "arena", "show", file)
    assert (shown.returncode, shown.stdout, shown.stderr) == (0, done.stdout, "")
    assert python("-m", "arena", "digest", file).returncode == 0
    refused = python("-m", "arena", "verify", file)
    assert (refused.returncode, refused.stdout) == (2, "")
    assert re.fullmatch(r"arena: agent must be one of [^\n]*, got 'speedy'\n", refused.stderr)
    assert not Path("was-run").exists()  # no file runs code that it names
    verified = python("-m", "arena", "verify", file, "--plugin", "speedy.py")
    assert (verified.returncode, verified.stdout, verified.stderr) == (0, "no difference\n", "")
    assert Path("was-run").exists()
    Path("speedy.py").write_text(Path("speedy.py").read_text().replace("value + 0.25", "value + 0.75"))
    differs = python("-m", "arena", "verify", file, "--plugin", "speedy.py")
    assert differs.returncode == 1
    assert re.search(r"^replicate \d of 'speedy' differs in memory", differs.stdout)
