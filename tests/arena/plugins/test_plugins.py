"""Agents of one's own: every way in gives the same bits, edited code is never stale, mistakes are told."""

import importlib
import json
import math
import re
import subprocess
import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from bits import bits_of
from broken_plugins import BROKEN, DRIVER
from joblib.externals.loky import get_reusable_executor

from agents import agent_class, agent_name, registry
from agents.parameters import parameters_of
from agents.registry import all_agents
from arena import Entrant, Evaluation, Results, Tournament, Training, load, load_plugin, run, sweep
from arena.cli import main
from arena.testing import findings
from arena.tournament import load_tournament

# Two agents of one behaviour, one compiled, one not; what they learn shows every part of the code.
PLUGIN = """
from typing import Annotated, Literal, NamedTuple

import numpy as np
from annotated_types import Interval

GAIN = 1.0


def grown(value):
    return value + 0.25


class Speedy(NamedTuple):
    memory: np.ndarray
    step_size: float

    @classmethod
    def create(
        cls,
        task,
        *,
        step_size: Annotated[float, Interval(gt=0, le=1)] = 0.5,
        bins: tuple[int, int] = (3, 4),
        mood: Literal["bold", "shy"] = "bold",
    ):
        return cls(np.zeros(task.n_actions), step_size)

    def act(self, observation, progress, rng):
        return int(rng.random() * 3)

    def learn(self, observation, action, reward, next_observation, next_action, terminated):
        self.memory[action] += self.step_size * grown(GAIN + next_observation[0])

    def greedy(self, observation):
        return 2 if observation[1] >= 0.0 else 0


class Plodding:
    def __init__(self):
        self.memory = np.zeros(3)

    act = Speedy.act
    greedy = Speedy.greedy

    def learn(self, observation, action, reward, next_observation, next_action, terminated):
        self.memory[action] += 0.5 * grown(GAIN + next_observation[0])
"""
EDITS = {
    "a method": ("0.5 * grown", "2.5 * grown"),
    "a helper function": ("value + 0.25", "value + 0.75"),
    "a constant": ("GAIN = 1.0", "GAIN = 3.0"),
}
RACE = """
name = "race"
replicates = 2
seed = 7
[training]
episodes = 6
max_steps = 120
[evaluation]
episodes = 5
max_steps = 150
[[entrants]]
agent = "speedy"
[[entrants]]
agent = "plodding"
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with a plugin and a race in it. What a test registers, no other finds."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(registry, "_registered", {})
    Path("speedy.py").write_text(PLUGIN)
    Path("race.toml").write_text(RACE)
    return tmp_path


def python(*arguments: str) -> subprocess.CompletedProcess[str]:
    """A process of its own, in the current folder."""
    return subprocess.run(
        [sys.executable, *arguments], capture_output=True, text=True, timeout=180, check=False
    )


def race_of(**agents: Any) -> Tournament:
    """What the file ``race.toml`` describes, with these agents under these names."""
    return Tournament(
        tuple(Entrant(name, agent) for name, agent in agents.items()),
        training=Training(episodes=6, max_steps=120),
        evaluation=Evaluation(episodes=5, max_steps=150),
        replicates=2,
        seed=7,
        name="race",
    )


def bits(results: Results) -> Any:
    """Scores and arrays of all runs, which must not have failed."""
    with results:
        assert [one.get("error", "") for one in results.runs] == [""] * len(results.runs)
        return bits_of(results)


def from_file(n_jobs: int = 1) -> Any:
    """The bits of the race with the agents of ``speedy.py``, loaded now."""
    return bits(run(race_of(**load_plugin("speedy.py")), n_jobs=n_jobs))


# Ways in


def test_a_plugin_file_gets_the_same_bits_on_two_workers_as_in_this_process() -> None:
    assert from_file(n_jobs=2) == from_file(n_jobs=1)


@pytest.mark.slow
def test_the_command_line_option_and_the_tournament_file_load_the_same_agents(folder: Path) -> None:
    expected = from_file()
    done = python(
        "-m", "arena", "run", "race.toml", "--plugin", "speedy.py", "--jobs", "2", "--out", "a.sqlite"
    )
    assert done.returncode == 0, done.stderr
    assert bits(load("a.sqlite")) == expected
    Path("plugins").mkdir()
    Path("speedy.py").rename("plugins/speedy.py")  # the path is relative to the file that names it
    Path("races").mkdir()
    Path("races/race.toml").write_text(f'plugins = ["../plugins/speedy.py"]\n{RACE}')
    done = python("-m", "arena", "run", "races/race.toml", "--jobs", "2", "--out", "b.sqlite")
    assert done.returncode == 0, done.stderr
    assert bits(load("b.sqlite")) == expected
    with load("a.sqlite") as results:
        assert results.frame().groupby("entrant").driver.first().to_dict() == {
            "speedy": "compiled",
            "plodding": "pettingzoo",
        }


RUN_IT = """
from arena import *
tournament = Tournament(
    (Entrant("speedy", Speedy), Entrant("plodding", Plodding)),
    training=Training(6, 120), evaluation=Evaluation(5, 150), replicates=2, seed=7, name="race",
)
run(tournament, out, n_jobs=2).close()
"""


@pytest.mark.slow
def test_classes_of_a_script_get_the_same_bits_as_those_of_a_file() -> None:
    expected = from_file()
    Path("script.py").write_text(f"{PLUGIN}\nout = 'r.sqlite'\n{RUN_IT}")  # without a guard for workers
    done = python("script.py")
    assert done.returncode == 0, done.stderr
    assert bits(load("r.sqlite")) == expected


NOTEBOOK = """
import json, pathlib, sys
for number, cell in enumerate(json.loads(pathlib.Path("cells.json").read_text())):
    exec(compile(cell, f"<cell {number}>", "exec"), vars(sys.modules["__main__"]))
"""


@pytest.mark.slow
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


# Edited code


@pytest.mark.slow
@pytest.mark.parametrize("edit", EDITS.values(), ids=EDITS)
def test_an_edited_file_runs_as_in_a_fresh_process(edit: tuple[str, str]) -> None:
    before = from_file(n_jobs=2)
    Path("speedy.py").write_text(PLUGIN.replace(*edit))
    after = from_file(n_jobs=2)  # the workers are warm
    assert after != before
    command = ["-m", "arena", "run", "race.toml", "--plugin", "speedy.py", "--jobs", "1", "--out", "r.sqlite"]
    assert python(*command).returncode == 0
    assert bits(load("r.sqlite")) == after
    Path("speedy.py").write_text(PLUGIN)
    assert from_file(n_jobs=2) == before


def test_agents_that_an_edited_file_no_longer_defines_are_forgotten() -> None:
    load_plugin("speedy.py")
    assert agent_class("plodding").__name__ == "Plodding"
    Path("speedy.py").write_text(PLUGIN.replace("Plodding", "Trudging"))
    load_plugin("speedy.py")
    assert agent_class("trudging").__name__ == "Trudging"
    with pytest.raises(ValueError, match="got 'plodding'"):
        agent_class("plodding")


def test_a_file_that_is_broken_by_an_edit_does_not_run_as_it_was_before() -> None:
    Path("race.toml").write_text(f'plugins = ["speedy.py"]\n{RACE}')
    assert bits(run(load_tournament("race.toml"), n_jobs=1))
    Path("speedy.py").write_text(f"{PLUGIN}\nclass\n")
    with run(load_tournament("race.toml"), n_jobs=1) as results:
        assert {one["status"] for one in results.runs} == {"failed"}


def test_results_of_an_edited_plugin_are_not_mixed_with_those_of_before() -> None:
    arguments = ["run", "race.toml", "--plugin", "speedy.py", "--jobs", "1", "--out", "r.sqlite"]
    assert main(arguments) == 0
    before = Path("r.sqlite").read_bytes()
    Path("speedy.py").write_text(PLUGIN.replace(*EDITS["a constant"]))
    assert main(arguments) == 2
    assert Path("r.sqlite").read_bytes() == before


SHARE = "library_helper.share()"


class Library:
    """Two importable modules: agents, and a helper that they import."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.edits = [(old.replace("0.25", SHARE), new.replace("0.75", "0.5")) for old, new in EDITS.values()]
        self.text = PLUGIN.replace("import numpy as np", "import numpy as np\n\nimport library_helper")
        self.text = self.text.replace("value + 0.25", f"value + {SHARE}")
        self.write("library_agents", self.text)
        self.write("library_helper", "def share():\n    return 0.25\n")
        importlib.invalidate_caches()
        self.agents = importlib.import_module("library_agents")

    def write(self, module: str, text: str) -> None:
        (self.folder / f"{module}.py").write_text(text)

    def race(self, n_jobs: int = 2, driver: str = "auto") -> Results:
        tournament = race_of(speedy=self.agents.Speedy, plodding=self.agents.Plodding)
        return run(tournament, n_jobs=n_jobs, driver=driver)


@pytest.fixture
def library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Library]:
    """Modules that this process and its workers can import; the workers are new."""
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # a cached one is trusted for a second
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    monkeypatch.syspath_prepend(str(tmp_path))  # workers get the path of when they start
    new_workers()
    yield Library(tmp_path)
    for name in ("library_agents", "library_helper", "library_constants"):
        sys.modules.pop(name, None)
    new_workers()  # those that are left have a path to a folder that will be gone


def new_workers() -> None:
    get_reusable_executor().shutdown(wait=True)


@pytest.mark.slow
def test_a_module_that_is_reloaded_runs_its_new_code_on_warm_workers(library: Library) -> None:
    before = bits(library.race())
    assert bits(library.race(n_jobs=1)) == before
    for edit in library.edits:
        library.write("library_agents", library.text.replace(*edit))
        importlib.reload(library.agents)
        after = bits(library.race())
        assert after != before
        assert bits(library.race(n_jobs=1)) == after


@pytest.mark.slow
def test_a_helper_that_is_reloaded_runs_its_new_code_on_warm_workers(library: Library) -> None:
    before = bits(library.race())
    library.write("library_helper", "def share():\n    return 12.5\n")
    importlib.reload(sys.modules["library_helper"])
    with library.race() as results:  # the class is the old one: its new code is run, or that is told
        runs = {one["entrant"]: one for one in results.runs}
        assert runs["plodding"]["status"] == "finished"
        assert "was edited after it was imported" in runs["speedy"]["error"]
        told = results.arrays("plodding")["memory"].tolist()
    with library.race(n_jobs=1) as results:
        assert results.arrays("plodding")["memory"].tolist() == told
    importlib.reload(library.agents)
    after = bits(library.race())
    assert after != before
    assert bits(library.race(n_jobs=1)) == after


@pytest.mark.slow
def test_a_module_that_is_edited_but_not_reloaded_fails_on_new_workers_and_says_so(library: Library) -> None:
    before = bits(library.race())
    for edit in library.edits:
        library.write("library_agents", library.text.replace(*edit))
        new_workers()
        with library.race() as results:
            last = {one["entrant"]: one["error"].strip().splitlines()[-1] for one in results.runs}
        for name, kind in (("speedy", "Speedy"), ("plodding", "Plodding")):
            assert last[name] == (
                f"RuntimeError: the code of library_agents.{kind} was edited after it was imported: "
                "reload the module, or start anew"
            )
    importlib.reload(library.agents)
    assert bits(library.race()) != before


@pytest.mark.slow
@pytest.mark.parametrize("driver", ["auto", "pettingzoo"])
def test_a_helper_that_is_edited_but_not_reloaded_fails_on_new_workers_and_says_so(
    library: Library, driver: str
) -> None:
    library.write("library_helper", "from library_constants import *\n\ndef share():\n    return SHARE\n")
    library.write("library_constants", "SHARE = 0.25\n")
    importlib.invalidate_caches()
    importlib.reload(sys.modules["library_helper"])
    before = bits(library.race(driver=driver))
    library.write("library_constants", "SHARE = 12.5\n")
    new_workers()
    with library.race(driver=driver) as results:
        last = {one["error"].strip().splitlines()[-1] for one in results.runs}
    told = "RuntimeError: the code of library_constants was edited after it was imported"
    assert last == {f"{told}: reload the module, or start anew"}
    assert bits(library.race(n_jobs=1, driver=driver)) == before  # what this process has imported
    for name in ("library_constants", "library_helper", "library_agents"):
        importlib.reload(sys.modules[name])
    after = bits(library.race(driver=driver))
    assert after != before
    assert bits(library.race(n_jobs=1, driver=driver)) == after


@pytest.mark.slow
def test_a_helper_of_a_notebook_that_is_edited_but_not_reloaded_is_told(library: Library) -> None:
    library.write("library_helper", "def share():\n    return 0.25\n")
    cells = [
        "import sys\nsys.dont_write_bytecode = True\n" + library.text,
        f"out = 'before.sqlite'\n{RUN_IT}",
        "pathlib.Path('library_helper.py').write_text('def share():\\n    return 12.5\\n')",
        "from joblib.externals.loky import get_reusable_executor as workers\nworkers().shutdown(wait=True)",
        f"out = 'after.sqlite'\n{RUN_IT}",
    ]
    Path("cells.json").write_text(json.dumps(cells))
    Path("notebook.py").write_text(NOTEBOOK)
    done = python("notebook.py")
    assert done.returncode == 0, done.stderr
    assert bits(load("before.sqlite"))
    with load("after.sqlite") as results:
        errors = {one["entrant"]: one.get("error", "") for one in results.runs}
    assert "the code of library_helper was edited after it was imported" in errors["plodding"]


def test_a_class_that_a_function_makes_travels(library: Library) -> None:
    library.write("library_agents", f"def make():\n{textwrap.indent(DRIVER, '    ')}\n    return Driver\n")
    importlib.reload(library.agents)
    assert bits(run(race_of(driver=library.agents.make()), n_jobs=2))


# Mistakes


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
    assert main(["run", "race.toml", "--plugin", "speedy.py", "--jobs", "1", "--strict"]) == 0


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


@pytest.mark.slow
def test_what_the_user_sees_of_a_broken_file_has_no_traceback() -> None:
    message = break_it("a package that is not installed")
    done = python("-m", "arena", "run", "race.toml", "--plugin", "bad.py")
    assert (done.returncode, done.stdout, done.stderr) == (2, "", f"arena: {message}\n")
    Path("race.toml").write_text(f"plugins = ['bad.py', 'speedy.py']\n{RACE}[[entrants]]\nagent = 'driver'\n")
    done = python("-m", "arena", "run", "race.toml", "--jobs", "1")
    assert done.returncode == 0
    assert done.stderr.splitlines()[0] == message
    assert "Traceback" not in done.stdout + done.stderr
    assert "driver replicate 0 failed: agent 'driver' is not available: plugin bad.py" in done.stdout
    assert python("-m", "arena", "run", "race.toml", "--jobs", "1", "--strict").returncode == 1


# Parameters

WRONG = {
    "step_size = 2": "step_size must be in (0, 1], got 2.0",
    "step_size = 0": "step_size must be in (0, 1], got 0.0",
    "step_size = 'big'": "step_size must be a number, got 'big'",
    "step_size = nan": "step_size must be a finite number, got nan",
    "bins = [3]": "bins must have 2 values, got [3]",
    "bins = [3, 4.5]": "bins must be an integer, got 4.5",
    "bins = 3": "bins must be a list, got 3",
    "mood = 'blod'": "mood must be one of bold, shy, got 'blod'; did you mean 'bold'?",
    "stepsize = 0.1": (
        "parameter of speedy must be one of bins, mood, step_size, got 'stepsize'; did you mean 'step_size'?"
    ),
}


@pytest.mark.parametrize("line", WRONG)
def test_a_wrong_parameter_is_one_sentence_wherever_it_is_given(
    line: str, capsys: pytest.CaptureFixture[str]
) -> None:
    name, _, text = line.partition(" = ")
    value = {"nan": float("nan")}.get(text) or json.loads(text.replace("'", '"'))
    speedy = load_plugin("speedy.py")["speedy"]
    with pytest.raises((TypeError, ValueError), match=f"^entrant 'a': {re.escape(WRONG[line])}$"):
        Entrant("a", speedy, **{name: value})
    with pytest.raises((TypeError, ValueError), match=f": {re.escape(WRONG[line])}$"):
        list(sweep("a", speedy, over={name: [value]}))
    head = 'plugins = ["speedy.py"]\n[[entrants]]\nname = "a"\nagent = "speedy"\n'
    for table, label in ((f"parameters = {{ {line} }}", "a"), (f"sweep = {{ {name} = [{text}] }}", None)):
        Path("race.toml").write_text(head + table)
        assert main(["run", "race.toml"]) == 2
        told = capsys.readouterr().err
        assert told.startswith("arena: race.toml: entrant 'a")
        assert told.endswith(f": {WRONG[line]}\n")
        assert label is None or told == f"arena: race.toml: entrant 'a': {WRONG[line]}\n"


def test_parameters_of_a_file_arrive_as_those_of_a_script() -> None:
    Path("race.toml").write_text(
        'plugins = ["speedy.py"]\n[[entrants]]\nname = "a"\nagent = "speedy"\n'
        "parameters = { step_size = 1, bins = [5, 6] }"
    )
    (entrant,) = load_tournament("race.toml").entrants
    assert entrant == Entrant("a", agent_class("speedy"), step_size=1.0, bins=(5, 6))
    assert entrant.parameters == {"step_size": 1.0, "bins": (5, 6), "mood": "bold"}


def test_a_parameter_without_a_default_must_be_given() -> None:
    Path("needy.py").write_text(f"{DRIVER}\n    def __init__(self, weight: float):\n        pass\n")
    driver = load_plugin("needy.py")["driver"]
    with pytest.raises(TypeError, match=r"^entrant 'a': parameter weight of driver must be given$"):
        Entrant("a", driver)
    assert parameters_of(driver)[0]["weight"].rule() == "float"
    assert main(["check", "needy.py"]) == 2


PLACES = """
from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

class Spring(NamedTuple):
    stiffness: float
    reach: float


@dataclass
class Driver:
    limit: float = math.inf
    seed: int = None
    spring: Spring = Spring(1.0, math.inf)
    counts: np.ndarray = field(default_factory=lambda: np.zeros(3))
"""


def test_any_default_is_accepted_made_in_the_worker_and_verified(capsys: pytest.CaptureFixture[str]) -> None:
    methods = DRIVER.partition("class Driver:\n")[2].replace("pass", "self.counts[action] += 1")
    Path("places.py").write_text(PLACES + methods)
    Path("race.toml").write_text(
        f'plugins = ["places.py"]\n{RACE.partition("[[entr")[0]}[[entrants]]\nagent = "driver"'
    )
    (entrant,) = load_tournament("race.toml").entrants
    assert set(entrant.parameters) == {"limit", "seed", "spring"}
    assert not [one for one in findings(entrant) if one.status == "failed"]
    assert main(["run", "race.toml", "--jobs", "2", "--out", "r.sqlite"]) == 0
    with load("r.sqlite") as results:
        assert results.arrays("driver")["counts"].sum() == results.runs[0]["iterations"]
    capsys.readouterr()
    assert main(["verify", "r.sqlite"]) == 0
    assert capsys.readouterr().out == "no difference\n"
    with pytest.raises(ValueError, match="limit must be a finite number, got nan"):
        Entrant("a", agent_class("driver"), limit=math.nan)


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


@pytest.mark.slow
def test_a_results_file_is_read_without_the_plugin_and_verified_with_it() -> None:
    Path("speedy.py").write_text(
        f"{PLUGIN}\nopen('was-run', 'w').close()\n".replace("class Plodding", "class _P")
    )
    Path("race.toml").write_text(RACE.partition('[[entrants]]\nagent = "plodding"')[0])
    done = python("-m", "arena", "run", "race.toml", "--plugin", "speedy.py", "--jobs", "1")
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
