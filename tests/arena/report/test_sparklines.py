"""What ``arena show`` draws in a terminal."""

import re
from pathlib import Path

import numpy as np
import pytest
from made_up_results import made_up
from page_tournament import HOSTILE, hostile_results

from arena import load
from arena.cli import main
from arena.report.sparklines import LEVELS, blocks, sparkline


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return hostile_results(tmp_path_factory.mktemp("show") / "race.sqlite")


def test_a_sparkline_is_on_its_scale() -> None:
    assert sparkline(range(8), 0, 8) == LEVELS
    assert sparkline([0.0, 4.0], 0, 8) == "▁▅"
    assert sparkline([3.0, 3.0], 3, 3) == "▁▁"
    assert sparkline([8.0], 0, 8) == "█"
    assert sparkline([0.0, 0.0, 8.0, 8.0], 0, 8, width=2) == "▁█"


def test_a_terminal_shows_curves_and_the_best_policy(
    file: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert main(["show", str(file)]) == 0
    plain = capsys.readouterr().out
    assert not set(plain) & set(LEVELS)
    monkeypatch.setenv("FORCE_COLOR", "1")  # rich takes this for a terminal
    assert main(["show", str(file)]) == 0
    shown = re.sub(r"\x1b\[[\d;]*m", "", capsys.readouterr().out)
    assert "Learning: accumulated reward by episode, from -60 to " in shown
    assert re.search(r"^sarsa +[▁▂▃▄▅▆▇█]{6}$", shown, re.MULTILINE)
    assert HOSTILE in shown
    assert shown.count("▀" * 54) == 12
    assert main(["show", str(file), "--json"]) == 0
    assert not set(capsys.readouterr().out) & set(LEVELS)


def test_the_blocks_are_the_policy(file: Path) -> None:
    with load(file) as results:
        _, *momentum = blocks(results.trained("momentum"))
        agent = results.trained("sarsa")
        best = results.arrays("sarsa")["values"].argmax(axis=1).reshape(6, 7)
    _, *lines = blocks(agent)
    top = {2: "#E69F00", 1: "#F7F7F7", 0: "#0072B2"}
    for column in (0, 30, 53):
        assert str(lines[0].spans[column].style).split(" on ")[0] == top[best[column * 6 // 54, -1]]
        assert str(lines[-1].spans[column].style).split(" on ")[1] == top[best[column * 6 // 54, 0]]
    assert {str(momentum[k].spans[0].style) for k in (0, 5)} == {f"{top[2]} on {top[2]}"}
    assert {str(momentum[k].spans[0].style) for k in (6, 11)} == {f"{top[0]} on {top[0]}"}
    assert len({tuple(str(span.style) for span in line.spans) for line in lines}) > 1
    assert np.unique(best).size > 1


def test_nothing_is_shown_of_what_has_no_curve(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    made_up({"a": [None]}, tmp_path / "failed.sqlite").close()
    assert main(["show", str(tmp_path / "failed.sqlite")]) == 0
    assert "Learning" not in capsys.readouterr().out
