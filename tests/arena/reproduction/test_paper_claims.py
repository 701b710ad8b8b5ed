"""The verdicts on the paper's claims."""

import dataclasses
import json
import math
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from paths import ROOT

from arena import Evaluation, RandomWalk, Results, Training, paper, random_walk, run
from arena.cli import main
from arena.common.npz import pack
from arena.reproduction import Claim, iterations_spread, published
from arena.reproduction import claims as paper_claims
from arena.reproduction.verdicts import holds_claim, measured_claim, number_claim, untestable_claim
from arena.results.store import Store
from arena.tournament.outcome import Outcome, Status

FALLING = np.concatenate([np.linspace(2000, 150, 2000), np.full(2000, 150.0)]).astype(np.int64)
Change = Callable[[str, int], dict[str, Any]]


def of_the_paper(replicates: int = 11, change: Change = lambda _name, _replicate: {}) -> Results:
    """A tournament in which every replicate is the paper's tables, but for a little noise around them."""
    tournament = paper(replicates)
    store = Store.create(None, tournament.to_dict())
    for (algorithm, n_p, n_v), (accuracy, length, iterations) in published().items():
        name = f"{algorithm} {n_p}x{n_v}"
        for replicate in range(replicates):
            noise = replicate - (replicates - 1) / 2
            scores: dict[str, Any] = {
                "accuracy": accuracy,
                "mean_length": length + 0.01 * noise,
                "iterations": int(iterations + noise),
                **change(name, replicate),
            }
            arrays = pack({"lengths": FALLING})
            store.add(Outcome(name, replicate, "compiled", Status.FINISHED, **scores, arrays=arrays))
    store.release()
    return Results(store)


def series(lengths: list[int]) -> RandomWalk:
    """A short walk that is said to have had other lengths."""
    walked = random_walk(2, max_steps=10, n_jobs=1)
    return dataclasses.replace(walked, lengths=np.array(lengths), velocity=(-0.06, 0.06))


WALKS = [series([1000, 20_000, 100_000]), series([500, 40_000, 50_000])]


def verdicts(results: Results) -> dict[tuple[str, str], Claim]:
    with results:
        claims = paper_claims.paper_claims(results, WALKS)
    found = {(claim.section, claim.statement): claim for claim in claims}
    assert len(found) == len(claims)
    return found


def test_a_number_is_reproduced_if_it_is_among_the_central_95_percent() -> None:
    sample = np.arange(101.0)
    inside, outside = (number_claim("1", "it", paper, sample) for paper in (3.0, 98.0))
    assert (inside.ours, inside.low, inside.high) == (50.0, 2.5, 97.5)
    assert (inside.verdict, outside.verdict) == ("reproduced", "not reproduced")
    assert inside.percentile == pytest.approx(100.0 * 3.5 / 101.0)  # three below, one equal
    known = number_claim("1", "it", 2.0, [1.0, math.nan, 3.0])
    assert (known.ours, known.percentile) == (2.0, 50.0)


def test_what_holds_holds_in_95_percent_of_the_replicates() -> None:
    always, often = (holds_claim("1", "it", [True] * n + [False] * (20 - n)) for n in (19, 18))
    assert (always.ours, always.verdict) == (95.0, "reproduced")
    assert (often.ours, often.verdict) == (90.0, "not reproduced")


def test_what_is_tested_elsewhere_or_not_at_all() -> None:
    tested = measured_claim("1", "it", 1.0, [1.0, 3.0], reproduced=False, note="a test")
    assert (tested.ours, tested.verdict, tested.note) == (2.0, "not reproduced", "a test")
    unknown = untestable_claim("1", "it", 5.0, [], "no machine")
    assert unknown.verdict == "not testable"
    assert json.loads(json.dumps(unknown.to_dict(), allow_nan=False))["ours"] is None


def test_the_paper_s_own_tables_reproduce_its_claims() -> None:
    found = verdicts(of_the_paper())
    cells = [claim for (section, _), claim in found.items() if section.startswith("Table")]
    assert len(cells) == 3 * 32 + 3
    assert {claim.verdict for claim in cells} == {"reproduced"}
    whole = [claim for claim in cells if "chi-square" in claim.statement]
    assert [claim.paper for claim in whole] == pytest.approx([0.0, 0.0], abs=1e-6)
    assert max(claim.percentile for claim in whole) < 5.0  # of the replicates the middle one is as near
    assert {claim.percentile for claim in cells if "iterations of" in claim.statement} == {50.0}
    told = {statement: claim for (section, statement), claim in found.items() if section == "4.3"}
    for count in ("above 73%", "below 80%", "below 90%", "above 95%", "of 100%"):
        (claim,) = (one for statement, one in told.items() if count in statement)
        assert (claim.verdict, claim.ours) == ("reproduced", claim.paper)
    assert told["sarsa 20x30 has the shortest mean length"].ours == 100.0
    assert told["cells below 80%"].note == "the paper's: q-learning 40x10, sarsa 20x40, sarsa 40x10"
    text, tables = (claim for statement, claim in told.items() if "fewest iterations" in statement)
    assert (text.ours, text.verdict) == (0.0, "not reproduced")
    assert (tables.ours, tables.verdict) == (100.0, "reproduced")
    for name, paper_s, ours in (
        ("iterations, Q-learning and SARSA", 0.983, 0.983),
        ("accuracy, Q-learning and SARSA", 0.686, 0.686),
        ("lengths, Q-learning and SARSA", 0.038, 0.056),
        ("iterations and accuracy in Q-learning", -0.46, -0.46),
        ("iterations and accuracy in SARSA", -0.33, -0.33),
    ):
        claim = told[f"correlation of {name}"]
        assert claim.paper == paper_s
        assert claim.ours == pytest.approx(ours, abs=0.005)
    assert told["correlation of lengths, Q-learning and SARSA"].note == "the paper's Table 1 gives 0.056"
    neighbours = [claim for statement, claim in told.items() if "drives shorter than" in statement]
    assert len(neighbours) == 4
    assert {claim.verdict for claim in neighbours} == {"reproduced"}
    assert [claim.ours for claim in neighbours] == pytest.approx([claim.paper for claim in neighbours])
    figure = [claim.verdict for (section, _), claim in found.items() if section == "Figure 4"]
    assert figure == ["reproduced", "reproduced", "not testable"]


def test_a_cell_that_is_far_off_is_not_reproduced() -> None:
    def change(name: str, _replicate: int) -> dict[str, Any]:
        return {"iterations": 900_000} if name == "sarsa 10x20" else {}

    before, after = verdicts(of_the_paper()), verdicts(of_the_paper(change=change))
    claim = after["Table 2", "iterations of sarsa 10x20"]
    assert (claim.verdict, claim.percentile, claim.paper) == ("not reproduced", 100.0, 1_182_048)
    changed = {key for key in before if before[key].verdict != after[key].verdict}
    assert ("Table 2", "iterations of sarsa 10x20") in changed
    assert not any("Table 1" in section for section, _ in changed)


def test_algorithms_that_differ_always_differ_beyond_chance() -> None:
    def slower(name: str, replicate: int) -> dict[str, Any]:
        return {"mean_length": 150.0 + replicate + (5.0 if name.startswith("sarsa") else 0.0)}

    def alike(name: str, replicate: int) -> dict[str, Any]:
        sign = (-1) ** replicate if name.startswith("sarsa") else 0
        return {"mean_length": 150.0 + sign * (1.0 + replicate)}

    statement = ("4.3", "no significant difference in mean length")
    different, same = (verdicts(of_the_paper(change=change))[statement] for change in (slower, alike))
    assert different.verdict == "not reproduced"
    assert different.ours == pytest.approx(5.0)
    assert same.verdict == "reproduced"
    assert "p = 0.00098" in different.note  # 2 of 2^11 flips
    neighbours = verdicts(of_the_paper(change=alike))
    assert neighbours["4.3", "sarsa 20x30 drives shorter than sarsa 20x40"].verdict == "not reproduced"


def test_a_length_that_no_drive_has_is_left_out() -> None:
    def change(name: str, replicate: int) -> dict[str, Any]:
        return {"mean_length": math.nan, "accuracy": 0.0} if (name, replicate) == ("sarsa 20x30", 0) else {}

    found = verdicts(of_the_paper(change=change))
    assert found["Table 1", "mean length of sarsa 20x30"].verdict == "reproduced"
    assert found["4.3", "sarsa 20x30 has the shortest mean length"].ours == pytest.approx(1000.0 / 11.0)


def test_the_distance_of_each_replicate_from_the_mean_of_the_others() -> None:
    iterations = np.array([[90.0, 110.0, 100.0], [200.0, 200.0, 200.0]])
    by_hand = [90.0 / 105.0 - 1.0, 110.0 / 95.0 - 1.0, 0.0]
    expected = [100.0 * abs(one) / math.sqrt(2.0) for one in by_hand]
    assert iterations_spread(iterations) == pytest.approx(expected)


def test_walks_are_compared_series_by_series() -> None:
    found = verdicts(of_the_paper())
    assert found["3.2", "mean length"].ours == pytest.approx((121_000 / 3 + 90_500 / 3) / 2)
    assert found["3.2", "greatest velocity"].verdict == "not reproduced"
    share = found["3.2", "more than 50% of the walks take less than 30,000 steps"]
    assert share.ours == pytest.approx(50.0)  # two of three, one of three
    assert share.verdict == "reproduced"


@pytest.fixture(scope="module")
def short_paper(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The results file of a short tournament of the paper."""
    short = dataclasses.replace(
        paper(2), training=Training(60, 300), evaluation=Evaluation(3, 100), time_limit=None
    )
    path = tmp_path_factory.mktemp("paper") / "paper.sqlite"
    run(short, path, n_jobs=2).close()
    return path


@pytest.fixture
def file(short_paper: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """That file in the current folder, and short series of walks."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(paper_claims, "WALKS", 10)
    return Path(shutil.copy(short_paper, tmp_path))


def test_the_command_prints_a_verdict_on_each_and_writes_the_page(
    file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["paper", file.name, "--walks", "2", "--jobs", "1"]
    assert main([*command, "--json"]) == 0
    claims = json.loads(capsys.readouterr().out)
    assert {claim["verdict"] for claim in claims} == {"reproduced", "not reproduced", "not testable"}
    assert main([*command, "--markdown", "paper.md"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert f"\n{len(claims)} claims: " in out
    assert main(["digest", file.name]) == 0
    digest = capsys.readouterr().out.strip()
    page = Path("paper.md").read_text(encoding="utf-8")
    assert f"`{digest}`" in page
    rows = [line for line in page.splitlines() if line.startswith("| ")][1:]
    assert [row.split(" | ")[-1] for row in rows] == [f"{claim['verdict']} |" for claim in claims]


def test_the_page_of_the_docs_has_the_claims_of_the_program(file: Path) -> None:
    page = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8").partition("\n## ")[0]
    assert main(["paper", file.name, "--walks", "2", "--jobs", "1", "--markdown", "now.md"]) == 0

    def statements(text: str) -> list[str]:
        rows = re.findall(r"^\| (.*?) \| (.*?) \| .* \|$", text, re.MULTILINE)
        return [f"{section}: {claim.partition(' (')[0]}" for section, claim in rows]

    assert statements(Path("now.md").read_text(encoding="utf-8")) == statements(page)
    assert "100 replicates" in page


@pytest.mark.usefixtures("file")
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["paper.sqlite", "--walks", "1"], "--walks must be at least 2, got 1"),
        (["other.sqlite"], "there is no results file other.sqlite"),
        (["quick.sqlite"], "results must be those of the tournament paper, all runs finished, got <Results"),
        (["one.sqlite"], "results must have 2 replicates or more, got 1"),
    ],
)
def test_bad_input_is_told_in_one_line(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    short: dict[str, Any] = {"training": Training(2, 50), "evaluation": Evaluation(2, 50)}
    if arguments[0] == "quick.sqlite":
        run(dataclasses.replace(paper(2), name="mine", **short), "quick.sqlite", n_jobs=1).close()
    if arguments[0] == "one.sqlite":
        run(dataclasses.replace(paper(1), **short), "one.sqlite", n_jobs=1).close()
    assert main(["paper", *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert message in err
