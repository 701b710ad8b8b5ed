"""Colours that all pictures share: told apart with any kind of colour vision, in print and on a screen.

A picture brings its own white paper, so that it can be read on a dark page, too.
"""

from typing import TYPE_CHECKING

from envs.rendering import PALETTE

if TYPE_CHECKING:
    from matplotlib.axes import Axes


BLUE, RED, GREEN, PURPLE, ORANGE, SKY, BLACK, YELLOW = PALETTE
LINES = PALETTE[:-1]
"""Okabe and Ito (2008), without the yellow, which is too faint for a line."""

DASHES = ("-", "--", "-.", ":", (0, (5, 1)), (0, (3, 1, 1, 1)), "-")
"""Beside the colours: lines are told apart in black and white, too."""

ACTIONS = (BLUE, "#F7F7F7", ORANGE)
"""Thrust left, none, right."""

ACTION_NAMES = ("thrust left", "no thrust", "thrust right")
UNVISITED = "#BBBBBB"
AMOUNT, SHARE, BETTER = "cividis", "Blues", "PuOr"
"""Colour maps: of an amount, of a share of the whole, of what is to be more or less than a half."""


def make_axes(axes: "Axes | None", width: float = 7.0, height: float = 4.5) -> "Axes":
    """The axes given, or those of a new figure of that size in inches."""
    if axes is not None:
        return axes
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained").add_subplot()
