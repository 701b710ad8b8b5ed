"""Results with scores that a test chooses; nothing is run."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from agents import MomentumAgent
from arena import Entrant, Evaluation, Results, Tournament, Training
from arena.common.npz import pack
from arena.results.store import Store
from arena.tournament.outcome import Outcome, Status

LIMIT = 500


def made_up(
    steps: Mapping[str, Sequence[float | None]],
    path: Path | None = None,
    *,
    iterations: int = 100,
    **arguments: Any,
) -> Results:
    """A tournament of entrants that need so many steps in each replicate.

    All test drives reach the goal, but none does in a replicate whose steps are the limit; None is a run
    that failed. Replicates that an entrant lacks are not run yet.
    """
    chosen: dict[str, Any] = {"replicates": max(1, *map(len, steps.values())), "name": "made up"}
    chosen |= {"training": Training(10, 1000), "evaluation": Evaluation(4, LIMIT)}
    tournament = Tournament(
        tuple(Entrant(name, MomentumAgent) for name in steps),
        **chosen | arguments,
    )
    store = Store.create(path, tournament.to_dict())
    for name, values in steps.items():
        for replicate, value in enumerate(values):
            if value is None:
                store.add(Outcome(name, replicate, "compiled", Status.FAILED, error="ouch"))
                continue
            reached = value < LIMIT
            arrays = pack(
                {
                    "lengths": np.full(10, iterations // 10),
                    "test_lengths": np.array(
                        [value - 1, value, value, value + 1] if reached else [LIMIT] * 4
                    ),
                    "test_reached": np.full(4, reached),
                }
            )
            scores = (100.0, value) if reached else (0.0, float("nan"))
            store.add(Outcome(name, replicate, "compiled", Status.FINISHED, *scores, iterations, 0.1, arrays))
    return Results(store)
