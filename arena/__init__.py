"""The arena: entrants learn on one hill, and their scores say who drives best."""

from arena.builtin import field, paper, quick
from arena.entrant import Entrant, sweep
from arena.plugins import load_plugin
from arena.policy import Policy
from arena.policy_agent import PolicyAgent
from arena.results import Results, load
from arena.runner import run
from arena.tournament import Evaluation, Tournament, Training
from arena.walks import InterruptedWalk, RandomWalk, random_walk

__all__ = [
    "Entrant",
    "Evaluation",
    "InterruptedWalk",
    "Policy",
    "PolicyAgent",
    "RandomWalk",
    "Results",
    "Tournament",
    "Training",
    "field",
    "load",
    "load_plugin",
    "paper",
    "quick",
    "random_walk",
    "run",
    "sweep",
]
