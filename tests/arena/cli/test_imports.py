"""What is imported: for help next to nothing, for a command what it needs, for a package its own."""

import sys
from contextlib import closing
from pathlib import Path

import pytest
from fresh import COMMAND, modules_after, modules_of_command, output_of
from made_up_results import made_up

from agents import Sarsa
from agents.optimal import Optimal
from arena import Entrant, Evaluation, Tournament, Training, paper, run
from arena.cli import main
from arena.results.store import Store
from arena.tournament.outcome import Outcome, Status

UNNEEDED = {"numba", "llvmlite", "pettingzoo", "gymnasium", "joblib", "matplotlib", "pandas", "jinja2"}
HEAVY = {*UNNEEDED, "scipy", "sklearn", "rich", "typer"}
OURS = {"arena", "agents", "envs"}
BARE = """
import sys, typer
app = typer.Typer(no_args_is_help=True, pretty_exceptions_enable=False, rich_markup_mode=None)
app.command("run")(lambda: None)
app.command("show")(lambda: None)
typer.main.get_command(app).main(sys.argv[1:], "bare", standalone_mode=False)
"""


def packages(modules: set[str]) -> set[str]:
    """The packages that they belong to, but those of Python."""
    return {name.partition(".")[0] for name in modules} - {*sys.stdlib_module_names}


@pytest.mark.parametrize("arguments", [["--help"], ["run", "--help"]])
def test_help_needs_the_commands_and_what_any_program_of_typer_needs(arguments: list[str]) -> None:
    loaded = modules_of_command(*arguments)
    assert packages(loaded) == {"arena", "envs"} | packages(modules_after(BARE.strip(), *arguments))
    ours = {name for name in loaded if name.partition(".")[0] in OURS}
    assert {name for name in ours if not name.startswith("arena.cli")} == {
        "arena",
        "arena.common",
        "arena.common.html",
        "arena.deprecated",
        "envs",
        "envs.foundation",
        "envs.foundation.errors",
        "envs.foundation.lazy",
        "envs.registration",
    }


def test_importing_the_arena_or_the_environments_loads_no_package_but_ours() -> None:
    loaded = modules_after("import sys, arena, envs")
    assert packages(loaded - modules_after("import sys")) == {"arena", "envs"}


def test_no_name_of_the_arena_or_the_agents_loads_anything_heavy() -> None:
    loaded = modules_after("import sys; from arena import *; from agents import *; from envs import *")
    assert {"arena.execution.runner", "agents.registry", "envs.hill"} <= loaded
    assert loaded & HEAVY == set()


@pytest.fixture
def file(tmp_path: Path) -> str:
    """A small results file."""
    path = tmp_path / "race.sqlite"
    made_up({"a": [120.0, 121.0], "b": [140.0, None]}, path).close()
    return str(path)


def test_a_leaderboard_is_shown_without_compiler_workers_and_figures(file: str) -> None:
    for arguments in ([], ["--json"]):
        loaded = modules_of_command("show", file, *arguments)
        assert "arena.analysis.standings" in loaded
        assert loaded & UNNEEDED == set()


def test_in_a_terminal_a_planner_that_leads_is_not_made_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "race.sqlite"
    tournament = Tournament(
        (Entrant("optimal", Optimal, bins=60), Entrant("sarsa", Sarsa)),
        training=Training(60, 300),
        evaluation=Evaluation(2, 300),
    )
    run(tournament, path, n_jobs=1).close()
    monkeypatch.setenv("FORCE_COLOR", "1")  # rich takes this for a terminal
    loaded = modules_of_command("show", str(path))
    assert {"arena.report.sparklines", "agents.optimal.driver"} <= loaded
    assert loaded & UNNEEDED == set()
    assert "Policy of sarsa" in output_of(COMMAND, "show", str(path))


def test_the_paper_s_tables_are_shown_without_compiler_workers_and_figures(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "paper.sqlite"
    tournament = paper(replicates=2)
    with closing(Store.create(path, tournament.to_dict())) as store:
        for run in tournament.runs:
            scores = (100.0, 150.0, 10_000)
            outcome = Outcome(run.entrant.name, run.replicate, "compiled", Status.FINISHED, *scores)
            store.add(outcome)
    assert main(["show", str(path)]) == 0
    assert "Table 1." in capsys.readouterr().out
    assert modules_of_command("show", str(path)) & UNNEEDED == set()


def test_a_digest_needs_no_statistics_either(file: str) -> None:
    loaded = modules_of_command("digest", file)
    assert "arena.results.digests" in loaded
    assert loaded & HEAVY <= modules_after("import sys, typer")
    assert not any(name.startswith(("arena.analysis", "arena.report", "arena.execution")) for name in loaded)
