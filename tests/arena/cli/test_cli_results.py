"""``arena show`` and ``arena compare``, as users run them."""

import csv
import io
import json
import re
from pathlib import Path

import pytest
from made_up_results import made_up

from arena.analysis import SCORES
from arena.cli import main
from arena.cli.options import By

NOISE = [0.0, 3.0, 1.0, 4.0, 2.0, 6.0, 5.0, 7.0, 9.0, 8.0]
OLD = {"a": [100.0 + n for n in NOISE], "b": [130.0 + n for n in NOISE], "gone": NOISE}


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """old.sqlite, worse.sqlite (b got worse), few.sqlite and paper.sqlite in the current folder."""
    monkeypatch.chdir(tmp_path)
    made_up(OLD, Path("old.sqlite")).close()
    worse = {"new": NOISE, "b": [140.0 + n for n in NOISE], "a": OLD["a"][::-1]}
    made_up(worse, Path("worse.sqlite")).close()
    made_up({name: values[:3] for name, values in OLD.items()}, Path("few.sqlite")).close()
    made_up(OLD, Path("paper.sqlite"), name="paper").close()
    Path("other.txt").write_text("precious")


def told(capsys: pytest.CaptureFixture[str], *arguments: str, code: int = 0) -> str:
    """What the command prints on stdout."""
    assert main(list(arguments)) == code
    printed = capsys.readouterr()
    assert printed.err == ""
    return printed.out


@pytest.mark.usefixtures("files")
def test_show_prints_the_leaderboard(capsys: pytest.CaptureFixture[str]) -> None:
    text = told(capsys, "show", "old.sqlite")
    assert text == told(capsys, "show", "old.sqlite", "--by", "steps")
    rows = [line.split()[:2] for line in text.splitlines() if " ± " in line]
    assert rows == [["1", "gone"], ["2", "a"], ["3", "b"]]
    assert "100.0" in text
    assert told(capsys, "show", "old.sqlite", "--by", "iterations") != text
    assert "99% interval" in told(capsys, "show", "old.sqlite", "--confidence", "0.99")


@pytest.mark.usefixtures("files")
def test_the_choices_of_by_are_the_scores() -> None:
    assert [choice.value for choice in By] == list(SCORES)


@pytest.mark.usefixtures("files")
def test_show_prints_json_and_csv(capsys: pytest.CaptureFixture[str]) -> None:
    everything = json.loads(told(capsys, "show", "old.sqlite", "--json", "--by", "accuracy"))
    assert everything["leaderboard"]["by"] == "accuracy"
    assert len(everything["runs"]) == 30
    standings = everything["leaderboard"]["standings"]
    rows = list(csv.DictReader(io.StringIO(told(capsys, "show", "old.sqlite", "--csv", "--by", "accuracy"))))
    assert [row["entrant"] for row in rows] == [one["entrant"] for one in standings]
    assert [float(row["steps"]) for row in rows] == [one["scores"]["steps"]["value"] for one in standings]
    assert {row["place"] for row in rows} == {"1"}


@pytest.mark.usefixtures("files")
def test_the_paper_s_tournament_has_a_leaderboard_when_a_score_is_asked_for(
    capsys: pytest.CaptureFixture[str],
) -> None:
    plain = told(capsys, "show", "paper.sqlite")
    assert "Table 1" in plain
    assert "place" not in plain
    board = told(capsys, "show", "paper.sqlite", "--by", "steps")
    assert "Table 1" not in board
    assert "place" in board


@pytest.mark.usefixtures("files")
def test_compare_two_entrants(capsys: pytest.CaptureFixture[str]) -> None:
    text = told(capsys, "compare", "old.sqlite", "a", "b")
    assert "difference of the means" in text
    assert text.endswith("p = 0.002. a is better than b.\n")
    duel = json.loads(told(capsys, "compare", "old.sqlite", "a", "b", "--json"))
    assert duel["p_value"] == 2 / 2**10
    assert duel["difference"]["value"] == pytest.approx(-30.0)
    equal = told(capsys, "compare", "old.sqlite", "a", "b", "--by", "accuracy")
    assert "They cannot be told apart." in equal
    assert "6 or more are needed." in told(capsys, "compare", "few.sqlite", "a", "b")


@pytest.mark.usefixtures("files")
def test_the_gate_opens_and_closes(capsys: pytest.CaptureFixture[str]) -> None:
    baseline = ("--baseline", "old.sqlite")
    text = told(capsys, "compare", "worse.sqlite", *baseline, code=1)
    assert "b  134.5 -> 144.5, worse by +10.0 [+10.0, +10.0], p = 0.002: worse beyond chance\n" in text
    assert "a  104.5 -> 104.5, worse by +0.0" in text
    assert text.count("worse beyond chance") == 1
    assert "Only in the baseline: gone.\nOnly in the new file: new.\n" in text
    told(capsys, "compare", "old.sqlite", *baseline)
    told(capsys, "compare", "worse.sqlite", *baseline, "--max-regression", "10")
    told(capsys, "compare", "worse.sqlite", *baseline, "--max-regression", "9.9", code=1)
    told(capsys, "compare", "worse.sqlite", *baseline, "--max-regression", "8%")
    told(capsys, "compare", "worse.sqlite", *baseline, "--max-regression", "7%", code=1)
    told(capsys, "compare", "worse.sqlite", *baseline, "--by", "accuracy")
    change = json.loads(told(capsys, "compare", "worse.sqlite", *baseline, "--json", code=1))
    assert (change["regressed"], change["only_baseline"], change["only_new"]) == (True, ["gone"], ["new"])
    assert [one["regressed"] for one in change["entrants"]] == [True, False]


@pytest.mark.usefixtures("files")
def test_curves_tell_how_fast_entrants_learn(capsys: pytest.CaptureFixture[str]) -> None:
    made_up({"quick": NOISE, "slow": NOISE[:3]}, Path("fast.sqlite"), iterations=100).close()
    text = told(capsys, "curves", "fast.sqlite", "--window", "3", "--level", "10")
    assert re.search(r"^ quick +10\.0 ± 0\.0 +10 of 10 +3 $", text, re.MULTILINE)
    assert re.search(r"^ slow +10\.0 ± 0\.0 +3 of 3 +3 $", text, re.MULTILINE)
    never = json.loads(told(capsys, "curves", "fast.sqlite", "--window", "3", "--level", "9.5", "--json"))
    assert never["entrants"][0] == {
        "entrant": "quick",
        "area": 10.0,
        "area_error": 0.0,
        "settled": 0,
        "replicates": 10,
        "median_episode": None,
    }
    assert "- " in told(capsys, "curves", "fast.sqlite")  # ten episodes, a window of 50
    lines = told(capsys, "curves", "fast.sqlite", "--csv", "--window", "3").splitlines()
    assert lines[:2] == ["entrant,replicate,area,settled", "quick,0,10.0,3.0"]


@pytest.mark.usefixtures("files")
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("curves old.sqlite --window 0", "window must be at least 1, got 0"),
        ("curves old.sqlite --level nan", "level must be a finite number, got nan"),
        ("curves old.sqlite --confidence 1", "confidence must be between 0 and 1, got 1.0"),
        ("curves old.sqlite --json --csv", "--json and --csv must not be given together"),
        ("show old.sqlite --by speed", "Invalid value for '--by'"),
        ("show old.sqlite --confidence 2", "confidence must be between 0 and 1, got 2.0"),
        ("show old.sqlite --confidence nan", "confidence must be a finite number"),
        ("show old.sqlite --csv --json", "--json and --csv must not be given together"),
        ("show other.txt", "other.txt is not a results file of the arena"),
        ("compare", "Missing argument 'FILE'"),
        ("compare old.sqlite", "compare must be given two entrants, or --baseline and none"),
        ("compare old.sqlite a", "compare must be given two entrants, or --baseline and none"),
        ("compare old.sqlite a b --baseline old.sqlite", "compare must be given two entrants, or --baseline"),
        ("compare old.sqlite a --baseline old.sqlite", "compare must be given two entrants, or --baseline"),
        ("compare old.sqlite a c", "entrant must be one of a, b, gone, got 'c'"),
        ("compare old.sqlite a a", "entrants must be two, got 'a' twice"),
        ("compare old.sqlite --baseline none.sqlite", "there is no results file none.sqlite"),
        ("compare few.sqlite --baseline old.sqlite", "With 3 replicates no difference can be shown"),
        ("compare old.sqlite --baseline old.sqlite --max-regression=-1", "--max-regression must be a number"),
        (
            "compare old.sqlite --baseline old.sqlite --max-regression nan",
            "--max-regression must be a number",
        ),
    ],
)
def test_bad_input_is_one_sentence(capsys: pytest.CaptureFixture[str], arguments: str, message: str) -> None:
    assert main(arguments.split()) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert message in printed.err
    assert printed.err.count("\n") == 1
