"""What all runs of a tournament have in common, and one run of it."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena.tournament.entrant import Entrant
from envs import Hill
from envs.foundation.checks import integer
from envs.foundation.streams import stream


def _integers(owner: Any, prefix: str, **least: int) -> None:
    for name, low in least.items():
        label = f"{prefix} {name}".strip()
        object.__setattr__(owner, name, integer(label, getattr(owner, name), low))


@dataclass(frozen=True)
class Training:
    """How long the agents learn (paper, section 4.3).

    Args:
        episodes: N_E, at least 1.
        max_steps: N_LE, limit of an episode, at least 1.
    """

    episodes: int = 4000
    max_steps: int = 30000

    def __post_init__(self) -> None:
        _integers(self, "training", episodes=1, max_steps=1)


@dataclass(frozen=True)
class Evaluation:
    """How long the learned policies are tested (paper, section 4.3).

    Args:
        episodes: N_TE, at least 1.
        max_steps: N_TS, limit of an episode, at least 1.
    """

    episodes: int = 1000
    max_steps: int = 500

    def __post_init__(self) -> None:
        _integers(self, "evaluation", episodes=1, max_steps=1)


@dataclass(frozen=True)
class Conditions:
    """What all runs of a tournament have in common: all that a worker needs beside the entrant.

    Attributes:
        hill, training, evaluation, seed: the tournament's.
        checkpoints: folder where long runs are saved; None if they are not.
        checkpoint_seconds: time between two of a run's checkpoints; 0 is one after each episode.
    """

    hill: Hill
    training: Training
    evaluation: Evaluation
    seed: int
    checkpoints: str | None = None
    checkpoint_seconds: float = 30.0

    def start_states(self, replicate: int) -> NDArray[np.float64]:
        """Where the test episodes start, the same for all entrants; shape (episodes, 2), read-only."""
        return _start_states(self, replicate)


@lru_cache(maxsize=4)
def _start_states(conditions: Conditions, replicate: int) -> NDArray[np.float64]:
    rng = stream(conditions.seed, "evaluation", str(replicate))
    states = [conditions.hill.reset(rng) for _ in range(conditions.evaluation.episodes)]
    starts = np.array(states)
    starts.flags.writeable = False
    return starts


@dataclass(frozen=True)
class Run:
    """One replicate of one entrant."""

    entrant: Entrant
    replicate: int

    @property
    def identity(self) -> str:
        """What its car and its random streams are called."""
        return identity_of(self.entrant.name, self.replicate)

    @property
    def key(self) -> tuple[str, int]:
        """The entrant's name, and the replicate."""
        return self.entrant.name, self.replicate

    def stream(self, seed: int, purpose: str) -> np.random.Generator:
        """The run's own random numbers for ``purpose``, whoever else races."""
        return stream(seed, purpose, self.identity)


def identity_of(entrant: str, replicate: int) -> str:
    """What the car and the random streams of a run are called."""
    return f"{entrant}#{replicate}"
