"""A results file is a collection of runs: of a tournament that changes, what is still needed is kept."""

import hashlib
import re
import sqlite3
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from paths import ROOT

from agents import MomentumAgent, QLearning, RandomAgent, Sarsa
from arena import Entrant, Evaluation, Tournament, Training, load, run
from arena.cli import main
from arena.common.npz import pack
from arena.execution.runner import preview
from arena.results import Results, ResultsError, digest
from arena.results.editing import drop, merge, prune
from arena.results.schema import replicates_of
from arena.results.store import Store
from arena.tournament.outcome import Outcome, Status
from envs import Hill
from envs.foundation.errors import InvalidValueError

LIMITS: dict[str, Any] = {"training": Training(2, 60), "evaluation": Evaluation(2, 60)}


# Random histories: outcomes that are a function of what decides the bits, in the place of real runs


class View:
    """A tournament whose entrants, parameters, code and replicates change."""

    def __init__(self) -> None:
        self.entrants = {"a": 4, "b": 4}
        self.codes = {"sarsa": "first"}
        self.replicates = 2

    @property
    def config(self) -> dict[str, Any]:
        entrants = tuple(Entrant(name, Sarsa, bins=bins) for name, bins in self.entrants.items())
        return Tournament(entrants, replicates=self.replicates, name="grown", **LIMITS).to_dict()

    def fill(self, store: Store, only: range | None = None, most: int = 1000) -> None:
        """Add what is missing, until a number of runs, where the process is killed."""
        keys = [(name, n) for n in only or range(self.replicates) for name in self.entrants]
        missing = [key for key in keys if key not in store.finished()]
        for name, replicate in missing[:most]:
            decisive = f"{name} {self.entrants[name]} {self.codes} {replicate}"
            seed = int(hashlib.sha256(decisive.encode()).hexdigest()[:8], 16)
            drawn = np.random.default_rng(seed)
            arrays = pack({"lengths": drawn.integers(1, 60, 2), "test_lengths": drawn.integers(1, 60, 2)})
            scores = (50.0, float(drawn.integers(1, 60)), int(drawn.integers(1, 100)))
            store.add(Outcome(name, replicate, "compiled", Status.FINISHED, *scores, 0.1, arrays))

    def run(self, path: Path | None, only: range | None = None, most: int = 1000) -> str:
        """Continue the file; its digest."""
        resumed = path is not None and path.exists()
        store = (
            Store.resume(path, self.config, self.codes)
            if path is not None and resumed
            else Store.create(path, self.config, self.codes)
        )
        with store:
            self.fill(store, only, most)
            return digest(Results(store))


OPERATIONS = st.one_of(
    st.tuples(st.just("replicates"), st.integers(1, 4)),
    st.tuples(st.just("toggle"), st.sampled_from("abc")),
    st.tuples(st.just("bins"), st.tuples(st.sampled_from("abc"), st.integers(3, 5))),
    st.tuples(st.just("code"), st.sampled_from(["first", "second"])),
    st.tuples(st.just("kill"), st.integers(0, 3)),
    st.tuples(st.just("prune"), st.none()),
    st.tuples(st.just("merge"), st.integers(0, 3)),
)


def change(view: View, operation: str, value: Any) -> None:
    if operation == "replicates":
        view.replicates = value
    elif operation == "toggle" and value in view.entrants and len(view.entrants) > 1:
        del view.entrants[value]
    elif operation == "toggle":
        view.entrants.setdefault(value, 4)
    elif operation == "bins" and value[0] in view.entrants:
        view.entrants[value[0]] = value[1]
    elif operation == "code":
        view.codes = {"sarsa": value}


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(operations=st.lists(OPERATIONS, min_size=1, max_size=8))
def test_any_history_ends_in_the_digest_of_a_run_from_scratch(
    operations: list[tuple[str, Any]], tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = tmp_path_factory.mktemp("history")
    view, path = View(), folder / "grown.sqlite"
    view.run(path)
    for number, (operation, value) in enumerate(operations):
        change(view, operation, value)
        if operation == "prune":
            prune(path)
        elif operation == "merge":  # another machine has run some of the replicates
            other, joined = folder / f"other-{number}.sqlite", folder / f"joined-{number}.sqlite"
            view.run(other, range(min(value, view.replicates - 1), view.replicates))
            view.run(path)
            merge([path, other] if value % 2 else [other, path], joined)
            path = joined
        view.run(path, most=value if operation == "kill" else 1000)
    assert view.run(path) == view.run(None)


# What is kept, and what is said of it


def tournament(*entrants: Entrant, replicates: int | str = 2, **arguments: Any) -> Tournament:
    chosen = entrants or (Entrant("sarsa", Sarsa, bins=4), Entrant("momentum", MomentumAgent))
    return Tournament(chosen, replicates=replicates, name="grown", **LIMITS | arguments)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "grown.sqlite"
    run(tournament(), path, n_jobs=1, driver="pettingzoo").close()
    return path


SARSA, MOMENTUM = tournament().entrants
SENTENCES = [
    (tournament(), "keeps 4 runs, runs 0"),
    (tournament(replicates=5), "keeps 4 runs, runs 6: 6 of replicates 2 to 4"),
    (tournament(replicates=3), "keeps 4 runs, runs 2: 2 of replicate 2"),
    (tournament(replicates=1), "keeps 2 runs, puts 2 aside, runs 0"),
    (tournament(SARSA), "keeps 2 runs, puts 2 aside, runs 0"),
    (
        tournament(SARSA, MOMENTUM, Entrant("r", RandomAgent), replicates=3),
        "keeps 4 runs, runs 5: 3 of 'r', which is new; 2 of replicate 2",
    ),
    (
        tournament(Entrant("sarsa", Sarsa, bins=5), MOMENTUM),
        "keeps 2 runs, puts 2 aside, runs 2: 2 of 'sarsa', whose parameters changed",
    ),
    (
        tournament(Entrant("sarsa", QLearning, bins=4), MOMENTUM),
        "keeps 2 runs, puts 2 aside, runs 2: 2 of 'sarsa', which is another agent",
    ),
    (
        tournament(replicates="adaptive", max_replicates=6),
        "keeps 4 runs, runs at most 8: 8 of replicates 2 to 5",
    ),
]


@pytest.mark.parametrize(("changed", "sentence"), SENTENCES, ids=[sentence for _, sentence in SENTENCES])
def test_it_is_said_what_is_kept_and_what_is_run_and_so_it_is(
    changed: Tournament, sentence: str, file: Path
) -> None:
    before = file.read_bytes()
    plan = preview(changed, file)
    assert plan.sentence == sentence
    assert file.read_bytes() == before
    driven: list[tuple[int, int]] = []
    with run(changed, file, n_jobs=1, driver="pettingzoo", progress=lambda *at: driven.append(at)) as results:
        if changed.replicates != "adaptive":
            assert len(results.records) == len(plan.kept) + len(plan.missing)
            assert driven[-1][0] - driven[0][0] == len(plan.missing)
        grown = digest(results)
    with run(changed, n_jobs=1, driver="pettingzoo") as fresh:
        assert digest(fresh) == grown


def test_of_a_new_file_all_is_run() -> None:
    plan = preview(tournament(), None)
    assert plan.sentence == "keeps 0 runs, runs 4: 4 of replicates 0 to 1"


@pytest.mark.parametrize(
    ("change", "difference"),
    [
        ({"seed": 1}, "its seed is 0, not 1"),
        ({"training": Training(3, 60)}, "its training differs"),
        ({"evaluation": Evaluation(2, 61)}, "its evaluation differs"),
        ({"hill": Hill(friction=1.0)}, "its hill differs"),
        ({"name": "other"}, "its name is 'grown', not 'other'"),
    ],
)
def test_runs_under_other_conditions_are_never_mixed(
    change: dict[str, Any], difference: str, file: Path
) -> None:
    before = file.read_bytes()
    for call in (preview, run):
        with pytest.raises(ResultsError, match=re.escape(f"holds another tournament ({difference})")):
            call(replace(tournament(), **change), file)
    assert file.read_bytes() == before


def test_a_parameter_that_only_the_agent_refuses_leaves_the_file_as_it_was(file: Path) -> None:
    before = file.read_bytes()
    bad = Entrant("sarsa", Sarsa, initial_values=(1.0, -1.0))
    with pytest.raises(InvalidValueError, match="entrant 'sarsa': initial_values"):
        run(tournament(bad, MOMENTUM), file, n_jobs=1)
    assert file.read_bytes() == before


def test_a_part_of_the_replicates_is_run_by_each_of_two_processes(tmp_path: Path) -> None:
    halves = [tmp_path / "0.sqlite", tmp_path / "1.sqlite"]
    for number, half in enumerate(halves):
        part = range(2 * number, 2 * number + 2)
        with run(tournament(replicates=4), half, n_jobs=1, driver="pettingzoo", replicates=part) as results:
            assert {record.replicate for record in results.records} == {*part}
    merge(halves, tmp_path / "both.sqlite")
    with (
        run(tournament(replicates=4), n_jobs=1, driver="pettingzoo") as whole,
        load(tmp_path / "both.sqlite") as both,
    ):
        assert digest(whole) == digest(both)


@pytest.mark.parametrize("bad", [range(3), range(0), range(0, 2, 2), range(-1, 1)])
def test_bad_parts_are_refused(bad: range) -> None:
    with pytest.raises(InvalidValueError, match=r"^replicates must be neighbours among the 2 of"):
        run(tournament(), n_jobs=1, replicates=bad)


def test_a_reader_does_not_mix_what_was_with_what_is(file: Path) -> None:
    with load(file) as early, load(file) as late:
        assert len(early.records) == 4
        run(tournament(SARSA), file, n_jobs=1, driver="pettingzoo").close()
        assert len(early.records) == 4
        with pytest.raises(ResultsError, match=r"grown.sqlite was changed by another process; open it again"):
            late.records  # noqa: B018


# Former versions


def test_an_edit_can_be_compared_with_what_was_before(file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with load(file) as results:
        before = results.arrays("sarsa", 1)
    edited = tournament(Entrant("sarsa", Sarsa, bins=5), MOMENTUM)
    run(edited, file, n_jobs=1, driver="pettingzoo").close()
    with load(file, past=["sarsa@old"]) as results:
        assert list(results.entrants) == ["sarsa", "momentum", "sarsa@old"]
        assert results.entrants["sarsa@old"].parameters["bins"] == 4
        assert {key: a.tobytes() for key, a in results.arrays("sarsa@old", 1).items()} == {
            key: a.tobytes() for key, a in before.items()
        }
    with load(file) as results:
        assert list(results.entrants) == ["sarsa", "momentum"]
    assert main(["compare", str(file), "sarsa@old", "sarsa"]) == 0
    assert "sarsa@old and sarsa by steps" in capsys.readouterr().out
    with pytest.raises(
        ResultsError, match="has no former version 'momentum@old'; it has none of that entrant"
    ):
        load(file, past=["momentum@old"])
    assert prune(file) == 2
    with pytest.raises(ResultsError, match="has no former version 'sarsa@old'"):
        load(file, past=["sarsa@old"])


def test_failed_runs_are_not_put_aside(file: Path) -> None:
    with closing(sqlite3.connect(file)) as connection:
        connection.execute("UPDATE runs SET status = 'failed' WHERE entrant = 'sarsa' AND replicate = 0")
        connection.commit()
    run(tournament(MOMENTUM), file, n_jobs=1, driver="pettingzoo").close()
    assert prune(file) == 1


def test_an_entrant_is_dropped_with_its_former_versions(file: Path) -> None:
    run(tournament(Entrant("sarsa", Sarsa, bins=5), MOMENTUM), file, n_jobs=1, driver="pettingzoo").close()
    drop(file, ["sarsa"])
    with load(file) as results:
        assert list(results.entrants) == ["momentum"]
        assert len(results.records) == 2
    assert prune(file) == 0
    with pytest.raises(InvalidValueError, match="entrant must be one of momentum, got 'sarsa'"):
        drop(file, ["sarsa"])
    with pytest.raises(InvalidValueError, match="entrant must leave another one, got all 1"):
        drop(file, ["momentum"])


# Several files


def test_a_run_that_is_not_the_same_in_two_files_is_an_error_that_names_it(
    file: Path, tmp_path: Path
) -> None:
    other = tmp_path / "other.sqlite"
    other.write_bytes(file.read_bytes())
    with closing(sqlite3.connect(other)) as connection:
        connection.execute("UPDATE runs SET iterations = 7 WHERE entrant = 'sarsa' AND replicate = 1")
        connection.commit()
    out = tmp_path / "out.sqlite"
    with pytest.raises(
        ResultsError, match=r"replicate 1 of 'sarsa' is not the same in .*grown.sqlite and .*other.sqlite$"
    ):
        merge([file, other], out)
    assert not out.exists()
    assert {path.name for path in tmp_path.iterdir()} == {"grown.sqlite", "other.sqlite"}


def test_files_that_cannot_be_joined_are_told(file: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.sqlite"
    run(tournament(seed=1), other, n_jobs=1, driver="pettingzoo").close()
    with pytest.raises(
        ResultsError, match=r"other.sqlite holds another tournament than .*its seed is 1, not 0"
    ):
        merge([file, other], tmp_path / "out.sqlite")
    with pytest.raises(ResultsError, match=r"grown.sqlite is there already"):
        merge([file, other], file)
    with pytest.raises(InvalidValueError, match="files must be two or more, got 1"):
        merge([file], tmp_path / "out.sqlite")


def test_entrants_that_differ_between_files_are_versions_of_the_first(file: Path, tmp_path: Path) -> None:
    other, out = tmp_path / "other.sqlite", tmp_path / "out.sqlite"
    edited = tournament(Entrant("sarsa", Sarsa, bins=5), Entrant("r", RandomAgent))
    run(edited, other, n_jobs=1, driver="pettingzoo").close()
    merge([file, other], out)
    with load(out, past=["sarsa@old"]) as results:
        assert [(name, entrant.parameters.get("bins")) for name, entrant in results.entrants.items()] == [
            ("sarsa", 4),
            ("momentum", None),
            ("r", None),
            ("sarsa@old", 5),
        ]
        assert len(results.records) == 8
    assert preview(edited, out).sentence == "keeps 4 runs, puts 4 aside, runs 0"


# Commands


def test_the_command_says_what_it_does_and_with_dry_run_only_that(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("race.toml").write_text(
        'name = "race"\nreplicates = 2\ntraining = { episodes = 2, max_steps = 60 }\n'
        'evaluation = { episodes = 2, max_steps = 60 }\n[[entrants]]\nagent = "momentum"\n'
    )
    command = [
        "run",
        "race.toml",
        "--no-report",
        "--driver",
        "pettingzoo",
        "--jobs",
        "1",
        "--out",
        "r.sqlite",
    ]
    assert main([*command, "--dry-run"]) == 0
    assert capsys.readouterr() == ("keeps 0 runs, runs 2: 2 of replicates 0 to 1\n", "")
    assert list(tmp_path.iterdir()) == [tmp_path / "race.toml"]
    assert main(command) == 0
    assert capsys.readouterr().err == ""
    assert main([*command, "--replicates", "2:4"]) == 0
    assert capsys.readouterr().err == "arena: keeps 2 runs, runs 4: 4 of replicates 2 to 3\n".replace(
        "4: 4", "2: 2"
    )
    assert main([*command, "--replicates", "3"]) == 0
    assert capsys.readouterr().err == "arena: keeps 3 runs, puts 1 aside, runs 0\n"
    assert main(["prune", "r.sqlite"]) == 0
    assert capsys.readouterr().err == "arena: removed 1 run of former versions from r.sqlite\n"
    assert main([*command, "--replicates", "4:2"]) == 2
    assert "it must be a number, a part such as 50:100, or adaptive, got '4:2'" in capsys.readouterr().err


def test_results_are_exported(file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    import pandas as pd

    with load(file) as results:
        frame, episodes = results.frame(), results.episodes()
        lengths = results.arrays("sarsa", 1)["lengths"]
    assert len(episodes) == 4 * (2 + 2)
    assert (
        episodes[(episodes.entrant == "sarsa") & (episodes.replicate == 1)].steps[:2].tolist()
        == lengths.tolist()
    )
    for what, expected in (("runs", frame), ("episodes", episodes)):
        csv, json = tmp_path / f"{what}.csv", tmp_path / f"{what}.json"
        assert main(["export", str(file), "--what", what, "-o", str(csv)]) == 0
        assert main(["export", str(file), "--what", what, "-o", str(json)]) == 0
        assert list(pd.read_csv(csv).columns) == list(expected.columns)
        assert len(pd.read_csv(csv)) == len(pd.read_json(json)) == len(expected)
    assert main(["export", str(file), "--what", "arrays", "-o", str(tmp_path / "all.npz")]) == 0
    with np.load(tmp_path / "all.npz", allow_pickle=False) as arrays:
        assert arrays["sarsa/1/lengths"].tolist() == lengths.tolist()
    capsys.readouterr()
    assert main(["export", str(file), "-o", "x.xlsx"]) == 2
    expected_error = "arena: the file of runs must end in .csv or .json or .parquet, got 'x.xlsx'\n"
    assert capsys.readouterr().err == expected_error


def test_replicates_of_a_tournament_are_counted() -> None:
    assert replicates_of(tournament(replicates=3).to_dict()) == 3
    assert replicates_of(tournament(replicates="adaptive", max_replicates=9).to_dict()) == 9


@pytest.mark.docs
def test_twelve_histories_of_real_runs_end_as_if_from_scratch(capsys: pytest.CaptureFixture[str]) -> None:
    import runpy

    grow = runpy.run_path(str(ROOT / "scripts" / "grow.py"))
    assert grow["main"]() == 0
    printed = capsys.readouterr().out
    rows = re.findall(r"^\| (.*) \| (\d+) \| (\d+) \| yes \|$", printed, re.MULTILINE)
    assert len(rows) == 12
    assert all(int(driven) < int(anew) for _, driven, anew in rows)
    shown = (ROOT / "docs" / "results.md").read_text(encoding="utf-8").split("<!-- grow -->\n")[1]
    assert shown.split("<!-- end -->")[0] == printed
