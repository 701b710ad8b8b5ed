"""What a notebook shows: every object by its ``_repr_html_``, as notebooks ask for it."""

from collections.abc import Iterator
from html import escape
from typing import Any
from xml.etree import ElementTree as ET

import pytest
from page_tournament import HOSTILE, hostile_results

from arena import Results, load, quick
from arena.analysis import leaderboard


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Results]:
    with load(hostile_results(tmp_path_factory.mktemp("notebook") / "race.sqlite")) as found:
        yield found


def cells(shown: Any) -> list[list[str]]:
    """The rows of a table that is well-formed."""
    table = ET.fromstring(shown._repr_html_())  # noqa: S314 (our own)
    return [["".join(cell.itertext()) for cell in row] for row in table.iter("tr")]


def test_results_are_their_leaderboard(results: Results) -> None:
    head, *rows = cells(results)
    assert head == ["place", "entrant", "steps", "accuracy", "length", "iterations"]
    standings = leaderboard(results).standings
    assert [row[:2] for row in rows] == [["1-6", one.entrant] for one in standings]
    assert [row[2] for row in rows] == [f"{one.scores['steps'].value:,.1f}" for one in standings]
    assert escape(HOSTILE) in results._repr_html_()


def test_a_tournament_is_its_entrants() -> None:
    head, first, *_ = cells(quick())
    assert head == ["entrant", "agent", "parameters given"]
    assert first == ["q-learning", "QLearning", "bins=(20, 20), step_size=HarmonicRate(A=1.0, B=5.0, C=0.0)"]


def test_a_trained_agent_is_its_policy(results: Results) -> None:
    drawing = ET.fromstring(results.trained("sarsa")._repr_html_())  # noqa: S314 (our own)
    assert drawing.tag.endswith("svg")
    assert "drives by chance" in results.trained("random")._repr_html_()
    with_name = results.trained(HOSTILE)._repr_html_()
    assert "<script" not in with_name
