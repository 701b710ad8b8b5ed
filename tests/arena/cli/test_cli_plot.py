"""``arena plot``, as users run it."""

import re
from pathlib import Path

import pytest
from made_up_results import made_up
from paths import ROOT
from PIL import Image

from agents import MomentumAgent, RandomAgent, Sarsa
from arena import Entrant, Evaluation, Tournament, Training, run
from arena.cli import main
from arena.cli.plot import Kind


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """With race.sqlite, and failed.sqlite in which no run has finished."""
    path = tmp_path_factory.mktemp("plots")
    entrants = (
        Entrant("sarsa", Sarsa, bins=(5, 6)),
        Entrant("finer", Sarsa, bins=(6, 6)),
        Entrant("momentum", MomentumAgent),
        Entrant("random", RandomAgent),
    )
    tournament = Tournament(
        entrants, training=Training(50, 40), evaluation=Evaluation(3, 200), replicates=2, name="race"
    )
    run(tournament, path / "race.sqlite", n_jobs=1, driver="pettingzoo").close()
    made_up({"a": [None, None]}, path / "failed.sqlite").close()
    return path


@pytest.fixture(autouse=True)
def _here(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)


@pytest.mark.parametrize("kind", list(Kind))
def test_every_kind_is_drawn(capsys: pytest.CaptureFixture[str], kind: Kind) -> None:
    one = kind in {Kind.POLICY, Kind.VISITS, Kind.VALUE, Kind.PHASE}
    named = ["--entrant", "sarsa"] if one else []
    assert main(["plot", "race.sqlite", kind.value, *named]) == 0
    printed = capsys.readouterr()
    assert (printed.out, printed.err) == (f"{kind.value}.png\n", "")
    with Image.open(f"{kind.value}.png") as image:
        assert min(image.size) > 300
        assert len(image.convert("RGB").getcolors(1 << 24) or []) > 20


@pytest.mark.parametrize(("suffix", "begins"), [("svg", b"<?xml"), ("pdf", b"%PDF"), ("PNG", b"\x89PNG")])
def test_the_suffix_says_which_format(suffix: str, begins: bytes) -> None:
    assert main(["plot", "race.sqlite", "learning", "-o", f"figure.{suffix}"]) == 0
    assert Path(f"figure.{suffix}").read_bytes().startswith(begins)


def test_the_size_is_chosen() -> None:
    sizes = []
    for dpi in ("50", "100"):
        assert main(["plot", "race.sqlite", "sweep", "--dpi", dpi, "-o", "sized.png"]) == 0
        with Image.open("sized.png") as image:
            sizes.append(image.width)
    assert sizes == [600, 1200]


def test_the_gallery_shows_every_kind_and_the_command_that_makes_it() -> None:
    text = (ROOT / "docs" / "gallery.md").read_text()
    shown = re.findall(
        r"^!\[.*\]\((.*)\)\n\n```console\n\$ arena (plot|race) .* -o docs/(.*)$", text, re.MULTILINE
    )
    assert all(picture == made for picture, _, made in shown)
    kinds = re.findall(r"^\$ arena plot \S+ (\w+) ", text, re.MULTILINE)
    assert sorted(kinds) == sorted(Kind)
    assert len(shown) == len(kinds) + 1  # and the race


def test_entrants_and_replicates_are_chosen() -> None:
    drawn = set()
    for options in ([], ["--entrant", "sarsa"], ["--entrant", "sarsa", "--replicate", "1"]):
        assert main(["plot", "race.sqlite", "policy", *options]) == 0
        drawn.add(Path("policy.png").read_bytes())
    assert len(drawn) == 3


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("race.sqlite hills", "Invalid value for '"),
        ("race.sqlite policy -o figure.gif", "suffix of --out must be one of .pdf, .png, .svg, got '.gif'"),
        (
            "race.sqlite policy --entrant nobody",
            "entrant must be one of finer, momentum, random, sarsa, got 'n",
        ),
        ("race.sqlite policy --entrant sarsa --replicate 2", "replicate must be one that 'sarsa' has run"),
        ("race.sqlite policy --entrant sarsa --replicate -1", "replicate must be at least 0, got -1"),
        ("race.sqlite policy --entrant random", "'random' drives by chance: it has no policy to draw"),
        ("race.sqlite visits --entrant momentum", "'momentum' counts no visits of the cells of a grid"),
        ("race.sqlite value --entrant momentum", "'momentum' has no values of actions to draw"),
        ("race.sqlite phase --entrant sarsa --entrant random", "--entrant must be given once for a picture"),
        ("race.sqlite pairs --entrant sarsa", "--entrant must be left out of a picture of all entrants"),
        ("race.sqlite learning --entrant nobody", "entrant must be one of finer, momentum, random, sarsa"),
        ("race.sqlite regret --replicate 7", "replicate must be one that"),
        ("race.sqlite sweep --dpi 19", "--dpi must be at least 20, got 19"),
        ("failed.sqlite learning", "no run has finished: there is nothing to draw"),
        ("failed.sqlite policy --entrant a", "replicate 0 of 'a' failed: there is nothing to draw"),
        ("failed.sqlite learning --entrant a", "'a' has no finished run: there is no learning curve"),
        ("race.sqlite learning -o no/such/folder.png", "No such file or directory"),
        ("none.sqlite policy", "there is no results file none.sqlite"),
    ],
)
def test_bad_input_is_one_sentence(capsys: pytest.CaptureFixture[str], arguments: str, message: str) -> None:
    assert main(["plot", *arguments.split()]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert message in printed.err
    assert printed.err.count("\n") == 1
