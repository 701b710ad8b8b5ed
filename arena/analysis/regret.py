"""How far drives are from the best possible ones: the fewest steps from each start of the test."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena.common.parallel import imap
from arena.results.results import Results
from envs import Hill

Bounds = Mapping[int, NDArray[np.float64]]
"""By replicate, the fewest steps that any drive needs from each start of the test."""

_TOGETHER = 200  # starts a task: about a second


def fewest_steps(results: Results, replicates: Iterable[int]) -> Bounds:
    """What is proved that no drive can undercut, the limit of the test at most; computed over the cores.

    Args:
        results: of a tournament.
        replicates: whose starts are meant.

    Returns:
        The lower bounds of ``agents.optimal.optimal_steps``, by replicate.
    """
    conditions = results.conditions
    hill, evaluation = conditions.hill, conditions.evaluation
    positions = {replicate: conditions.start_states(replicate)[:, 0] for replicate in replicates}
    distinct = np.unique(np.concatenate([*positions.values(), np.empty(0)]))
    parts = np.array_split(distinct, max(1, len(distinct) // _TOGETHER))
    bounds: dict[float, int] = {}
    for part, steps in imap(-1, _lower_bounds, [(hill, part) for part in parts if len(part)]):
        bounds.update(zip(part.tolist(), steps.tolist(), strict=True))
    return {
        replicate: np.minimum([bounds[start] for start in starts.tolist()], evaluation.max_steps).astype(
            float
        )
        for replicate, starts in positions.items()
    }


def _lower_bounds(hill: Hill, positions: NDArray[np.float64]) -> tuple[Any, Any]:
    """In a worker."""
    from agents.optimal.fewest_steps import optimal_steps

    return positions, optimal_steps(hill, positions)[0]
