"""The command ``arena cache``."""

import json
import os
import time
from pathlib import Path

import pytest

from arena.cli import main

MARK = "0123456789abcdef" * 2


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache with two kernels, one used long ago, a folder of 0.1 as old, and a stranger's file."""
    folder = tmp_path / "kernels"
    monkeypatch.setenv("ARENA_CACHE_DIR", str(folder))
    (folder / MARK / "loops").mkdir(parents=True)
    for name, size in (
        (f"{MARK}.cafe.nbc", 1_000_000),
        (f"{MARK}.beef.nbc", 600_000),
        (f"{MARK}/loops/train.nbc", 200_000),
        ("letter.txt", 9),
    ):
        (folder / name).write_bytes(bytes(size))
    for name in (f"{MARK}.beef.nbc", MARK, "letter.txt"):
        os.utime(folder / name, (time.time() - 40 * 86400,) * 2)
    return folder


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def test_it_shows_the_folder_the_number_of_kernels_and_their_size(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = names(folder)
    assert main(["cache"]) == 0
    assert capsys.readouterr().out.splitlines() == [
        f"{folder}: 3 kernels, 1.8 MB",
        "of these not used for 30 days: 2 kernels, 0.8 MB",
    ]
    assert main(["cache", "--json", "--days", "50"]) == 0
    shown = json.loads(capsys.readouterr().out)
    assert shown["folder"] == str(folder)
    assert (shown["kernels"], shown["bytes"]) == (3, 1_800_000)
    assert (shown["unused"], shown["unused_bytes"], shown["days"]) == (0, 0, 50)
    assert names(folder) == before


def test_prune_removes_what_has_not_been_used_and_nothing_that_is_not_ours(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["cache", "--prune", "--days", "50"]) == 0
    assert len(names(folder)) == 4
    capsys.readouterr()
    assert main(["cache", "--prune"]) == 0
    assert capsys.readouterr().out.splitlines() == [
        f"{folder}: 1 kernel, 1.0 MB",
        "removed, as not used for 30 days: 2 kernels, 0.8 MB",
    ]
    assert names(folder) == {f"{MARK}.cafe.nbc", "letter.txt"}
    assert main(["cache", "--prune", "--days", "0"]) == 0
    assert names(folder) == {"letter.txt"}


def test_a_folder_that_is_not_there_is_empty_and_is_not_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    nowhere = tmp_path / "nowhere"
    monkeypatch.setenv("ARENA_CACHE_DIR", str(nowhere))
    assert main(["cache", "--prune"]) == 0
    assert capsys.readouterr().out.startswith(f"{nowhere}: 0 kernels, 0.0 MB\n")
    assert not nowhere.exists()


def test_bad_input_is_told_in_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("ARENA_CACHE_DIR", str(tmp_path / "file"))
    assert main(["cache", "--days", "-1"]) == 2
    (tmp_path / "file").write_text("")
    assert main(["cache"]) == 2
    first, second = capsys.readouterr().err.splitlines()
    assert "--days" in first
    assert str(tmp_path / "file") in second
