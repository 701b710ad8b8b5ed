"""Trained cars on one hill from the same start, in pictures of the PettingZoo environment."""

import base64
import html
import io
import shutil
import subprocess
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.optimal.driver import Optimal
from arena.results.results import Results
from envs import Hill
from envs.foundation.checks import choice, number
from envs.foundation.errors import InvalidValueError
from envs.rendering import FRAMES_PER_SECOND, SIZE

Frame = NDArray[np.uint8]
SUFFIXES = (".gif", ".html", ".mp4")
GHOST = "optimal drive"
_HOLD = 2000  # milliseconds that the end of a race is shown


@dataclass(frozen=True)
class Race:
    """What each car did.

    Attributes:
        hill: what they drove on.
        start: position where all began, at rest.
        limit: of the steps.
        actions: of each car, by its name; as many as it needed to the goal, or ``limit``.
        reached: names of those that reached the goal.
        ghost: the name of the car that is drawn pale, one of these; None if there is none.
    """

    hill: Hill
    start: float
    limit: int
    actions: Mapping[str, Sequence[int]]
    reached: frozenset[str]
    ghost: str | None

    @property
    def steps(self) -> int:
        """Of the last car."""
        return max(map(len, self.actions.values()))

    @property
    def captions(self) -> dict[str, str]:
        """Each car's name and steps, by its name."""
        return {
            name: f"{name}: {len(actions)} steps" + ("" if name in self.reached else ", not there")
            for name, actions in self.actions.items()
        }


def race(results: Results, entrants: Sequence[str], start: float = -0.5, replicate: int = 0) -> Race:
    """Let the agents that a replicate trained drive greedily from one start, and the optimal one beside them.

    Args:
        results: of the tournament.
        entrants: names that differ.
        start: position, in units of length.
        replicate: whose policies.

    Raises:
        ValueError: when there is no such run, its policy cannot be told, or the start is beyond
            the goal.
    """
    if len(set(entrants)) < len(entrants) or not entrants:
        raise InvalidValueError(
            f"entrants must be one or more that differ, got {', '.join(entrants) or 'none'}"
        )
    hill, limit = results.conditions.hill, results.conditions.evaluation.max_steps
    start = number("start", start, hill.min_position, hill.goal_position)
    agents = {name: results.trained(name, replicate).agent for name in entrants}
    ghost = GHOST if GHOST not in agents else None
    try:
        agents |= {ghost: Optimal.create(hill)} if ghost else {}
    except InvalidValueError:  # a hill that this driver is not for
        ghost = None
    actions: dict[str, list[int]] = {name: [] for name in agents}
    reached = set()
    env, observations = _at_start(hill, list(agents), start, limit, None)
    while env.agents:
        chosen = {name: int(agents[name].greedy(observations[name])) for name in env.agents}
        observations, _, terminated, _, _ = env.step(chosen)
        for name, action in chosen.items():
            actions[name].append(action)
        reached |= {name for name, there in terminated.items() if there}
    return Race(hill, start, limit, actions, frozenset(reached), ghost)


def frames(race: Race) -> Iterator[Frame]:
    """A picture of the start and of each step, uint8, shape (400, 600, 3); the ghost is half there."""
    drivers = [name for name in race.actions if name != race.ghost]
    for seen, also in zip(_rendered(race, race.actions), _rendered(race, drivers), strict=True):
        yield (seen // 2 + also // 2) if race.ghost else seen


def show(race: Race) -> None:
    """Drive the race in a window.

    Raises:
        ValueError: when no window can be opened.
    """
    from gymnasium.error import DependencyNotInstalled

    try:
        for _ in _rendered(race, race.actions, "human"):
            pass
    except (RuntimeError, DependencyNotInstalled) as error:
        raise InvalidValueError(f"{error}; --out race.gif needs no window") from error


def save_race(race: Race, path: Path) -> None:
    """Write the race as a GIF, as a page with one, or, where there is ffmpeg, as a film.

    Raises:
        ValueError: when the suffix is another, or there is no ffmpeg.
        OSError: when the file cannot be written.
    """
    suffix = choice("suffix of --out", path.suffix.lower(), SUFFIXES)
    if suffix == ".mp4":
        _film(frames(race), path)
        return
    animation = _gif(frames(race))
    path.write_bytes(animation if suffix == ".gif" else _page(race, animation).encode())


def _at_start(hill: Hill, cars: list[str], start: float, limit: int, mode: str | None) -> tuple[Any, Any]:
    """The environment with all cars at the start, and what they observe."""
    from envs import mountain_car_v0

    env = mountain_car_v0.parallel_env(cars, hill, limit, render_mode=mode)
    observations, _ = env.reset(seed=0, options={"start": dict.fromkeys(cars, (start, 0.0))})
    return env, observations


def _rendered(race: Race, drivers: Iterable[str], mode: str = "rgb_array") -> Iterator[Frame]:
    """What the environment shows of these cars, until the last of all has ended."""
    actions = {race.captions[name]: race.actions[name] for name in drivers}
    env, _ = _at_start(race.hill, list(actions), race.start, race.limit, mode)
    try:
        yield env.render()
        for step in range(race.steps):
            if env.agents:
                env.step({name: actions[name][step] for name in env.agents})
            yield env.render()
    finally:
        env.close()


def _gif(pictures: Iterable[Frame]) -> bytes:
    from PIL import Image

    images = [Image.fromarray(picture) for picture in pictures]
    samples = [np.asarray(images[k * (len(images) - 1) // 3]) for k in range(4)]
    palette = Image.fromarray(np.concatenate(samples)).quantize(64)  # one for all: smaller, no flicker
    first, *others = (image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images)
    durations = [round(1000 / FRAMES_PER_SECOND)] * len(others) + [_HOLD]
    buffer = io.BytesIO()
    first.save(buffer, "GIF", save_all=True, append_images=others, duration=durations, loop=0)
    return buffer.getvalue()


def _page(race: Race, animation: bytes) -> str:
    captions = "; ".join(race.captions.values())
    source = base64.b64encode(animation).decode()
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>Race</title></head>\n'
        f"<body><h1>Race from {race.start:g}</h1>\n"
        f'<img src="data:image/gif;base64,{source}" alt="Cars on the hill">\n'
        f"<p>{html.escape(captions)}</p></body></html>\n"
    )


def _film(pictures: Iterable[Frame], path: Path) -> None:
    program = shutil.which("ffmpeg")
    if program is None:
        raise InvalidValueError(
            "--out must be .gif or .html: for .mp4 ffmpeg must be on the path, and it is not"
        )
    form = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{SIZE[0]}x{SIZE[1]}", "-r", str(FRAMES_PER_SECOND)]
    command = [program, "-y", "-v", "error", *form, "-i", "-", "-pix_fmt", "yuv420p", str(path)]
    raw = b"".join(picture.tobytes() for picture in pictures)
    done = subprocess.run(command, input=raw, capture_output=True, check=False)  # noqa: S603 (our own)
    if done.returncode:
        raise InvalidValueError(f"ffmpeg cannot write {path}: {done.stderr.decode().strip()}")
