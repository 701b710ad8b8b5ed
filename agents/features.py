"""Binary features of observations for linear agents: which of them are active.

Each kind has ``fill(observation, active)``, which writes the numbers of the active features into an
array; ``active``, how many these always are; and ``size``, the number of all.
"""

from collections.abc import Sequence

import numpy as np

from agents.contract import Task
from agents.grid import Grid
from agents.parameters import Count
from agents.tile_coding import TileCoding

Tiles = Count | Sequence[Count]
Features = Grid | TileCoding


def make_features(
    task: Task, tilings: Count, tiles: Tiles, bins: Tiles | None, rng: np.random.Generator | None
) -> Features:
    """The features that an agent's parameters describe.

    Args:
        task: the hill.
        tilings: number of displaced grids.
        tiles: tiles of each grid along the range of each dimension.
        bins: cells of one uniform grid, in place of tiles; None: tiles.
        rng: the run's; neither kind draws from it.

    Raises:
        TypeError, ValueError: when one of them breaks its rule.
    """
    return TileCoding.over(task, tilings, tiles) if bins is None else Grid.over(task, bins)
