"""The tournaments that need no file: the paper's, and a quick one."""

from collections.abc import Callable
from importlib.resources import as_file, files

from agents import HarmonicRate, MomentumAgent, QLearning, RandomAgent, Sarsa
from arena.tournament.conditions import Evaluation, Training
from arena.tournament.configuration import load_tournament
from arena.tournament.entrant import Entrant, sweep
from arena.tournament.tournament import Tournament

PAPER_BINS = [(position, velocity) for position in (10, 20, 30, 40) for velocity in (10, 20, 30, 40)]


def paper(replicates: int = 10, seed: int = 0, reading: str = "as-run") -> Tournament:
    """Tables 1 and 2 of the paper: two algorithms on 4 x 4 grids, with the paper's parameters.

    They are read as they were run, which is not what the text says: see docs/readings.md.
    """
    entrants = (
        *sweep("q-learning", QLearning, over={"bins": PAPER_BINS}),
        *sweep("sarsa", Sarsa, over={"bins": PAPER_BINS}),
    )
    return Tournament(entrants, replicates=replicates, seed=seed, name="paper", reading=reading)


def quick(replicates: int = 3, seed: int = 0, reading: str = "literal") -> Tournament:
    """Two that learn and two that do not, in seconds; a larger step size makes up for few episodes."""
    rate = HarmonicRate(A=1.0, B=5.0, C=0.0)
    entrants = (
        Entrant("q-learning", QLearning, bins=(20, 20), step_size=rate),
        Entrant("sarsa", Sarsa, bins=(20, 20), step_size=rate),
        Entrant("momentum", MomentumAgent),
        Entrant("random", RandomAgent),
    )
    return Tournament(
        entrants,
        training=Training(episodes=500, max_steps=1000),
        evaluation=Evaluation(episodes=100),
        replicates=replicates,
        seed=seed,
        name="quick",
        reading=reading,
    )


def field(replicates: int = 20, seed: int = 0, reading: str = "literal") -> Tournament:
    """All kinds of agents, with the parameters that the search of ``scripts/tune_field.py`` found."""
    with as_file(files("arena.tournament") / "data" / "field.toml") as path:
        return load_tournament(path, replicates=replicates, seed=seed, reading=reading)


BUILT_IN: dict[str, Callable[..., Tournament]] = {"paper": paper, "quick": quick, "field": field}
