"""``arena race``: trained cars from one start, in pictures of the PettingZoo environment."""

import base64
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from page_tournament import HOSTILE, hostile_results
from PIL import Image

from agents.optimal import optimal_steps
from arena import Results, load
from arena.cli import main
from arena.figures import race, save_race
from arena.figures.film import GHOST, frames
from envs import Hill
from envs.mountain_car_v0 import parallel_env
from envs.rendering import SIZE


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return hostile_results(tmp_path_factory.mktemp("race") / "race.sqlite")


@pytest.fixture
def results(file: Path) -> Iterator[Results]:
    with load(file) as found:
        yield found


def test_all_drive_as_they_would_alone(results: Results) -> None:
    driven = race(results, ["momentum", HOSTILE], -0.45, 1)
    assert list(driven.actions) == ["momentum", HOSTILE, GHOST]
    for name in ("momentum", HOSTILE):
        path = results.trained(name, 1).drive(-0.45)
        assert len(driven.actions[name]) == len(path) - 1
        assert (name in driven.reached) == (path[-1, 0] >= Hill().goal_position)
    ((fewest,), _) = optimal_steps(Hill(), [-0.45])
    assert driven.captions[GHOST] == f"{GHOST}: {fewest} steps"
    assert driven.steps == max(map(len, driven.actions.values()))


def test_one_that_does_not_arrive_is_told_so(results: Results) -> None:
    driven = race(results, ["random"])
    assert driven.captions["random"] == "random: 200 steps, not there"
    assert driven.reached == {GHOST}


def test_frames_are_the_environment_s_with_the_ghost_half_there(results: Results) -> None:
    driven = race(results, ["momentum"], -0.5)
    pictures = list(frames(driven))
    assert len(pictures) == driven.steps + 1
    names = list(driven.captions.values())
    seen = []
    for cars in (names, names[:1]):
        env = parallel_env(cars, max_steps=200, render_mode="rgb_array")
        env.reset(options={"start": dict.fromkeys(cars, (-0.5, 0.0))})
        for step in range(3):
            told = dict(zip(names, driven.actions.values(), strict=True))
            env.step({car: told[car][step] for car in cars})
        seen.append(np.asarray(env.render(), np.uint8) // 2)
    assert np.array_equal(pictures[3], seen[0] + seen[1])
    assert not np.array_equal(pictures[3], pictures[2])


def test_the_animation_has_a_picture_a_step(results: Results, tmp_path: Path) -> None:
    driven = race(results, ["momentum"], -0.4)
    save_race(driven, tmp_path / "race.gif")
    with Image.open(tmp_path / "race.gif") as image:
        assert image.size == SIZE
        assert getattr(image, "n_frames", 1) == driven.steps + 1
    assert (tmp_path / "race.gif").stat().st_size < 1_000_000


def test_the_page_holds_the_animation_and_names_are_text(results: Results, tmp_path: Path) -> None:
    save_race(race(results, [HOSTILE], -0.4), tmp_path / "race.html")
    page = (tmp_path / "race.html").read_text()
    (animation,) = re.findall(r"data:image/gif;base64,([^\"]*)", page)
    assert base64.b64decode(animation).startswith(b"GIF8")
    assert HOSTILE not in page
    assert "&lt;script&gt;alert(1)&lt;/script&gt;: " in page


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="there is no ffmpeg on the path")
def test_the_film_is_one(results: Results, tmp_path: Path) -> None:
    save_race(race(results, ["momentum"], -0.4), tmp_path / "race.mp4")
    assert b"ftyp" in (tmp_path / "race.mp4").read_bytes()[:16]


def test_the_command_takes_names_with_and_without_the_option(
    file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    told = []
    for names in (["--entrants", "momentum", "sarsa"], ["momentum", "sarsa"]):
        assert main(["race", str(file), *names, "--start", "-0.4", "-o", "race.gif"]) == 0
        told.append(capsys.readouterr())
    assert told[0] == told[1]
    assert [line.split(":")[0] for line in told[0].out.splitlines()] == ["momentum", "sarsa", GHOST]
    assert told[0].err == ""


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["-o", "race.avi"], "suffix of --out must be one of .gif, .html, .mp4, got '.avi'"),
        (["--start", "0.7", "-o", "race.gif"], "start must be in [-1.2, 0.5], got 0.7"),
        (["nobody", "-o", "race.gif"], "entrant must be one of "),
        (["broken", "-o", "race.gif"], "replicate 0 of 'broken' failed"),
        (["sarsa", "sarsa", "-o", "race.gif"], "entrants must be one or more that differ, got sarsa, sarsa"),
    ],
)
def test_bad_input_is_one_sentence(
    file: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], message: str
) -> None:
    assert main(["race", str(file), *arguments]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert message in printed.err
    assert printed.err.count("\n") == 1


def test_without_ffmpeg_a_film_is_refused(
    results: Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shutil, "which", lambda program: None)
    with pytest.raises(ValueError, match=r"--out must be .gif or .html: for .mp4 ffmpeg must be on the path"):
        save_race(race(results, ["momentum"]), tmp_path / "race.mp4")


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere there is a screen")
@pytest.mark.system
def test_without_a_screen_one_line_says_so(file: Path) -> None:
    pytest.importorskip("pygame")
    hidden = {"DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER"}
    environment = {name: value for name, value in os.environ.items() if name not in hidden}
    done = subprocess.run(
        [sys.executable, "-m", "arena", "race", str(file), "momentum"],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=100,
    )
    assert done.returncode == 2
    told = [line for line in done.stderr.splitlines() if line.startswith("arena: ")]  # SDL may say more
    assert len(told) == 1
    assert "cannot open a window: " in told[0]
    assert told[0].endswith("; --out race.gif needs no window")
    assert "Traceback" not in done.stderr
