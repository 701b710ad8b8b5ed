"""What all tests share."""

import os
from pathlib import Path

import pytest

from agents import QLearning, Sarsa
from arena import Entrant, Evaluation, Tournament, Training

# Compiled kernels are kept apart from the user's, and from one run of the tests to the next.
KERNELS = Path(__file__).parent.parent / ".pytest_cache" / "kernels"
os.environ.setdefault("ARENA_CACHE_DIR", str(KERNELS))


@pytest.fixture
def small() -> Tournament:
    """Two entrants that are done in a moment, on either driver."""
    return Tournament(
        (Entrant("q", QLearning, bins=(5, 6)), Entrant("s", Sarsa, bins=(6, 5))),
        training=Training(episodes=6, max_steps=120),
        evaluation=Evaluation(episodes=5, max_steps=150),
        replicates=2,
        seed=7,
        name="small",
    )
