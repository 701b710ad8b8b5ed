"""Binary features of observations for linear agents: which of them are active.

Each kind has ``fill(observation, active)``, which writes the numbers of the active features into an
array; ``active``, how many these always are; and ``size``, the number of all.
"""

from collections.abc import Sequence

import numpy as np

from agents.contract import Task
from agents.discretization.cells import Binning, Bins, Cells, make_cells
from agents.discretization.tile_coding import TileCoding
from agents.parameters.declared import Count

Tiles = Count | Sequence[Count]
Features = Cells | TileCoding


def make_features(
    task: Task,
    tilings: int,
    tiles: Tiles,
    bins: Bins | None,
    binning: Binning,
    rng: np.random.Generator | None,
) -> Features:
    """The features that an agent's parameters describe.

    Args:
        task: the hill.
        tilings: number of displaced grids.
        tiles: tiles of each grid along the range of each dimension.
        bins: cells in place of tiles, see ``agents.discretization.cells.make_cells``; None: tiles.
        binning: of the cells.
        rng: for cells that are learned.

    Raises:
        TypeError, ValueError: when one of them breaks its rule.
    """
    if bins is None:
        return TileCoding.over(task, tilings, tiles)
    return make_cells(task, bins, binning, rng)
