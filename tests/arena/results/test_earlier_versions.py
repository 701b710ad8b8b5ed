"""Files that earlier versions wrote are read, shown and continued to the bits that those would have left."""

import shutil
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from agents.registry import BUILT_IN
from arena import Evaluation, PolicyAgent, Tournament, Training, load, load_plugin, run
from arena.cli import main
from arena.execution.runner import preview
from arena.results import digest
from arena.results.editing import prune
from arena.results.equivalence import equivalent_code
from arena.results.provenance import source_digests
from arena.tournament import Entrant

DATA = Path(__file__).parent / "data"
# What 0.1.0 printed for the whole tournament, of which the file has the first of two replicates.
WHOLE = "4232e0d6ee335e45c8a4c4277df039f77f148bf694df68ee3adc0092bd08f251"


@pytest.fixture
def file(tmp_path: Path, isolated_registry: None) -> Path:
    """With all built-in agents."""
    return Path(shutil.copy(DATA / "version-0.1.0.sqlite", tmp_path))


@pytest.fixture
def unchanged(tmp_path: Path, isolated_registry: None) -> Path:
    """With those that leave the same bits since, a plugin and a policy."""
    return Path(shutil.copy(DATA / "version-0.1.0-unchanged.sqlite", tmp_path))


def push(observation: object) -> int:
    return 2 if observation[1] >= 0.0 else 0  # type: ignore[index]


def test_a_file_of_0_1_0_is_read_and_shown(file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with load(file) as results:
        assert len(results.records) == len(results.entrants) == 19
        assert results.trained("sarsa").policy is not None
    assert main(["show", str(file)]) == 0
    assert "Tournament before: 19 entrants, 2 replicates, seed 3." in capsys.readouterr().out


def before(file: Path, tmp_path: Path) -> Tournament:
    """The tournament of such a file."""
    seeker = load_plugin(shutil.copy(DATA / "seeker.txt", tmp_path / "seeker.py"))["seeker"]
    others = {"plugin": seeker, "policy": PolicyAgent.of(push)}
    with load(file) as results:
        entrants = tuple(
            Entrant(name, BUILT_IN.get(record.agent) or others[name], **record.parameters)
            for name, record in results.entrants.items()
        )
    return Tournament(
        entrants,
        training=Training(6, 120),
        evaluation=Evaluation(4, 150),
        replicates=2,
        seed=3,
        name="before",
    )


def test_a_file_of_0_1_0_is_continued_to_the_same_bits(unchanged: Path, tmp_path: Path) -> None:
    # On this driver nothing has to be compiled.
    with run(before(unchanged, tmp_path), unchanged, n_jobs=1, driver="pettingzoo") as results:
        assert digest(results) == WHOLE


def test_runs_of_0_1_0_of_an_agent_that_draws_otherwise_now_are_put_aside(file: Path, tmp_path: Path) -> None:
    plan = preview(before(file, tmp_path), file)
    anew = {"q-learning", "tutorial", "double-q-learning", "dyna-q", "expected-sarsa", "prioritized-sweeping"}
    assert plan.reasons == dict.fromkeys(anew | {"r-max"}, "whose code changed")
    assert (len(plan.kept), len(plan.missing), plan.aside) == (12, 26, 7)


def test_a_file_of_0_1_0_is_taken_over_when_it_is_written_and_no_copy_stays(
    unchanged: Path, tmp_path: Path
) -> None:
    with closing(sqlite3.connect(unchanged)) as connection:
        assert connection.execute("PRAGMA user_version").fetchone() == (1,)
    prune(unchanged)
    with closing(sqlite3.connect(unchanged)) as connection:
        assert connection.execute("PRAGMA user_version").fetchone() == (2,)
    assert [path.name for path in tmp_path.iterdir()] == [unchanged.name]


def test_code_of_built_in_agents_is_known_to_leave_the_bits_of_before() -> None:
    # An agent whose code was edited: if it leaves the same bits, add its digest to
    # arena/results/data/equivalent_code.json; if not, let that alone be its row.
    for agent, code in source_digests(BUILT_IN.values()).items():
        assert code in equivalent_code()[agent], f"{agent}: {code}"
