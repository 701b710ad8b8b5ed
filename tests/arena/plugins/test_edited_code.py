"""Edited code is never stale: it runs as in a new process, or the run says why not."""

import importlib
import json
import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path

import pytest
from broken_plugins import DRIVER
from joblib.externals.loky import get_reusable_executor
from plugin_files import EDITS, NOTEBOOK, PLUGIN, RACE, RUN, RUN_IT, bits, from_file, python, race_between

from agents import agent_class
from arena import Results, load, load_plugin, run
from arena.cli import main
from arena.results import digest
from arena.tournament import load_tournament

pytestmark = pytest.mark.usefixtures("folder")


@pytest.mark.system
@pytest.mark.parametrize("edit", EDITS.values(), ids=EDITS)
def test_an_edited_file_runs_as_in_a_fresh_process(edit: tuple[str, str]) -> None:
    before = from_file(n_jobs=2)
    Path("speedy.py").write_text(PLUGIN.replace(*edit))
    after = from_file(n_jobs=2)  # the workers are warm
    assert after != before
    command = ["-m", "arena", *RUN, "--plugin", "speedy.py", "--jobs", "1", "--out", "r.sqlite"]
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


def test_results_of_an_edited_plugin_are_not_mixed_with_those_of_before(
    capsys: pytest.CaptureFixture[str],
) -> None:
    arguments = [*RUN, "--plugin", "speedy.py", "--jobs", "1", "--out"]
    assert main([*arguments, "r.sqlite"]) == 0
    with load("r.sqlite") as results:
        before = digest(results)
    capsys.readouterr()
    Path("speedy.py").write_text(PLUGIN.replace(*EDITS["a constant"]))
    assert main([*arguments, "r.sqlite"]) == 0
    assert ", whose code changed" in capsys.readouterr().err
    assert main([*arguments, "fresh.sqlite"]) == 0
    with load("r.sqlite") as grown, load("fresh.sqlite") as fresh:
        assert digest(grown) == digest(fresh) != before


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
        tournament = race_between(speedy=self.agents.Speedy, plodding=self.agents.Plodding)
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


@pytest.mark.system
def test_a_module_that_is_reloaded_runs_its_new_code_on_warm_workers(library: Library) -> None:
    before = bits(library.race())
    assert bits(library.race(n_jobs=1)) == before
    for edit in library.edits:
        library.write("library_agents", library.text.replace(*edit))
        importlib.reload(library.agents)
        after = bits(library.race())
        assert after != before
        assert bits(library.race(n_jobs=1)) == after


@pytest.mark.system
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


@pytest.mark.system
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


@pytest.mark.system
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


@pytest.mark.system
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
    assert bits(run(race_between(driver=library.agents.make()), n_jobs=2))
