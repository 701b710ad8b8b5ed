"""The arena: entrants learn on one hill, and their scores say who drives best."""

import arena.report.notebook  # noqa: F401 (registers what notebooks show)
from agents.interop.policy import Policy
from agents.interop.policy_agent import PolicyAgent
from arena.execution.runner import run
from arena.plugins.loading import load_plugin
from arena.results.results import Results, load
from arena.tournament.builtin import field, paper, quick
from arena.tournament.conditions import Evaluation, Training
from arena.tournament.entrant import Entrant, sweep
from arena.tournament.tournament import Tournament
from arena.walks.series import InterruptedWalk, RandomWalk, random_walk

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
