"""Running, continuing and failing."""

import logging
from pathlib import Path

import pytest
from bits import bits_of
from hand_made_agents import Astray, Failing, Leaky, Scripted, Uncompilable, race_of

from arena import Entrant, Tournament, load, run
from arena.results.store import Store


def test_a_results_file_is_continued_and_finished_runs_are_not_repeated(
    small: Tournament, tmp_path: Path
) -> None:
    with run(small, n_jobs=1) as whole:
        expected = bits_of(whole)
    path = tmp_path / "deep" / "small.sqlite"

    class Stop(Exception):
        pass

    def stop_in_the_middle(finished: int, _total: int) -> None:
        if finished == 2:
            raise Stop

    with pytest.raises(Stop):
        run(small, path, n_jobs=1, progress=stop_in_the_middle)
    with load(path) as part:
        kept = part.frame()
    assert len(kept) == 2

    seen: list[tuple[int, int]] = []
    with run(small, path, n_jobs=1, progress=lambda *at: seen.append(at)) as results:
        assert bits_of(results) == expected
        after = results.frame().set_index(["entrant", "replicate"])
    assert seen == [(2, 4), (3, 4), (4, 4)]
    before = kept.set_index(["entrant", "replicate"])
    assert (after.loc[before.index].seconds == before.seconds).all()  # not run again

    seen.clear()
    with run(small, path, n_jobs=1, progress=lambda *at: seen.append(at)) as results:
        assert bits_of(results) == expected
    assert seen == [(4, 4)]


def test_another_tournament_never_overwrites_a_file(small: Tournament, tmp_path: Path) -> None:
    path = tmp_path / "small.sqlite"
    run(small, path, n_jobs=1).close()
    before = path.read_bytes()
    with pytest.raises(ValueError, match=r"small.sqlite holds another tournament .its name is 'small'"):
        run(race_of(*small.entrants), path)
    assert path.read_bytes() == before


def test_a_class_that_cannot_be_compiled_runs_interpreted_and_the_reason_is_said_once(
    caplog: pytest.LogCaptureFixture,
) -> None:
    tournament = race_of(
        Entrant("a", Uncompilable), Entrant("b", Uncompilable, leak=0.1), Entrant("c", Scripted)
    )
    with caplog.at_level(logging.WARNING, "arena"), run(tournament, n_jobs=1) as results:
        frame = results.frame()
    assert set(frame.driver) == {"pettingzoo"}
    assert set(frame.status) == {"finished"}
    assert sorted(caplog.messages) == [
        "Scripted runs interpreted: it is no NamedTuple",
        (
            "Uncompilable runs interpreted: Untyped global name 'ACTIONS': "
            "Cannot determine Numba type of <class 'dict'>"
        ),
    ]


def test_with_numbas_switch_for_debugging_all_run_interpreted_to_the_same_bits(
    small: Tournament, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    with run(small, n_jobs=1) as compiled:
        expected = bits_of(compiled)
    monkeypatch.setattr("numba.config.DISABLE_JIT", 1)
    with caplog.at_level(logging.WARNING, "arena"), run(small, n_jobs=1) as results:
        assert bits_of(results) == expected
        assert set(results.frame().driver) == {"pettingzoo"}
    reason = "runs interpreted: NUMBA_DISABLE_JIT is set"
    assert caplog.messages == [f"QLearning {reason}", f"Sarsa {reason}"]
    with pytest.raises(ValueError, match=r"^entrant 'q' cannot be compiled: NUMBA_DISABLE_JIT is set$"):
        run(small, n_jobs=1, driver="compiled")


def test_the_compiled_driver_refuses_what_it_cannot_compile_before_anything_is_written(
    tmp_path: Path,
) -> None:
    path = tmp_path / "r.sqlite"
    with pytest.raises(ValueError, match="entrant 'a' cannot be compiled"):
        run(race_of(Entrant("a", Scripted)), path, n_jobs=1, driver="compiled")
    assert not path.exists()


@pytest.mark.parametrize("driver", ["compiled", "pettingzoo"])
@pytest.mark.parametrize(
    ("agent", "reason"), [(Failing, "RuntimeError: no more"), (Astray, "ValueError: action must be")]
)
def test_an_entrant_that_fails_is_a_result_and_the_others_are_as_without_it(
    small: Tournament, driver: str, agent: type[Leaky], reason: str
) -> None:
    with run(small, n_jobs=1, driver=driver) as results:
        expected = bits_of(results)[1]
    tournament = race_of(*small.entrants, Entrant("bad", agent))
    with run(tournament, n_jobs=1, driver=driver) as results:
        runs = {(one["entrant"], one["replicate"]): one for one in results.runs}
        found = bits_of(results)[1]
    assert {key: found[key] for key in expected} == expected
    for replicate in (0, 1):
        bad = runs["bad", replicate]
        assert bad["status"] == "failed"
        assert bad["accuracy"] is None
        assert reason in bad["error"].splitlines()[-1]


def test_failed_runs_are_tried_again(small: Tournament, tmp_path: Path) -> None:
    path = tmp_path / "r.sqlite"
    tournament = race_of(*small.entrants, Entrant("bad", Failing))
    run(tournament, path, n_jobs=1).close()
    seen: list[int] = []
    run(tournament, path, n_jobs=1, progress=lambda finished, _: seen.append(finished)).close()
    assert seen == [4, 5, 6]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"n_jobs": 0}, "n_jobs must not be 0"),
        ({"n_jobs": 1.5}, "n_jobs must be an integer, got 1.5"),
        ({"driver": "compild"}, "driver must be one of .*'compild'; did you mean 'compiled'"),
    ],
)
def test_bad_arguments_are_told_before_anything_is_written(
    small: Tournament, tmp_path: Path, arguments: dict[str, object], message: str
) -> None:
    with pytest.raises((TypeError, ValueError), match=message):
        run(small, tmp_path / "r.sqlite", **arguments)  # type: ignore[arg-type]
    assert not list(tmp_path.iterdir())


def test_only_a_tournament_can_be_run() -> None:
    with pytest.raises(TypeError, match="tournament must be a Tournament, got 'paper'"):
        run("paper")  # type: ignore[arg-type]


def test_a_store_that_is_given_no_name_leaves_no_file(small: Tournament, tmp_path: Path) -> None:
    store = Store.create(None, small.to_dict())
    assert store.path is None
    assert store.config["name"] == "small"
    store.close()
    assert not list(tmp_path.iterdir())
