"""The results file and what is read back from it."""

import contextlib
import gc
import io
import json
import math
import sqlite3
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
import rich
from hand_made_agents import Failing, race_of
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from agents import MomentumAgent, RandomAgent
from arena import Entrant, Tournament, load, run
from arena.common.npz import pack, unpack
from arena.execution.runner import preview
from arena.report.tables import render
from arena.reproduction import compare
from arena.results import ResultsError, digest
from arena.results.store import SCHEMA_VERSION, Store
from arena.tournament.outcome import Outcome, Status, score
from envs.foundation.errors import ArenaError


@pytest.fixture
def file(small: Tournament, tmp_path: Path) -> Path:
    path = tmp_path / "small.sqlite"
    run(small, path, n_jobs=1).close()
    return path


def test_the_frame_has_a_row_a_run_and_a_column_a_parameter(file: Path) -> None:
    with load(file) as results:
        frame = results.frame()
        assert repr(results) == "<Results of 'small': 4 of 4 runs>"
    assert list(frame.columns) == [
        *("entrant", "agent", "bins", "binning", "discount", "step_size", "epsilon", "explore"),
        *("initial_values", "count_visits", "goal", "replicate", "accuracy", "mean_length", "steps"),
        *("iterations", "seconds", "driver", "status"),
    ]
    assert frame.entrant.tolist() == ["q", "q", "s", "s"]
    assert frame.agent.tolist() == ["q-learning", "q-learning", "sarsa", "sarsa"]
    assert frame.replicate.tolist() == [0, 1, 0, 1]
    assert frame.bins.tolist() == [(5, 6), (5, 6), (6, 5), (6, 5)]
    assert frame.groupby("bins").size().tolist() == [2, 2]
    assert (frame.seconds > 0).all()
    assert frame.iterations.between(1, 6 * 120).all()


def test_arrays_come_back_and_agree_with_the_scores(file: Path) -> None:
    with load(file) as results:
        for one in results.runs:
            arrays = results.arrays(one["entrant"], one["replicate"])
            assert arrays["values"].shape == arrays["visits"].shape == (30, 3)
            assert arrays["lengths"].sum() == arrays["visits"].sum() == one["iterations"]
            accuracy, mean_length = score(arrays["test_lengths"], arrays["test_reached"])
            assert accuracy == one["accuracy"]
            assert (None if math.isnan(mean_length) else mean_length) == one["mean_length"]
        with pytest.raises(KeyError, match="no run 9 of 'q'"):
            results.arrays("q", 9)


def test_json_is_strict_and_complete() -> None:
    tournament = race_of(Entrant("m", MomentumAgent), Entrant("r", RandomAgent))
    with run(tournament, n_jobs=1) as results:
        told = json.loads(json.dumps(results.to_dict(), allow_nan=False))
    assert {key: told[key] for key in tournament.to_dict()} == tournament.to_dict()
    momentum, random = told["runs"][0], told["runs"][2]
    assert set(momentum) == {
        *("entrant", "agent", "parameters", "replicate", "accuracy", "mean_length", "steps"),
        *("iterations", "seconds", "driver", "status"),
    }
    assert momentum["accuracy"] == 100.0
    assert 83 <= momentum["mean_length"] <= 150
    assert random["accuracy"] == 0.0
    assert random["mean_length"] is None
    assert (momentum["steps"], random["steps"]) == (momentum["mean_length"], 150.0)
    assert told["versions"]["numpy"] == np.__version__


def test_the_score_is_the_paper_s() -> None:
    lengths = np.array([100, 500, 120, 500])
    assert score(lengths, np.array([True, False, True, False])) == (50.0, 110.0)
    accuracy, mean_length = score(lengths, np.zeros(4, bool))
    assert accuracy == 0.0
    assert math.isnan(mean_length)


def test_packed_arrays_are_the_same_bytes_for_the_same_arrays_and_never_objects() -> None:
    arrays = {"a": np.arange(6.0).reshape(2, 3), "b": np.array([True, False])}
    packed = pack(arrays)
    assert packed == pack({name: array.copy() for name, array in arrays.items()})
    assert all(np.array_equal(arrays[name], array) for name, array in unpack(packed).items())
    with pytest.raises(ValueError, match="allow_pickle"):
        pack({"o": np.array([{}], dtype=object)})


def test_a_file_can_be_read_by_sqlite_alone_and_while_it_is_written(
    small: Tournament, tmp_path: Path
) -> None:
    path = tmp_path / "s.sqlite"
    seen = []

    def look(finished: int, _total: int) -> None:
        with load(path) as results:
            seen.append((finished, len(results.frame())))

    run(small, path, n_jobs=1, progress=look).close()
    assert seen == [(n, n) for n in range(5)]
    connection = sqlite3.connect(path)
    assert connection.execute("SELECT count(*) FROM runs WHERE status = 'finished'").fetchone() == (4,)
    connection.close()


def test_entrants_are_data(tmp_path: Path) -> None:
    path = tmp_path / "s.sqlite"
    name = "Robert'); DROP TABLE runs;-- <script>"
    with run(race_of(Entrant(name, MomentumAgent)), path, n_jobs=1) as results:
        assert set(results.frame().entrant) == {name}
        assert results.arrays(name)["lengths"].shape == (6,)


def test_failures_keep_their_traceback(tmp_path: Path) -> None:
    with run(race_of(Entrant("bad", Failing)), tmp_path / "s.sqlite", n_jobs=1) as results:
        for one in results.runs:
            assert one["error"].startswith("Traceback")
        assert results.arrays("bad") == {}


def test_other_files_are_told_and_left_alone(tmp_path: Path, file: Path) -> None:
    cases = {"text": b"hello", "empty": b"", "truncated": file.read_bytes()[:3000]}
    for name, content in cases.items():
        path = tmp_path / name
        path.write_bytes(content)
        with pytest.raises(ValueError, match=f"{name} is not a results file of the arena"):
            load(path)
        assert path.read_bytes() == content
    other = tmp_path / "other"
    connection = sqlite3.connect(other)
    connection.execute("CREATE TABLE runs (x)")
    connection.close()
    with pytest.raises(ValueError, match=r"other is not a results file of the arena$"):
        load(other)
    with pytest.raises(ValueError, match=r"there is no results file .*none"):
        load(tmp_path / "none")
    connection = sqlite3.connect(file)
    connection.execute(f"PRAGMA user_version = {SCHEMA_VERSION + 1}")
    connection.close()
    with pytest.raises(ValueError, match=r"written by a newer arena \(schema 3, known is 2\)"):
        load(file)


def test_a_file_that_cannot_be_written_is_told(small: Tournament, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ValueError, match="cannot write the results file"):
        run(small, tmp_path / "file" / "r.sqlite", n_jobs=1)


def test_a_run_is_kept_once_it_is_added(tmp_path: Path, small: Tournament) -> None:
    path = tmp_path / "s.sqlite"
    store = Store.create(path, small.to_dict())
    store.add(Outcome("q", 1, "compiled", Status.FINISHED, 50.0, 100.0, 7, 0.1, pack({"x": np.zeros(2)})))
    with load(path) as other:  # another connection sees it, though the first is still open
        assert other.frame().accuracy.tolist() == [50.0]
    assert store.finished() == {("q", 1)}
    store.close()


KILLED = """
import os, sqlite3, sys
c = sqlite3.connect(sys.argv[1], isolation_level=None)
c.execute("PRAGMA cache_size = 1")
c.execute("BEGIN IMMEDIATE")
c.execute("INSERT OR REPLACE INTO arrays VALUES ('q', 0, zeroblob(5000000))")
os._exit(0)
"""


def test_what_a_killed_writer_had_begun_is_taken_back_by_any_reader(file: Path, small: Tournament) -> None:
    with load(file) as results:
        before = digest(results)
    subprocess.run([sys.executable, "-c", KILLED, str(file)], check=True)
    assert file.with_name(f"{file.name}-journal").exists()
    assert preview(small, file).sentence == "keeps 4 runs, runs 0"
    with load(file) as results:
        assert digest(results) == before


def read_all(path: Path) -> None:
    with load(path) as results:
        results.frame()
        results.to_dict()
        repr(results)
        digest(results)
        compare(results)
        rich.print(render(results), file=io.StringIO())


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_nothing_but_one_sentence_comes_of_a_file_with_wrong_bytes(
    data: st.DataObject, file: Path, tmp_path: Path
) -> None:
    content = bytearray(file.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(content) - 1))
        content[start : start + data.draw(st.integers(1, 64))] = data.draw(st.binary(max_size=64))
    path = tmp_path / "wrong.sqlite"
    path.write_bytes(content)
    with contextlib.suppress(ArenaError):
        read_all(path)


def test_a_schema_that_is_no_text_is_told_as_damage(file: Path) -> None:
    content = file.read_bytes()
    assert content.count(b"CREATE TABLE tournament") == 1
    file.write_bytes(content.replace(b"CREATE TABLE tournament", b"CREATE TABL\x80 tournament"))
    with pytest.raises(ResultsError, match="is damaged"):
        load(file)


VALUES = (
    st.none() | st.integers(-(2**63), 2**63 - 1) | st.floats() | st.text(max_size=5) | st.binary(max_size=5)
)
JSONS = st.recursive(
    st.none() | st.booleans() | st.integers() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=5,
)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_nothing_but_one_sentence_comes_of_a_file_with_wrong_contents(
    data: st.DataObject, file: Path, tmp_path: Path
) -> None:
    path = tmp_path / "wrong.sqlite"
    path.write_bytes(file.read_bytes())
    columns = [
        "runs." + name for name in ("entrant", "replicate", "status", "accuracy", "iterations", "error")
    ]
    table, column = data.draw(st.sampled_from([*columns, "arrays.npz", "tournament.value"])).split(".")
    value = data.draw(VALUES | JSONS.map(json.dumps))
    if table == "tournament" and data.draw(st.booleans()):
        with load(file) as results:
            config = results.config
        config[data.draw(st.sampled_from(sorted(config)))] = data.draw(JSONS)
        value = json.dumps(config)
    connection = sqlite3.connect(path)
    with contextlib.suppress(sqlite3.IntegrityError):
        connection.execute(f"UPDATE {table} SET {column} = ? WHERE rowid = 1", (value,))  # noqa: S608
        connection.commit()
    connection.close()
    with contextlib.suppress(ArenaError):
        read_all(path)


INTERPRETED = """
replicates = 100
training = { episodes = 2, max_steps = 100 }
evaluation = { episodes = 1, max_steps = 100 }
[[entrants]]
agent = "sarsa"
"""


@pytest.mark.skipif(sys.platform == "win32", reason="limits the size of files as POSIX can")
def test_a_full_disk_is_told_and_what_was_finished_stays(tmp_path: Path) -> None:
    code = """
import resource, signal, sys
from arena.cli import main
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (90_000, 90_000))
sys.exit(main(["run", "race.toml", "--driver", "pettingzoo", "--jobs", "1", "--out", "r.sqlite"]))
"""
    (tmp_path / "race.toml").write_text(INTERPRETED)  # machine code of the loops would not fit
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith("arena: cannot write the results file r.sqlite: ")
    assert done.stderr.count("\n") == 1
    with load(tmp_path / "r.sqlite") as results:
        assert 0 < len(results.runs) < 100
        assert {one["status"] for one in results.runs} == {"finished"}


def test_names_and_errors_cannot_command_the_terminal(file: Path) -> None:
    connection = sqlite3.connect(file)
    connection.execute("UPDATE runs SET status = 'failed', error = 'x \x1b[2J y' WHERE entrant = 'q'")
    connection.commit()
    with load(file) as results:
        printed = io.StringIO()
        rich.print(render(results), file=printed)
    assert "q replicate 0 failed: x ?[2J y" in printed.getvalue()
    assert "\x1b" not in printed.getvalue()
    connection.execute("UPDATE tournament SET value = replace(value, '\"q\"', '\"q\\u001b[2J\"')")
    connection.commit()
    connection.close()
    with pytest.raises(ValueError, match=r"small.sqlite is damaged: its tournament is incomplete"):
        load(file)


@pytest.mark.filterwarnings("error")
def test_results_are_read_and_dropped_in_any_thread(file: Path, small: Tournament) -> None:
    made = [load(file), run(small, n_jobs=1)]  # a file's, and those that are nowhere else
    seen: list[int] = []

    def use() -> None:
        while made:
            results = made.pop()
            seen.append(len(results.runs))
            del results
            gc.collect()

    thread = threading.Thread(target=use)
    thread.start()
    thread.join()
    assert len(seen) == 2
    assert min(seen) > 0
