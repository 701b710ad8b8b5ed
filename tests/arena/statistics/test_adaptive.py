"""As many replicates as it takes."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bits import bits_of
from hand_made_agents import Failing
from hypothesis import given, settings
from hypothesis import strategies as st
from made_up_results import made_up

from agents import MomentumAgent, QLearning, RandomAgent
from arena import Entrant, Evaluation, Tournament, Training, load, run
from arena.analysis import leaderboard
from arena.cli import main
from arena.results import digest
from arena.statistics.permutation import smallest_p
from arena.statistics.sequential import Look, decided, looks
from arena.tournament import from_dict


def race(*entrants: Entrant, **arguments: Any) -> Tournament:
    defaults: dict[str, Any] = {"replicates": "adaptive", "max_replicates": 20, "seed": 3, "name": "ad"}
    return Tournament(
        entrants or (Entrant("m", MomentumAgent), Entrant("r", RandomAgent)),
        training=Training(episodes=3, max_steps=100),
        evaluation=Evaluation(episodes=5, max_steps=200),
        **defaults | arguments,
    )


def test_the_levels_add_up_to_what_may_be_spent() -> None:
    plan = looks(2, 20, 0.95)
    # Lan and DeMets' function at 10/20, 15/20 and 1; five replicates can show nothing.
    assert [look.replicates for look in plan] == [10, 15, 20]
    spent = np.cumsum([look.level for look in plan])
    assert spent == pytest.approx(0.05 * np.log(1.0 + (np.e - 1.0) * np.array([0.5, 0.75, 1.0])))
    assert looks(2, 5, 0.95) == []
    assert [look.replicates for look in looks(2, 12, 0.95)] == [10, 12]


@given(entrants=st.integers(1, 12), most=st.integers(1, 60), confidence=st.floats(0.5, 0.99))
def test_every_look_can_show_something_and_nothing_is_spent_twice(
    entrants: int, most: int, confidence: float
) -> None:
    plan = looks(entrants, most, confidence)
    pairs = max(1, entrants * (entrants - 1) // 2)
    assert sum(look.level for look in plan) <= (1.0 - confidence) * (1.0 + 1e-9)
    assert all(smallest_p(look.replicates) * pairs <= look.level for look in plan)
    assert all(look.replicates <= most for look in plan)
    assert [look.replicates for look in plan] == sorted({look.replicates for look in plan})


def test_when_the_leaders_are_decided() -> None:
    noise = np.array([0.0, 3.0, 1.0, 4.0, 2.0, 6.0, 5.0, 7.0, 9.0, 8.0])
    costs = np.stack([noise + 50.0, noise, noise[::-1] + 50.5, noise + 90.0])
    look = Look(10, 0.03)
    assert decided(costs, look)
    assert not decided(costs, Look(10, 0.001))
    assert not decided(costs, Look(6, 0.03))
    assert not decided(costs, look, leaders=2)  # the second and third cannot be told apart
    assert not decided(costs[[0, 2]], look)
    assert decided(costs[[0, 1, 3]], look, leaders=3)
    later = np.concatenate([costs, np.full((4, 5), 1e6)], axis=1)
    assert decided(later, look)  # only the look's replicates count


def test_it_stops_as_soon_as_the_first_is_decided_with_the_bits_of_a_fixed_tournament(
    tmp_path: Path,
) -> None:
    seen: list[tuple[int, int]] = []
    with run(race(), tmp_path / "a.sqlite", n_jobs=1, progress=lambda *at: seen.append(at)) as results:
        adaptive = bits_of(results)
        board = leaderboard(results)
        assert len(results.runs) == 20
        assert repr(results) == "<Results of 'ad': 20 of 40 runs>"
    assert seen[0] == (0, 20)
    assert seen[-1] == (20, 20)
    with run(race(replicates=10), n_jobs=1) as fixed:
        assert bits_of(fixed) == adaptive
    assert [one.entrant for one in board.standings] == ["m", "r"]
    assert [one.place for one in board.standings] == [1, 2]
    (remark,) = board.remarks
    assert remark == (
        "The first place is decided after 10 of at most 20 replicates: 10 saved, 20 runs "
        "(95% confidence over all looks)."
    )


def test_it_ends_at_the_budget_if_nothing_can_be_decided() -> None:
    twins = (Entrant("a", MomentumAgent), Entrant("b", MomentumAgent))
    seen: list[tuple[int, int]] = []
    with run(race(*twins), n_jobs=1, progress=lambda *at: seen.append(at)) as results:
        assert len(results.runs) == 40
        board = leaderboard(results)
    assert sorted({total for _, total in seen}) == [20, 30, 40]
    assert seen[-1] == (40, 40)
    assert {one.place for one in board.standings} == {1}
    assert board.remarks == (
        "The first place is not decided after 20 of at most 20 replicates (95% confidence over all looks).",
    )


def test_it_is_continued_by_the_same_tournament(tmp_path: Path) -> None:
    class Stop(Exception):
        pass

    path = tmp_path / "a.sqlite"
    twins = (Entrant("a", MomentumAgent), Entrant("b", QLearning, bins=4))

    def stop_at(wanted: int) -> Any:
        def progress(finished: int, _total: int) -> None:
            if finished == wanted:
                raise Stop

        return progress

    with run(race(*twins), n_jobs=1) as whole:
        expected, hashed = bits_of(whole), digest(whole)
    for wanted in (7, 15):
        with pytest.raises(Stop):
            run(race(*twins), path, n_jobs=1, progress=stop_at(wanted))
        with load(path) as part:
            assert len(part.runs) == wanted
            assert "not finished" in leaderboard(part).remarks[0]
            assert {one.place for one in leaderboard(part).standings} == {1}
    with run(race(*twins), path, n_jobs=1) as results:
        assert bits_of(results) == expected
        assert digest(results) == hashed
    before = path.read_bytes()
    seen: list[tuple[int, int]] = []
    run(race(*twins), path, n_jobs=1, progress=lambda *at: seen.append(at)).close()
    assert all(finished == total for finished, total in seen)
    assert path.read_bytes() == before
    for change in ({"replicates": 10}, {"max_replicates": 22}):
        with (
            run(race(*twins, **change), n_jobs=1) as fresh,
            run(race(*twins, **change), path, n_jobs=1) as grown,
        ):
            assert digest(grown) == digest(fresh)


def test_entrants_that_fail_count_as_the_worst_and_are_decided() -> None:
    with run(race(Entrant("m", MomentumAgent), Entrant("bad", Failing)), n_jobs=1) as results:
        assert len(results.runs) == 20
        assert [one.entrant for one in leaderboard(results).standings] == ["m", "bad"]


def test_an_adaptive_tournament_is_told_and_told_back() -> None:
    tournament = race(confidence=0.9, leaders=2)
    plain = json.loads(json.dumps(tournament.to_dict()))
    assert (plain["replicates"], plain["max_replicates"]) == ("adaptive", 20)
    assert (plain["confidence"], plain["leaders"]) == (0.9, 2)
    assert from_dict(plain) == tournament
    assert len(tournament.runs) == 40
    fixed = replace(tournament, replicates=3)
    assert "max_replicates" not in fixed.to_dict()
    assert len(fixed.runs) == 6


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"replicates": "adaptiv"}, "replicates must be an integer, got 'adaptiv'"),
        ({"max_replicates": 5}, "max_replicates must be at least 6 to tell 2 entrants apart at 95%"),
        ({"max_replicates": 0}, "max_replicates must be at least 1, got 0"),
        ({"max_replicates": 10**9}, "at most 10000 replicates"),
        ({"confidence": 1.0}, "a confidence below 1"),
        ({"confidence": 0}, "confidence must be in"),
        ({"leaders": 0}, "leaders must be at least 1, got 0"),
    ],
)
def test_bad_arguments_are_told(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=message):
        race(**arguments)


def test_max_replicates_is_as_small_as_it_can_be() -> None:
    least = next(most for most in range(1, 30) if looks(2, most, 0.95))
    assert race(max_replicates=least).most_replicates == least
    with pytest.raises(ValueError, match=f"must be at least {least} to tell"):
        race(max_replicates=least - 1)


def test_the_command_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("race.toml").write_text(
        "training = { episodes = 3, max_steps = 100 }\nevaluation = { episodes = 5, max_steps = 200 }\n"
        'replicates = "adaptive"\nmax_replicates = 15\n'
        '[[entrants]]\nagent = "momentum"\n[[entrants]]\nagent = "random"\n'
    )
    assert main(["run", "race.toml", "--jobs", "1"]) == 0
    text = capsys.readouterr().out
    assert "2 entrants, at most 15 replicates, seed 0." in text
    assert "decided after 10 of at most 15 replicates: 5 saved, 10 runs" in text
    assert main(["show", "runs/race.sqlite"]) == 0
    assert capsys.readouterr().out == text
    assert main(["verify", "runs/race.sqlite", "--runs", "2"]) == 0
    options = ["--replicates", "adaptive", "--max-replicates", "12", "--confidence", "0.9"]
    assert main(["run", "race.toml", "--no-report", "--jobs", "1", "--out", "o.sqlite", *options]) == 0
    with load("o.sqlite") as results:
        assert (results.config["max_replicates"], results.config["confidence"]) == (12, 0.9)
    capsys.readouterr()
    assert main(["run", "race.toml", "--replicates", "often"]) == 2
    assert "it must be a number, a part such as 50:100, or adaptive, got 'often'" in capsys.readouterr().err
    assert main(["run", "quick", "--replicates", "adaptive", "--max-replicates", "2"]) == 2
    assert "max_replicates must be at least" in capsys.readouterr().err


@settings(max_examples=30, deadline=None)
@given(data=st.data())
def test_a_damaged_configuration_is_told(data: st.DataObject) -> None:
    from arena.results.schema import is_valid_config

    config = json.loads(json.dumps(race().to_dict()))
    assert is_valid_config(config)
    key = data.draw(st.sampled_from(["max_replicates", "confidence", "leaders", "replicates", "training"]))
    config[key] = data.draw(st.sampled_from([None, "x", -1, 0, [], {}, float("nan"), 10**9, True]))
    fine = isinstance(config["replicates"], int) or (key == "leaders" and config[key] in (True, 10**9))
    fine |= key == "max_replicates" and config[key] is True
    assert is_valid_config(config) == fine


def test_the_gate_takes_adaptive_files_of_unlike_length() -> None:
    from arena.analysis import regressions

    values = [100.0 + n for n in range(10)]
    with made_up({"a": values}, replicates=10) as old, made_up({"a": [*values, 1.0]}, replicates=11) as new:
        assert not regressions(new, old)[0].regressed
