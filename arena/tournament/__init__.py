"""What is raced: entrants, the tournament, files of tournaments, and what a run leaves behind."""

from arena.tournament.conditions import Conditions, Evaluation, Run, Training
from arena.tournament.configuration import from_dict, load_tournament
from arena.tournament.entrant import Entrant, sweep
from arena.tournament.tournament import Tournament

__all__ = [
    "Conditions",
    "Entrant",
    "Evaluation",
    "Run",
    "Tournament",
    "Training",
    "from_dict",
    "load_tournament",
    "sweep",
]
