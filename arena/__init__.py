"""The arena: entrants learn on one hill, and their scores say who drives best."""

from typing import TYPE_CHECKING

from arena import deprecated
from arena.common import html
from envs.foundation.errors import ArenaError
from envs.foundation.lazy import lazily

if TYPE_CHECKING:
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
else:  # the same, each module when a name of its own is asked for: the command line need not wait for all
    __getattr__, __dir__ = lazily(
        __name__,
        {
            "agents.interop.policy": ("Policy",),
            "agents.interop.policy_agent": ("PolicyAgent",),
            "arena.execution.runner": ("run",),
            "arena.plugins.loading": ("load_plugin",),
            "arena.results.results": ("Results", "load"),
            "arena.tournament.builtin": ("field", "paper", "quick"),
            "arena.tournament.conditions": ("Evaluation", "Training"),
            "arena.tournament.entrant": ("Entrant", "sweep"),
            "arena.tournament.tournament": ("Tournament",),
            "arena.walks.series": ("InterruptedWalk", "RandomWalk", "random_walk"),
        },
        ("analysis", "figures", "plugins", "reproduction", "results", "testing", "tournament"),
    )

__all__ = [
    "ArenaError",
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

deprecated.install()
html.registrars.add("arena.report.notebook")
