"""Pictures of cars on a hill: text, pixels, a window."""

import math
import os
from collections.abc import Mapping
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from envs.hill import Hill, State

if TYPE_CHECKING:
    from PIL import ImageDraw
    from PIL.Image import Image as Canvas


RENDER_MODES = ("human", "rgb_array", "ansi")
FRAMES_PER_SECOND = 30
SIZE = (600, 400)
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#F0E442")
"""Okabe and Ito's colours, which the colour-blind can tell apart."""

_GROUND, _SKY, _INK, _FLAG = "#DAD7CD", "#FFFFFF", "#222222", "#2B6E2B"
_UNSEEN = {"offscreen", "dummy"}
"""Of SDL's drivers those that it falls back to where there is no screen, unless they are asked for."""

_FINE = 2  # pixels drawn for one that is shown, along each side: smooth edges
_NAMED = 12  # cars that are named in a picture, at most
_CURVE = 200  # straight pieces that the hill is drawn with

Image = NDArray[np.uint8]
Point = tuple[float, float]


def text(cars: Mapping[str, State], steps: int) -> str:
    """A line a car: where it is and how fast."""
    width = max(map(len, cars), default=0)
    lines = [
        f"{name:{width}}  position {position:+.4f}  velocity {velocity:+.5f}"
        for name, (position, velocity) in cars.items()
    ]
    return "\n".join([f"step {steps}", *lines])


def picture(hill: Hill, cars: Mapping[str, State], steps: int) -> Image:
    """The hill, its goal and the cars, each in its colour; uint8, shape (400, 600, 3)."""
    from PIL import ImageDraw

    scene, empty = _landscape(hill)
    canvas = empty.copy()
    draw = ImageDraw.Draw(canvas)
    for number, (position, _) in enumerate(cars.values()):
        scene.car(draw, position, PALETTE[number % len(PALETTE)])
    scene.legend(draw, list(cars), steps)
    return np.array(canvas.reduce(_FINE), np.uint8)


@lru_cache(maxsize=8)
def _landscape(hill: Hill) -> "tuple[_Scene, Canvas]":
    """The hill without cars."""
    from PIL import Image as pillow
    from PIL import ImageDraw

    canvas = pillow.new("RGB", (SIZE[0] * _FINE, SIZE[1] * _FINE), _SKY)
    scene = _Scene(hill)
    scene.landscape(ImageDraw.Draw(canvas))
    return scene, canvas


class _Scene:
    """Where things of the hill are in the picture."""

    def __init__(self, hill: Hill) -> None:
        self.hill = hill
        self.positions = np.linspace(hill.min_position, hill.max_position, _CURVE + 1).tolist()
        heights = [hill.height(position) for position in self.positions]
        self.bottom = min(heights)
        self.across = SIZE[0] * _FINE / (hill.max_position - hill.min_position)
        self.up = 0.6 * SIZE[1] * _FINE / max(max(heights) - self.bottom, 1e-9)

    def at(self, position: float) -> Point:
        """The pixel of a point of the track."""
        x = (position - self.hill.min_position) * self.across
        return x, SIZE[1] * _FINE * 0.9 - (self.hill.height(position) - self.bottom) * self.up

    def landscape(self, draw: "ImageDraw.ImageDraw") -> None:
        """The ground and the flag at the goal."""
        track = [self.at(position) for position in self.positions]
        draw.polygon([(0, SIZE[1] * _FINE), *track, (SIZE[0] * _FINE, SIZE[1] * _FINE)], fill=_GROUND)
        draw.line(track, fill=_INK, width=_FINE)
        x, y = self.at(self.hill.goal_position)
        pole = 40 * _FINE
        draw.line([(x, y), (x, y - pole)], fill=_INK, width=_FINE)
        flag = [(x, y - pole), (x + 18 * _FINE, y - pole + 7 * _FINE), (x, y - pole + 14 * _FINE)]
        draw.polygon(flag, fill=_FLAG)

    def car(self, draw: "ImageDraw.ImageDraw", position: float, colour: str) -> None:
        """A body on two wheels, parallel to the track."""
        x, y = self.at(position)
        angle = math.atan(self.hill.slope(position) * self.up / self.across)
        along = (math.cos(angle) * _FINE, -math.sin(angle) * _FINE)
        above = (along[1], -along[0])

        def corner(forward: float, upward: float) -> Point:
            return (
                x + forward * along[0] + upward * above[0],
                y + forward * along[1] + upward * above[1],
            )

        body = [(-17, 5), (17, 5), (17, 12), (9, 12), (6, 19), (-9, 19), (-12, 12), (-17, 12)]
        draw.polygon([corner(*point) for point in body], fill=colour, outline=_INK)
        for forward in (-10, 10):
            (a, b), radius = corner(forward, 5), 5 * _FINE
            draw.ellipse([a - radius, b - radius, a + radius, b + radius], fill=_INK)

    def legend(self, draw: "ImageDraw.ImageDraw", names: list[str], steps: int) -> None:
        """Whose colour is whose, and how long they have driven."""
        from PIL import ImageFont

        font = ImageFont.load_default(13 * _FINE)
        draw.text((SIZE[0] * _FINE - 10 * _FINE, 10 * _FINE), f"step {steps}", _INK, font, anchor="ra")
        for number, name in enumerate(names[:_NAMED]):
            y = (10 + 18 * number) * _FINE
            square = [10 * _FINE, y + 2 * _FINE, 21 * _FINE, y + 13 * _FINE]
            draw.rectangle(square, fill=PALETTE[number % len(PALETTE)], outline=_INK)
            draw.text((28 * _FINE, y), name, _INK, font)
        if len(names) > _NAMED:
            more = f"and {len(names) - _NAMED} more"
            draw.text((28 * _FINE, (10 + 18 * _NAMED) * _FINE), more, _INK, font)


class Window:
    """A window that shows pictures, by pygame.

    Raises:
        gymnasium.error.DependencyNotInstalled: when there is no pygame.
        RuntimeError: when no window can be opened, as where there is no screen.
    """

    def __init__(self, title: str) -> None:
        try:
            import pygame
        except ImportError:
            from gymnasium.error import DependencyNotInstalled

            raise DependencyNotInstalled('render_mode "human" needs pygame: pip install pygame') from None
        self._pygame: Any = pygame
        try:
            pygame.display.init()
            self._screen = pygame.display.set_mode(SIZE)
        except pygame.error as error:
            raise RuntimeError(f'render_mode "human" cannot open a window: {error}') from None
        if pygame.display.get_driver() in _UNSEEN and "SDL_VIDEODRIVER" not in os.environ:
            self.close()
            raise RuntimeError('render_mode "human" cannot open a window: there is no screen')
        pygame.display.set_caption(title)
        self._clock = pygame.time.Clock()

    def show(self, image: Image) -> None:
        """Show the picture, no sooner than it is due."""
        surface = self._pygame.surfarray.make_surface(image.swapaxes(0, 1))
        self._screen.blit(surface, (0, 0))
        self._pygame.event.pump()
        self._pygame.display.flip()
        self._clock.tick(FRAMES_PER_SECOND)

    def close(self) -> None:
        """Close the window."""
        self._pygame.display.quit()


class Rendered:
    """What environments that render have in common: first of their bases.

    They set ``hill`` and ``render_mode``, and call ``follow`` after each reset and step.
    """

    hill: Hill
    render_mode: str | None
    _window: Window | None = None

    def _rendered_state(self) -> tuple[dict[str, State], int]:
        """The cars by name, and their steps."""
        raise NotImplementedError

    def render(self) -> Image | str | None:
        """What the cars are doing, in the render mode: a picture, a text, or None."""
        if self.render_mode is None:
            from gymnasium import logger

            logger.warn("render is called without a render_mode; give one when the environment is made")
            return None
        cars, steps = self._rendered_state()
        if self.render_mode == "ansi":
            return text(cars, steps)
        image = picture(self.hill, cars, steps)
        if self.render_mode == "rgb_array":
            return image
        self._window = self._window or Window("Mountain Car")
        self._window.show(image)
        return None

    def _update_window(self) -> None:
        """Keep the window up to date, if that is the render mode."""
        if self.render_mode == "human":
            self.render()

    def close(self) -> None:
        """Close the window, if there is one."""
        if self._window:
            self._window.close()
            self._window = None

    def __getstate__(self) -> dict[str, Any]:
        """All but the window: a copy is in the middle of the same episode, and opens its own."""
        return self.__dict__ | {"_window": None}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
