"""A small tournament for the tests of the page, with what a page could stumble over."""

from pathlib import Path
from typing import NamedTuple, Self

import numpy as np

from agents import MomentumAgent, RandomAgent, Sarsa, Task
from agents.contract import Observation
from arena import Entrant, Evaluation, Tournament, Training, run

HOSTILE = "<script>alert(1)</script>"


class Broken(NamedTuple):
    """Raises when it is to act."""

    nothing: int = 0

    @classmethod
    def create(cls, task: Task) -> Self:
        return cls()

    def act(self, observation: Observation, progress: float, rng: np.random.Generator) -> int:
        raise RuntimeError("<b>ouch</b>")

    def learn(self, *transition: object) -> None: ...

    def greedy(self, observation: Observation) -> int:
        return 0


def hostile_results(path: Path) -> Path:
    """Run it into the file ``path``."""
    entrants = (
        Entrant("sarsa", Sarsa, bins=(6, 7)),
        Entrant(HOSTILE, Sarsa, bins=(5, 5)),
        Entrant("</script><img src=x onerror=alert(1)>", MomentumAgent),
        Entrant("momentum", MomentumAgent),
        Entrant("random", RandomAgent),
        Entrant("broken", Broken),
    )
    tournament = Tournament(
        entrants, training=Training(55, 60), evaluation=Evaluation(3, 200), replicates=2, name="<i>race</i>"
    )
    run(tournament, path, n_jobs=1, driver="pettingzoo").close()
    return path
