"""What the cars look like: text, pixels, a window."""

import os
import pickle
import subprocess
import sys
import warnings
from typing import Any

import numpy as np
import pytest

from envs import Hill
from envs.mountain_car_v0 import env, parallel_env
from envs.rendering import SIZE, picture, text

BLUE, VERMILION = (0, 114, 178), (213, 94, 0)


@pytest.fixture
def no_screen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")


def place(image: Any, colour: tuple[int, int, int]) -> tuple[float, float]:
    """Mean column and row of the pixels of a colour, the legend's corner left out."""
    rows, columns = np.nonzero((image == colour).all(axis=2))
    drawn = (columns > 150) | (rows > 100)
    return float(columns[drawn].mean()), float(rows[drawn].mean())


def test_each_car_is_drawn_in_its_colour_at_its_place_on_the_hill() -> None:
    hill = Hill()
    image = picture(hill, {"a": (-0.5, 0.0), "b": (0.4, 0.01)}, 7)
    assert image.shape == (SIZE[1], SIZE[0], 3)
    assert image.dtype == np.uint8
    (left, low), (right, high) = place(image, BLUE), place(image, VERMILION)
    pixels = SIZE[0] / (hill.max_position - hill.min_position)
    assert left == pytest.approx((-0.5 - hill.min_position) * pixels, abs=3)
    assert right == pytest.approx((0.4 - hill.min_position) * pixels, abs=8)  # leans on the slope
    assert low > high + 100  # rows count downwards
    moved = picture(hill, {"a": (-1.1, 0.0), "b": (0.4, 0.01)}, 7)
    assert place(moved, BLUE)[0] < left - 100
    assert place(moved, VERMILION) == (right, high)


def test_pictures_do_not_depend_on_those_before() -> None:
    cars = {f"car_{number}": (-0.9 + 0.1 * number, 0.0) for number in range(15)}
    first = picture(Hill(), cars, 3)
    first[:] = 0
    assert picture(Hill(), cars, 3).any()
    assert (picture(Hill(omega=2.0), cars, 3) != picture(Hill(), cars, 3)).any()
    assert (picture(Hill(), cars, 4) != picture(Hill(), cars, 3)).any()  # the steps are told


def test_text_is_a_line_a_car() -> None:
    assert text({"a": (-0.5, 0.0), "long": (0.4, -0.0123)}, 7).splitlines() == [
        "step 7",
        "a     position -0.5000  velocity +0.00000",
        "long  position +0.4000  velocity -0.01230",
    ]


def test_the_environment_renders_what_it_is_asked_for() -> None:
    start = {"car_0": (-0.5, 0.0), "car_1": (0.45, 0.06)}
    told = parallel_env(2, render_mode="ansi")
    told.reset(seed=1, options={"start": start})
    told.step({"car_0": 1, "car_1": 2})
    assert told.agents == ["car_0"]  # the other one is at the goal
    lines = str(told.render()).splitlines()
    assert lines[0] == "step 1"
    assert lines[2].startswith("car_1  position +0.5")
    shown = parallel_env(2, render_mode="rgb_array")
    shown.reset(seed=1, options={"start": start})
    expected = picture(Hill(), start, 0)
    assert np.array_equal(np.asarray(shown.render()), expected)
    assert parallel_env.metadata["render_modes"] == ["human", "rgb_array", "ansi"]
    assert parallel_env.metadata["render_fps"] > 0


def test_without_a_render_mode_it_says_so() -> None:
    cars = parallel_env(1)
    cars.reset(seed=1)
    with pytest.warns(UserWarning, match="render is called without a render_mode"):
        assert cars.render() is None


@pytest.mark.usefixtures("no_screen")
def test_a_window_follows_every_step_and_copies_open_their_own(monkeypatch: pytest.MonkeyPatch) -> None:
    pygame = pytest.importorskip("pygame")
    cars = parallel_env(1, render_mode="human")
    cars.reset(seed=1)
    blits = []
    flip = pygame.display.flip

    def counted() -> None:
        blits.append(1)
        flip()

    monkeypatch.setattr(pygame.display, "flip", counted)
    for _ in range(3):
        cars.step({"car_0": 2})
    assert len(blits) == 3
    shown = pygame.surfarray.array3d(pygame.display.get_surface()).swapaxes(0, 1)
    assert (shown == picture(cars.hill, {"car_0": tuple(cars.state())}, 3)).all()
    copied = pickle.loads(pickle.dumps(cars))  # noqa: S301
    observations = [one.step({"car_0": 0})[0]["car_0"].tolist() for one in (cars, copied)]
    assert observations[0] == observations[1]
    for one in (cars, copied):
        one.close()
        one.close()
    assert not pygame.display.get_init()


def test_where_there_is_no_screen_one_line_says_so() -> None:
    pytest.importorskip("pygame")
    code = (
        "from envs.mountain_car_v0 import parallel_env\n"
        "try:\n    parallel_env(1, render_mode='human').reset(seed=1)\n"
        "except RuntimeError as error:\n    print(error)"
    )
    environment = {**os.environ, "SDL_VIDEODRIVER": "none-such"}
    told = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True, timeout=60
    ).stdout
    assert told.startswith('render_mode "human" cannot open a window: ')
    assert told.count("\n") == 1


def test_without_pygame_one_line_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    from gymnasium.error import DependencyNotInstalled

    monkeypatch.setitem(sys.modules, "pygame", None)
    with pytest.raises(DependencyNotInstalled, match=r'^render_mode "human" needs pygame: '):
        parallel_env(1, render_mode="human").reset(seed=1)


def test_state_is_that_of_all_cars_the_ended_ones_included() -> None:
    cars = parallel_env(["b", "a"])
    with pytest.raises(ValueError, match=r"^state is there after the first reset"):
        cars.state()
    cars.reset(seed=3, options={"start": {"b": (0.49, 0.06)}})
    cars.step({"a": 0, "b": 2})
    assert cars.agents == ["a"]
    state = cars.state()
    assert cars.state_space.contains(state)
    at_the_goal, _, _ = Hill().step((0.49, 0.06), 2)
    assert state[:2].tolist() == list(at_the_goal)
    assert -0.7 < state[2] < -0.3
    assert cars.state_space.shape == (4,)


@pytest.mark.usefixtures("no_screen")
def test_passes_pettingzoo_s_render_and_state_tests() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of PettingZoo's own games
        from pettingzoo.test import render_test, state_test
    render_test(lambda render_mode: env(cars=2, render_mode=render_mode))
    state_test(env(cars=2), parallel_env(2))
