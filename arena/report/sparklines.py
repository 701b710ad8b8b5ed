"""What a terminal can show beside the tables: sparklines of learning, and the best policy learned."""

import numpy as np
from numpy.typing import ArrayLike
from rich.cells import cell_len, set_cell_size
from rich.console import Console, Group, RenderableType
from rich.text import Text

from agents.baselines import DoesNotLearn
from agents.registry import agent_class
from arena.analysis.curves import reward_curves
from arena.analysis.policy_map import map_of, policy
from arena.figures.style import ACTION_NAMES, ACTIONS
from arena.results.results import Results
from arena.results.trained import Trained
from envs.foundation.errors import InvalidValueError

LEVELS = "▁▂▃▄▅▆▇█"
_BEST = 10  # entrants with a sparkline
_WIDTH, _HEIGHT = 54, 12  # characters; a character of the map has two cells, one above the other


def can_show(console: Console) -> bool:
    """Whether it is a terminal that has the characters."""
    return console.is_terminal and console.encoding.lower().startswith("utf")


def sparkline(values: ArrayLike, low: float, high: float, width: int = _WIDTH) -> str:
    """The values as a line of blocks, between ``low`` and ``high``, each the mean of some."""
    heights = np.asarray(values, float)
    means = [part.mean() for part in np.array_split(heights, min(width, len(heights)))]
    shares = (np.array(means) - low) / ((high - low) or 1.0)
    return "".join(LEVELS[int(level)] for level in np.clip(shares * len(LEVELS), 0, len(LEVELS) - 1))


def pictures(results: Results, columns: int) -> RenderableType:
    """Learning curves of the best, on one logarithmic scale, and the best policy learned; or nothing.

    Args:
        results: what to show.
        columns: characters of a line, to which the pictures keep unless names are longer.
    """
    try:
        ranked = results.best(len(results.entrants))
        names = ranked[:_BEST]
        curves = {name: reward_curves(results, name).mean(axis=0) for name in names}
    except InvalidValueError:  # no run has finished, or there are too few episodes for a curve
        return Group()
    low, high = (float(end(end(curve) for curve in curves.values())) for end in (min, max))
    ends = -np.log(-low), -np.log(-high)
    longest = max(map(cell_len, names))
    width = max(1, min(_WIDTH, columns - longest - 2))
    lines = [
        Text(f"{set_cell_size(name, longest)}  {sparkline(-np.log(-curve), *ends, width)}")
        for name, curve in curves.items()
    ]
    heading = f"Learning: accumulated reward by episode, from {low:,.0f} to {high:,.0f} (logarithmic)."
    return Group(Text(heading), *lines, *_learned_policy(results, ranked, min(_WIDTH, columns)))


def _learned_policy(results: Results, ranked: list[str], width: int) -> list[Text]:
    """What a planner does is no news, and to make one again may take the compiler."""
    try:
        agents = ((name, agent_class(results.entrants[name].agent)) for name in ranked)
        best = next(name for name, agent in agents if not issubclass(agent, DoesNotLearn))
        return blocks(results.trained(best), width)
    except (StopIteration, InvalidValueError):  # there is none, or it cannot be told
        return []


def blocks(agent: Trained, width: int = _WIDTH) -> list[Text]:
    """The policy map in coloured blocks: position to the right, velocity upward.

    Raises:
        arena.results.trained.UnknownPolicyError: when it drives by chance.
    """
    actions = policy(agent, map_of(agent))
    across, upward = (np.arange(n) * size // n for n, size in zip((width, 2 * _HEIGHT), actions.shape))
    shown = actions[np.ix_(across, upward[::-1])].T
    lines = [Text(f"Policy of {agent.entrant}, position to the right, velocity upward: ")]
    for name, color in zip(ACTION_NAMES, ACTIONS):
        lines[0].append("█", color).append(f" {name} ")
    for above, below in zip(shown[::2], shown[1::2]):
        line = Text()
        for a, b in zip(above, below):
            line.append("▀", f"{ACTIONS[a]} on {ACTIONS[b]}")
        lines.append(line)
    return lines
