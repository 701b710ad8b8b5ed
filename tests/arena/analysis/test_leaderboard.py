"""Scores, the leaderboard, two entrants side by side, and the gate."""

import io
import json
import math
import re
from typing import Any

import numpy as np
import pytest
from made_up_results import LIMIT, made_up
from rich.console import Console

from agents import MomentumAgent, RandomAgent
from agents.optimal import Optimal, optimal_steps
from arena import Entrant, Evaluation, Results, Tournament, Training, run
from arena.analysis import SCORES, compare_entrants, leaderboard, learning_curves, regressions, scores_of
from arena.report.tables import render
from arena.statistics.intervals import mean_estimate
from envs import Hill

NOISE = [0.0, 3.0, 1.0, 4.0, 2.0, 6.0, 5.0, 7.0, 9.0, 8.0]


def four(count: int = 10, **arguments: Any) -> Results:
    """Two that cannot be told apart, one that is worse, one that is worse yet."""
    noise = NOISE[:count]
    steps = {
        "slow": [200.0 + n for n in noise],
        "a": [100.0 + n for n in noise],
        "b": [100.5 + n for n in noise[::-1]],
        "middle": [150.0 + n for n in noise],
    }
    return made_up(steps, **arguments)


def printed(results: Results, by: str | None = "steps") -> str:
    console = Console(file=io.StringIO(), width=80)
    console.print(render(results, by), soft_wrap=True)
    assert isinstance(console.file, io.StringIO)
    return console.file.getvalue()


def test_places_scores_and_ties() -> None:
    with four() as results:
        board = leaderboard(results)
    assert [(one.entrant, one.place, one.last_place) for one in board.standings] == [
        ("a", 1, 2),
        ("b", 1, 2),
        ("middle", 3, 3),
        ("slow", 4, 4),
    ]
    first = board.standings[0]
    assert first.tied == ("b",)
    assert first.scores["steps"] == mean_estimate([100.0 + n for n in NOISE])
    assert first.interquartile.value == pytest.approx(104.5)
    assert first.scores["accuracy"] == (100.0, 100.0, 100.0)
    assert sum(first.shares) == pytest.approx(1.0)
    assert first.shares[0] > 0.5
    assert first.shares[2:] == (0.0, 0.0)
    assert board.remarks == ()
    assert board.replicates == 10


def test_the_order_of_the_entrants_changes_nothing() -> None:
    with four() as results:
        names = [one["name"] for one in results.config["entrants"]]
        steps = {name: scores_of(results).values["steps"][i] for i, name in enumerate(names)}
        board = leaderboard(results)
    with made_up({name: steps[name] for name in reversed(names)}) as turned:
        other = leaderboard(turned)
    assert other.frame().equals(board.frame())


def test_a_failed_run_counts_as_the_worst() -> None:
    with made_up({"good": [100.0, 102.0], "broken": [90.0, None], "lost": [95.0, LIMIT]}) as results:
        scores = scores_of(results)
        board = leaderboard(results)
        text = printed(results)
    assert scores.values["steps"].tolist() == [[100, 102], [90, LIMIT], [95, LIMIT]]
    assert scores.values["accuracy"].tolist() == [[100, 100], [100, 0], [100, 0]]
    assert scores.values["length"].tolist() == [[100, 102], [90, LIMIT], [95, LIMIT]]
    assert scores.values["iterations"].tolist() == [[100, 100], [100, 10 * 1000], [100, 100]]
    assert scores.failed.tolist() == [[False, False], [False, True], [False, False]]
    assert [one.entrant for one in board.standings] == ["good", "broken", "lost"]
    assert [one.failed for one in board.standings] == [0, 1, 0]
    assert "A run that failed counts as the worst that is possible: broken (1)." in text
    assert "broken replicate 1 failed: ouch" in text


def test_only_replicates_that_all_have_run_count() -> None:
    with made_up({"a": [100.0, 110.0, 120.0], "b": [90.0, 95.0]}, replicates=3) as results:
        assert scores_of(results).replicates == (0, 1)
        assert leaderboard(results).replicates == 2
        assert "Not finished: only the 2 replicates that all entrants have run count." in printed(results)
    with made_up({"a": [100.0], "b": []}) as results:
        board = leaderboard(results)
        assert [one.place for one in board.standings] == [1, 1]
        assert all(math.isnan(one.scores["steps"].value) for one in board.standings)
        json.dumps(board.to_dict(), allow_nan=False)
        assert " - " in printed(results)
        with pytest.raises(ValueError, match="there is no replicate that all entrants have run"):
            compare_entrants(results, "a", "b")


def test_the_score_that_decides_can_be_chosen() -> None:
    with made_up({"short": [90.0, LIMIT], "sure": [200.0, 201.0]}) as results:
        first = {by: leaderboard(results, by).standings[0].entrant for by in ("steps", "accuracy", "length")}
        assert first == {"steps": "sure", "accuracy": "sure", "length": "sure"}
        with pytest.raises(ValueError, match=r"by must be one of .*; did you mean 'length'"):
            leaderboard(results, "lenght")
        with pytest.raises(ValueError, match="confidence must be between 0 and 1, got 1"):
            leaderboard(results, confidence=1.0)


def test_regret_is_what_is_beyond_a_bound_for_each_start() -> None:
    bounds = {0: np.array([80.0, 80.0, 90.0, 90.0]), 1: np.full(4, 100.0)}
    with made_up({"a": [100.0, 101.0], "b": [LIMIT, None]}) as results:
        scores = scores_of(results, "regret", bounds)
        with pytest.raises(ValueError, match="bounds of replicate 0 must have 4 values, got 3"):
            scores_of(results, "regret", {0: np.zeros(3)})
        with pytest.raises(ValueError, match="by must be one of accuracy, iterations, length, steps, got"):
            scores_of(results, "steps").costs("regret")
    assert scores.values["regret"].tolist() == [[15.0, 1.0], [415.0, 400.0]]
    assert scores.values["regret_median"].tolist() == [[15.0, 1.0], [415.0, 400.0]]
    assert scores.values["regret_90"][0, 0] == pytest.approx(np.quantile([19.0, 20.0, 10.0, 11.0], 0.9))
    assert set(scores.values) == {*SCORES, "regret_median", "regret_90"}


@pytest.mark.system
def test_nobody_beats_the_bounds_that_are_computed_and_the_optimum_attains_them() -> None:
    entrants = (Entrant("optimal", Optimal), Entrant("momentum", MomentumAgent), Entrant("lost", RandomAgent))
    tournament = Tournament(
        entrants,
        training=Training(episodes=1, max_steps=1),
        evaluation=Evaluation(episodes=20, max_steps=300),
        replicates=2,
    )
    with run(tournament, n_jobs=1) as results:
        scores = scores_of(results, "regret")
        board = leaderboard(results, "regret")
        tables = printed(results, "regret")
        by_hand = [
            results.arrays("momentum", r)["test_lengths"]
            - optimal_steps(tournament.hill, tournament.conditions.start_states(r)[:, 0])[0]
            for r in (0, 1)
        ]
    assert scores.values["regret"][0].tolist() == [0.0, 0.0]
    assert scores.values["regret"][1].tolist() == [one.mean() for one in by_hand]
    assert min(map(np.min, by_hand)) > 0
    assert (scores.values["regret"][2] > 190.0).all()  # the limit less some hundred steps
    assert [one.entrant for one in board.standings] == ["optimal", "momentum", "lost"]
    assert re.search(r"^ 1-3 +momentum +\d+\.\d ± ", tables, re.MULTILINE)  # names fit beside the columns
    assert "By the mean steps of a test drive beyond the fewest possible from its start." in tables


def test_where_the_goal_cannot_be_reached_there_is_nothing_to_regret() -> None:
    tournament = Tournament(
        (Entrant("momentum", MomentumAgent),),
        hill=Hill(thrust=1e-5),
        training=Training(episodes=1, max_steps=1),
        evaluation=Evaluation(episodes=3, max_steps=100),
        replicates=1,
    )
    with run(tournament, n_jobs=1) as results:
        assert scores_of(results, "regret").values["regret"].tolist() == [[0.0]]


def test_it_is_told_when_nothing_can_be_shown() -> None:
    with four(3) as results:
        board = leaderboard(results)
        text = printed(results)
    assert {(one.place, one.last_place) for one in board.standings} == {(1, 4)}
    (remark,) = board.remarks
    assert remark == (
        "With 3 replicates no difference can be shown at 95% confidence in 6 comparisons: "
        "8 or more are needed."
    )
    assert remark in text
    with four(8) as results:
        assert leaderboard(results).remarks == ()
        assert leaderboard(results).standings[3].place == 4
    with made_up({"alone": [100.0, 101.0]}) as results:
        assert leaderboard(results).remarks == ()


def test_the_table_fits_in_80_columns() -> None:
    name = "semi-gradient-sarsa 8x8"[:22]
    steps = {name: [400.0 + 9 * n for n in NOISE], **{f"{name[:-2]}{i}": [450.0] * 10 for i in range(9)}}
    with made_up(steps, iterations=1_234_567) as results:
        for by in ("steps", "accuracy", "length", "iterations"):
            lines = printed(results, by).splitlines()
            rows = [line for line in lines if name[:-2] in line]
            assert len(rows) == 10
            assert max(len(line) for line in rows) <= 80
            assert "…" not in "".join(rows)


def test_the_table_says_what_the_board_says() -> None:
    with four() as results:
        text = printed(results)
    rows = [line.split() for line in text.splitlines() if line[1:4] in ("1-2", "3  ", "4  ")]
    assert [row[:2] for row in rows] == [["1-2", "a"], ["1-2", "b"], ["3", "middle"], ["4", "slow"]]
    assert rows[0][2:] == ["104.5", "±", "2.2", "100.0", "104.5", "100"]
    assert "By the mean steps of a test drive, one that fails counted at the limit." in text
    assert "Places such as 2-4: any of these, with 95% confidence for all" in text
    with made_up({"a": NOISE, "b": NOISE[::-1]}) as results:
        assert "No two can be told apart" in printed(results)


def test_frame_and_dictionary_agree() -> None:
    with four() as results:
        board = leaderboard(results)
    frame, told = board.frame(), json.loads(json.dumps(board.to_dict(), allow_nan=False))
    assert frame.entrant.tolist() == [one["entrant"] for one in told["standings"]]
    assert frame.steps_low.tolist() == [one["scores"]["steps"]["low"] for one in told["standings"]]
    assert frame.steps_iqm.tolist() == [one["interquartile"]["value"] for one in told["standings"]]
    assert frame["first"].sum() == pytest.approx(1.0)
    assert np.array(told["p_values"]).shape == (4, 4)
    assert told["p_values"][0][2] == pytest.approx(6 * 2 / 2**10)


# Two entrants.


def test_two_entrants_side_by_side() -> None:
    with four() as results:
        duel = compare_entrants(results, "a", "middle")
        assert duel.verdict == "a is better than middle."
        assert duel.difference == (-50.0, -50.0, -50.0)
        assert duel.p_value == 2 / 2**10
        assert duel.probability.value == 1.0
        assert duel.means[1].value == pytest.approx(154.5)
        assert compare_entrants(results, "middle", "a").verdict == "a is better than middle."
        assert compare_entrants(results, "middle", "a").probability.value == 0.0
        assert compare_entrants(results, "a", "b").verdict == "They cannot be told apart."
        assert compare_entrants(results, "a", "b", "accuracy").p_value == 1.0
        assert json.loads(json.dumps(duel.to_dict()))["difference"]["value"] == -50.0
        with pytest.raises(
            ValueError, match=r"entrant must be one of .*, got 'midle'; did you mean 'middle'"
        ):
            compare_entrants(results, "a", "midle")
        with pytest.raises(ValueError, match="entrants must be two, got 'a' twice"):
            compare_entrants(results, "a", "a")
    with four(5) as results:
        assert compare_entrants(results, "a", "middle").verdict.startswith(
            "With 5 replicates no difference can be shown at 95% confidence in 1 comparison: 6 or more"
        )


def test_more_accuracy_is_better() -> None:
    with made_up({"lost": [LIMIT] * 6, "sure": [400.0 + n for n in range(6)]}) as results:
        duel = compare_entrants(results, "lost", "sure", "accuracy")
        board = leaderboard(results, "accuracy")
    assert duel.verdict == "sure is better than lost."
    assert duel.difference.value == -100.0
    assert [one.place for one in board.standings] == [1, 2]
    assert board.standings[0].entrant == "sure"


# The gate.


def test_an_entrant_that_got_worse_is_found() -> None:
    with four() as old, four() as same:
        assert [one.regressed for one in regressions(same, old)] == [False] * 4
        assert [one.p_value for one in regressions(same, old)] == [1.0] * 4
    worse = {
        "slow": [190.0 + n for n in NOISE],  # better
        "a": [101.0 + n / 2 for n in NOISE],  # chance
        "b": [110.0 + n for n in NOISE],  # worse
        "new": NOISE,
    }
    with four() as old, made_up(worse) as new:
        found = {one.entrant: one for one in regressions(new, old)}
        assert set(found) == {"slow", "a", "b"}
        assert [name for name, one in found.items() if one.regressed] == ["b"]
        assert found["b"].worse.value == pytest.approx(9.5)
        assert found["slow"].worse.value == pytest.approx(-10.0)
        assert found["b"].p_value == pytest.approx(3 / 2**10)
        assert not any(one.regressed for one in regressions(new, old, 20.0))
        assert not any(one.regressed for one in regressions(new, old, 0.2, relative=True))
        assert json.loads(json.dumps(found["b"].to_dict()))["regressed"] is True


def test_what_is_allowed_is_allowed_and_no_more() -> None:
    old = {"a": [100.0 + n for n in NOISE]}
    with made_up(old) as before, made_up({"a": [value * 1.03 for value in old["a"]]}) as after:
        assert regressions(after, before, 0.025, relative=True)[0].regressed
        assert not regressions(after, before, 0.035, relative=True)[0].regressed
        assert regressions(after, before, 2.9)[0].regressed
        assert not regressions(after, before, 3.5)[0].regressed


def test_an_entrant_that_fails_now_got_worse() -> None:
    with made_up({"a": NOISE}) as old, made_up({"a": [None] * 10}) as new:
        for by in ("steps", "accuracy", "length", "iterations"):
            assert regressions(new, old, by=by)[0].regressed, by


def test_files_that_cannot_be_compared_are_told() -> None:
    shorter = made_up({"a": NOISE}, evaluation=Evaluation(4, 7))
    with four() as old, four(3) as few, made_up({"other": NOISE}) as other, shorter:
        with pytest.raises(ValueError, match=r"With 3 replicates no difference can be shown.* 7 or more"):
            regressions(few, old)
        with pytest.raises(ValueError, match="they have no entrant in common"):
            regressions(other, old)
        with pytest.raises(ValueError, match="by must be one of"):
            regressions(old, old, by="speed")
        with pytest.raises(ValueError, match="max_regression must be a finite number of at least 0"):
            regressions(old, old, -1.0)
        with pytest.raises(ValueError, match="the files cannot be compared: their evaluation differs"):
            regressions(shorter, old)


def test_learning_curves_of_results() -> None:
    with made_up({"a": [100.0, None], "b": [90.0, 91.0]}, iterations=200) as results:
        frame = learning_curves(results, level=20.0, window=3)
        assert frame.entrant.tolist() == ["a", "b", "b"]
        assert frame.area.tolist() == [20.0] * 3
        assert frame.settled.tolist() == [3.0] * 3
        assert learning_curves(results, level=19.0, window=3).settled.isna().all()
        assert learning_curves(results, level=20.0).area.isna().all()  # ten episodes, a window of 50
