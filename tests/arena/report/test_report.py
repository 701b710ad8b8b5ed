"""``arena report`` and the page that ``arena run`` leaves: what is in the file. ``test_page.py`` opens it."""

import json
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from made_up_results import made_up
from page_tournament import HOSTILE, hostile_results

from agents.optimal import optimal_steps
from arena import load
from arena.analysis import leaderboard, moving_average
from arena.cli import main
from arena.report.page import report
from arena.results import digest
from envs import Hill


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return hostile_results(tmp_path_factory.mktemp("report") / "race.sqlite")


@pytest.fixture(scope="module")
def page(file: Path) -> str:
    with load(file) as results:
        return report(results)


class Told(HTMLParser):
    """The texts of a page, the rows of its tables, and its elements."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.text, self._in_cell = "", False
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.rows: list[list[str]] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attributes)))
        if tag == "tr":
            self.rows.append([])
        if tag in {"td", "th"}:
            self.rows[-1].append("")
            self._in_cell = True

    def handle_endtag(self, tag: str) -> None:
        self._in_cell &= tag not in {"td", "th"}

    def handle_data(self, text: str) -> None:
        self.text += text
        if self._in_cell:
            self.rows[-1][-1] += text.strip()


def data_of(page: str) -> Any:
    """What the script reads."""
    found = re.search(r'<script id="data" type="application/json">(.*?)</script>', page, re.DOTALL)
    assert found is not None
    return json.loads(found[1])


def test_the_page_needs_no_network(page: str) -> None:
    elements = Told(page).elements
    for tag, attributes in elements:
        for name in ("src", "href", "action", "srcset"):
            assert str(attributes.get(name, "#")).startswith(("#", "data:,")), (tag, attributes)
    (policy,) = [
        one["content"] for tag, one in elements if one.get("http-equiv") == "Content-Security-Policy"
    ]
    assert str(policy).startswith("default-src 'none';")
    assert not re.search(r"https?://|@import|url\(|fetch\(|XMLHttpRequest", page.replace("data:,", ""))


def test_names_are_text(page: str) -> None:
    told = Told(page)
    assert sum(tag == "script" for tag, _ in told.elements) == 2
    assert not any(tag in {"img", "b"} for tag, _ in told.elements)
    assert HOSTILE in [row[1] for row in told.rows if len(row) > 1]
    assert HOSTILE in data_of(page)["names"]


def test_the_leaderboard_is_that_of_arena_show(file: Path, page: str) -> None:
    with load(file) as results:
        standings = leaderboard(results).standings
    rows = [row for row in Told(page).rows if len(row) == 8][1:]
    assert [row[1] for row in rows] == [one.entrant for one in standings]
    for row, one in zip(rows, standings, strict=True):
        assert row[0] == (f"{one.place}" if one.place == one.last_place else f"{one.place}-{one.last_place}")
        steps = one.scores["steps"]
        assert row[3] == f"{steps.value:,.1f} [{steps.low:,.1f}, {steps.high:,.1f}]"
        assert row[7] == str(one.failed)
    data = data_of(page)
    for i, one in enumerate(standings):
        tied = [data["names"][j] for j in range(len(standings)) if j != i and data["apart"][i][j] == "0"]
        assert tied == list(one.tied)
    assert data["better"][0][0] == 50


def test_curves_maps_and_drives_are_those_of_the_runs(file: Path, page: str) -> None:
    data = data_of(page)
    drawn = {data["names"][one["entrant"]]: one for one in data["drawn"]}
    with load(file) as results:
        curves = [-moving_average(results.arrays("sarsa", r)["lengths"]) for r in (0, 1)]
        assert data["at"] == list(range(50, 56))
        assert drawn["sarsa"]["curve"]["mean"] == np.rint(np.mean(curves, axis=0)).tolist()
        assert drawn["sarsa"]["curve"]["low"] == np.min(curves, axis=0).round().tolist()
        arrays = results.arrays("sarsa", 0)
        told = drawn["sarsa"]["map"]
        assert told["visits"] == arrays["visits"].ravel().tolist()
        assert told["policy"] == "".join(map(str, arrays["values"].argmax(axis=1)))
        agent = results.trained("sarsa")
        for start, drive in zip(data["starts"], drawn["sarsa"]["drives"], strict=True):
            assert drive == np.rint(1000 * agent.drive(start)[:, 0]).tolist()
    assert drawn["random"]["map"]["policy"] is None
    assert drawn["momentum"]["map"]["visits"] is None
    fewest, _ = optimal_steps(Hill(), data["starts"])
    assert [len(ghost) - 1 for ghost in data["ghost"]] == fewest.tolist()
    assert drawn["broken"]["drives"] is None


def test_failures_and_how_to_reproduce_are_told(file: Path, page: str) -> None:
    text = " ".join(Told(page).text.split())
    assert "broken, replicate 1: RuntimeError: <b>ouch</b>" in text
    with load(file) as results:
        assert digest(results) in text
        assert all(version in text for version in results.versions.values())
    assert "Beside the paper" not in text


def test_the_paper_has_its_tables(tmp_path: Path) -> None:
    with made_up({"a": [100.0, 110.0]}, name="paper") as results:
        text = Told(report(results)).text
    assert "Tables 1 and 2" in text
    assert "Claim by claim" not in text  # not the whole tournament
    assert "140.99" in text


def test_unfinished_and_failed_tournaments_have_pages() -> None:
    tournaments: list[dict[str, list[float | None]]] = [
        {"a": [None, None], "b": [None, None]},
        {"a": [100.0], "b": []},
        {"a": []},
    ]
    for steps in tournaments:
        with made_up(steps, replicates=2) as results:
            data_of(report(results))


def test_the_first_have_curves_and_all_have_places() -> None:
    with made_up({name: [100.0 + k] for k, name in enumerate("abcd")}) as results:
        page = report(results, most_drawn=2)
    assert len(data_of(page)["drawn"]) == 2
    assert len(data_of(page)["names"]) == 4
    assert "of the first 2 by place" in Told(page).text


def test_the_command_writes_the_page(
    file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["report", str(file), "-o", "page.html", "--by", "accuracy"]) == 0
    assert capsys.readouterr().out == "page.html\n"
    assert "percent of the test drives" in Path("page.html").read_text()
    assert main(["report", str(file)]) == 0
    assert file.with_name("race.html").exists()
    for arguments, message in (
        (["none.sqlite"], "there is no results file none.sqlite"),
        ([str(file), "--confidence", "2"], "confidence must be between 0 and 1, got 2.0"),
        ([str(file), "-o", "no/such/page.html"], "No such file or directory"),
    ):
        capsys.readouterr()
        assert main(["report", *arguments]) == 2
        assert message in capsys.readouterr().err


def test_a_run_leaves_a_page_unless_it_is_told_not_to(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("t.toml").write_text(
        "replicates = 1\n[training]\nepisodes = 2\nmax_steps = 9\n[evaluation]\nepisodes = 1\nmax_steps = 9\n"
        '[[entrants]]\nagent = "momentum"\n'
    )
    run = ["run", "t.toml", "--jobs", "1", "--driver", "pettingzoo"]
    assert main([*run, "--no-report"]) == 0
    without = capsys.readouterr()
    assert not Path("runs/t.html").exists()
    assert main(run) == 0
    assert capsys.readouterr() == (without.out, "arena: keeps 1 run, runs 0\n")
    assert "Tournament t" in Path("runs/t.html").read_text()
